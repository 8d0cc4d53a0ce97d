"""Heads of MoveNet made by hand: the joints that were put in come out."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from edge.perception.pose import PoseEstimate, PoseNetwork, Spread, decode_pose
from models.arrays import Float, Float32
from models.skeleton import coco

CELLS = 64
SPREAD = Spread(log_best=-1.0, per_doubt=2.0, per_dissent=3.0)
TOP_LEFT = 0.0016
POSE = np.random.default_rng(11).uniform(-12, 12, (coco.COUNT, 2))
"""Joints around a person's centre, x and y in cells."""

Heads = tuple[Float32, Float32, Float32, Float32]


def heads(people: list[tuple[float, float]], logit: float = 3.0, wrong_by: Float | None = None) -> Heads:
    """What MoveNet would say of people with their centres at these cells (x, y), all in the same pose.

    `wrong_by` (17, 2) is added, in cells, to where the person's centre expects each joint.
    """
    axis = np.arange(CELLS, dtype=np.float64)
    grid = np.stack(np.meshgrid(axis, axis), axis=-1)  # x, y
    centre = np.full((1, CELLS, CELLS), -8.0)
    maps = np.full((coco.COUNT, CELLS, CELLS), -8.0)
    regressions = np.zeros((2 * coco.COUNT, CELLS, CELLS))
    offsets = np.zeros((2 * coco.COUNT, CELLS, CELLS))
    nearest = np.full((coco.COUNT, CELLS, CELLS), np.inf)
    own = np.full((CELLS, CELLS), np.inf)
    expected = POSE if wrong_by is None else POSE + wrong_by
    for person in people:
        away = np.square(grid - person).sum(axis=-1)
        centre[0] = np.maximum(centre[0], 3.0 - away / 4)
        mine, own = away < own, np.minimum(away, own)
        for joint in range(coco.COUNT):
            to_joint = np.array(person) + POSE[joint] - grid
            away = np.square(to_joint).sum(axis=-1)
            maps[joint] = np.maximum(maps[joint], logit - away / 2)
            closer = away < nearest[joint]
            nearest[joint] = np.minimum(nearest[joint], away)
            offsets[2 * joint][closer], offsets[2 * joint + 1][closer] = to_joint[closer][:, 1], to_joint[closer][:, 0]
            to_expected = np.array(person) + expected[joint] - grid
            regressions[2 * joint][mine], regressions[2 * joint + 1][mine] = to_expected[mine][:, 1], to_expected[mine][:, 0]
    return tuple(part.astype(np.float32) for part in (centre, maps, regressions, offsets))  # type: ignore[return-value]


def place(x: float, y: float) -> Float:
    """Where the joints of a person at that cell must come out (17, 2), in crop coordinates."""
    points: Float = (POSE + np.array((x, y))) / CELLS + TOP_LEFT
    return points


def decoded(given_heads: Heads) -> PoseEstimate:
    return decode_pose(*given_heads, SPREAD)


@pytest.mark.slow
@given(x=st.floats(26, 38), y=st.floats(26, 38))
def test_joints_come_out_where_they_are_between_the_cells(x: float, y: float) -> None:
    estimate = decoded(heads([(x, y)]))
    np.testing.assert_allclose(estimate.points, place(x, y), atol=1e-5)
    assert (estimate.score > 0.8).all()


def test_the_person_nearest_the_middle_of_the_crop_is_kept_whole() -> None:
    estimate = decoded(heads([(50.0, 30.0), (29.0, 34.0)]))
    np.testing.assert_allclose(estimate.points, place(29.0, 34.0), atol=0.02)


def test_a_joint_is_taken_from_its_heatmap_and_not_from_the_centres_guess() -> None:
    wrong_by = np.tile((2.5, -2.5), (coco.COUNT, 1))
    estimate = decoded(heads([(32.0, 32.0)], wrong_by=wrong_by))
    np.testing.assert_allclose(estimate.points, place(32.0, 32.0), atol=0.005)


def test_sigma_grows_with_doubt() -> None:
    sure, unsure, blind = (decoded(heads([(32.0, 32.0)], logit)).sigma.mean() for logit in (4.0, 0.0, -4.0))
    assert sure < unsure < blind
    np.testing.assert_allclose(sure * CELLS, np.exp(-1 + 2 * (1 - 0.98)), rtol=0.05)


def test_sigma_grows_when_the_cells_disagree() -> None:
    maps = heads([(32.0, 32.0)])
    agreed = decoded(maps)
    maps[3][:] += np.random.default_rng(2).normal(0, 1.5, maps[3].shape)
    disputed = decoded(maps)
    assert (disputed.sigma > agreed.sigma).all()
    np.testing.assert_array_equal(disputed.score, agreed.score)


@pytest.mark.parametrize("corner", [(0.0, 0.0), (63.0, 0.0), (63.0, 63.0)])
def test_a_person_at_the_edge_is_decoded_without_leaving_the_maps(corner: tuple[float, float]) -> None:
    estimate = decoded(heads([corner]))
    assert np.isfinite(estimate.points).all()
    assert np.isfinite(estimate.sigma).all()
    inside = ((np.array(corner) + POSE > 1) & (np.array(corner) + POSE < CELLS - 2)).all(axis=1)
    np.testing.assert_allclose(estimate.points[inside], place(*corner)[inside], atol=0.01)


def test_nobody_is_a_low_score_and_no_warning() -> None:
    empty = tuple(
        np.full((channels, CELLS, CELLS), fill, np.float32) for channels, fill in ((1, -300), (17, -300), (34, 0), (34, 0))
    )
    estimate = decoded(empty)  # type: ignore[arg-type]
    assert (estimate.score < 1e-3).all()
    assert np.isfinite(estimate.points).all()
    assert (estimate.sigma > decoded(heads([(32.0, 32.0)])).sigma).all()


def test_the_pose_network_hands_the_crop_over_as_it_is() -> None:
    seen = []

    class Fake:
        size_px = (256, 256)

        def __call__(self, pictures: np.ndarray) -> dict[str, Float32]:
            seen.append(pictures)
            names = ("centre", "heatmaps", "regressions", "offsets")
            return {name: part[np.newaxis] for name, part in zip(names, heads([(32.0, 32.0)]), strict=True)}

    network = PoseNetwork("thunder", Fake())
    crop = np.random.default_rng(0).integers(0, 256, (256, 256, 3), dtype=np.uint8)
    estimate = network.estimate(crop)
    assert network.size_px == 256
    assert network.name == "thunder"
    np.testing.assert_array_equal(seen[0], crop[np.newaxis])
    np.testing.assert_allclose(estimate.points, place(32.0, 32.0), atol=1e-5)
    assert estimate.points.dtype == estimate.sigma.dtype == estimate.score.dtype == np.float32
