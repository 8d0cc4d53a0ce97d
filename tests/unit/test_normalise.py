"""Into the canonical frame: heading, size, side."""

import numpy as np
import pytest

from models.arrays import Float
from models.skeleton import coco
from services.evaluation.normalise import PlacingError, facing, lead_right, mirrored, placed, placing_of, size_m
from services.evaluation.track import known_track

FRAME_S = 1 / 30
PLACES_M = {
    "nose": (0.0, 1.38), "eye": (0.03, 1.4), "ear": (0.07, 1.39), "shoulder": (0.17, 1.2), "elbow": (0.2, 0.95),
    "wrist": (0.22, 0.72), "hip": (0.1, 0.8), "knee": (0.1, 0.43), "ankle": (0.1, 0.07),
}  # fmt: skip
"""To the side and up."""


def standing() -> Float:
    """(17, 3) a person of 1.5 m at the origin who looks along x."""
    side = {"left": 1.0, "right": -1.0, "nose": 0.0}
    parts = [(name.partition("_")[0], name.partition("_")[2] or name) for name in coco.NAMES]
    return np.array([(0.1 * (part == "nose"), side[who] * PLACES_M[part][0], PLACES_M[part][1]) for who, part in parts])


def turned(joints: Float, angle: float) -> Float:
    rotation = np.array(((np.cos(angle), -np.sin(angle), 0), (np.sin(angle), np.cos(angle), 0), (0, 0, 1)))
    return np.asarray(joints @ rotation.T)


@pytest.mark.parametrize("angle", [0.0, 1.0, np.pi, -2.5])
def test_one_faces_to_where_the_nose_is(angle: float) -> None:
    np.testing.assert_allclose(facing(turned(standing(), angle)), (np.cos(angle), np.sin(angle)), atol=1e-12)


def test_who_lies_stands_on_his_hands_or_is_half_seen_faces_nowhere() -> None:
    upside_down, lying = standing() * (1, -1, -1), standing()[:, [2, 1, 0]]
    unseen = standing()
    unseen[coco.INDEX["left_hip"]] = np.nan
    for joints in (upside_down, lying, unseen, np.full((17, 3), np.nan)):
        assert np.isnan(facing(joints)).all()


def test_size_is_the_same_for_every_posture_and_unknown_where_a_limb_is_never_seen() -> None:
    joints = np.stack([standing(), standing()])
    assert size_m(joints) == pytest.approx(np.hypot(0.4, 0.07) + 0.37 + 0.36)
    joints[:, [coco.INDEX["left_ankle"], coco.INDEX["right_knee"]]] = np.nan
    assert np.isnan(size_m(joints))


def test_what_is_placed_looks_along_x_above_the_origin_in_the_size_asked_for() -> None:
    room = turned(standing(), 2.0) * 1.2 + np.array((3.0, -4.0, 0.0))
    placing = placing_of(np.stack([room] * 20), FRAME_S, size_m(standing()[None]))
    np.testing.assert_allclose(placed(room, placing), standing(), atol=1e-12)
    np.testing.assert_allclose(placing.matrix @ placing.matrix.T, np.eye(3) / 1.2**2, atol=1e-12)


def test_nobody_has_no_placing() -> None:
    for nobody in (np.full((5, 17, 3), np.nan), np.zeros((5, 17, 3)), np.zeros((0, 17, 3))):
        with pytest.raises(PlacingError, match="how large the pupil is"):
            placing_of(nobody, FRAME_S, 1.0)


def test_a_left_handed_track_is_mirrored_with_its_covariances_and_a_right_handed_one_is_kept() -> None:
    track = known_track(np.stack([turned(standing(), 0.3)] * 3), FRAME_S, 0.01)
    root = np.random.default_rng(0).normal(size=(3, 17, 3, 3))
    track.states[1, coco.INDEX["left_wrist"]] = 0
    track = type(track)(track.t_s, track.joints_m, root @ root.swapaxes(-1, -2), track.states)
    assert lead_right(track, "right") is track
    image = lead_right(track, "left")
    np.testing.assert_array_equal(image.joints_m, mirrored(track.joints_m))
    assert image.states[1, coco.INDEX["right_wrist"]] == 0
    right, left = coco.INDEX["right_knee"], coco.INDEX["left_knee"]
    flip = np.diag((1.0, -1.0, 1.0))
    np.testing.assert_allclose(image.covariance_m2[0, right], flip @ track.covariance_m2[0, left] @ flip)
    again = lead_right(image, "left")
    np.testing.assert_allclose(again.covariance_m2, track.covariance_m2)
    np.testing.assert_allclose(facing(image.joints_m[0]), (np.cos(0.3), -np.sin(0.3)), atol=1e-12)


def turning() -> Float:
    """(40, 17, 3) from along x to nearly along y."""
    return np.stack([turned(standing(), angle) for angle in np.linspace(0, 1.5, 40)])


@pytest.mark.parametrize("joint", ["left_hip", "right_shoulder"])
def test_who_is_seen_only_later_has_no_heading_of_the_beginning(joint: str) -> None:
    for hidden, known in ((8, True), (12, False)):
        part = turning()
        part[:hidden, coco.INDEX[joint]] = np.nan
        if known:
            placing_of(part, FRAME_S, 1.0)
        else:
            with pytest.raises(PlacingError, match=r"shoulders and both hips at once in its first 0.3 s, and so not to where"):
                placing_of(part, FRAME_S, 1.0)


def test_who_bends_over_at_the_beginning_is_told_from_who_was_hidden() -> None:
    part = turning()
    part[:12] = part[:12][..., [2, 1, 0]]
    with pytest.raises(PlacingError, match=r"does not show the pupil standing upright in its first 0.3 s"):
        placing_of(part, FRAME_S, 1.0)
    with pytest.raises(PlacingError, match=r"does not show the pupil standing upright$"):
        placing_of(part[:12], FRAME_S, 1.0, np.inf)


def test_where_a_heading_need_be_known_but_roughly_it_is_the_first_that_is_seen() -> None:
    part = turning()
    part[:30, coco.INDEX["left_hip"]] = np.nan
    placing = placing_of(part, FRAME_S, 1.0, np.inf)
    assert 1.5 * 30 / 39 <= placing.heading_rad <= 1.5
