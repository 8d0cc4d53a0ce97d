"""The landmark bias is found where it is, whatever the pictures' noise; and taken off, it is gone."""

from dataclasses import replace

import numpy as np
import pytest

from models.arrays import Float
from models.messages.motion import JointState, Motion
from models.skeleton import coco
from models.skeleton.segment_axes import segment_axes, trunk_length_m
from services.fusion.config import PRESETS, FusionConfig
from services.fusion.landmark_bias import THUNDER
from services.fusion.landmarks import corrected
from services.fusion.pipeline import initial_state, step
from services.fusion.verdict import Pose
from tests.bench.networks.corrections import source_of
from tests.bench.networks.landmarks import PAIRS, Looks, all_biases, as_points, estimate_bias
from tests.synthetic.gym import Gym, ring_rig
from tests.synthetic.person import Person

RIG = ring_rig(4, distorted=True)
TRUTH = np.stack([Person().joints(t) for t in np.arange(0, 4, 0.05)])


def drawn_bias() -> Float:
    """(17, 3) of a symmetric network."""
    bias = np.random.default_rng(11).normal(scale=0.06, size=(coco.COUNT, 3))
    bias[0, 1] = 0.0
    for left, right in (joints for joints in PAIRS.values() if len(joints) == 2):
        bias[right] = bias[left] * (1, -1, 1)
    return bias


def moved(points_m: Float, bias: Float) -> Float:
    offset: Float = (segment_axes(points_m) @ bias[..., None])[..., 0] * trunk_length_m(points_m)[..., None, None]
    return points_m + offset


def looks(bias: Float, noise_px: float = 0.0, outliers: float = 0.0) -> list[Looks]:
    found, generator = [], np.random.default_rng(12)
    for camera in RIG:
        points = camera.project(moved(TRUTH, bias))
        points += noise_px * generator.normal(size=points.shape)
        points[generator.random(points.shape[:2]) < outliers] += 80.0
        found.append(Looks(camera, points, TRUTH, np.ones(points.shape[:2], np.bool_)))
    return found


def test_a_bias_on_the_body_is_found_through_distorted_lenses() -> None:
    bias = drawn_bias()
    np.testing.assert_allclose(as_points(all_biases(looks(bias))), bias, atol=0.004)  # projection is not quite linear in it


def test_noise_and_outliers_blur_it_little() -> None:
    bias = drawn_bias()
    found = all_biases(looks(bias, noise_px=4.0, outliers=0.1))
    assert np.abs(as_points(found) - bias).max() < 0.02
    assert all(found[name].count == len(joints) * 4 * len(TRUTH) for name, joints in PAIRS.items())
    assert max(float(each.sigma_mm.max()) for each in found.values()) < 5.0


def test_too_few_pictures_say_nothing() -> None:
    few = [
        replace(look, points_px=look.points_px[:3], truth_m=look.truth_m[:3], counts=look.counts[:3])
        for look in looks(drawn_bias())
    ]
    assert estimate_bias(few, PAIRS["nose"]) is None
    assert all_biases(few[:1]) == {}
    assert not as_points({}).any()


def pose(points_m: Float, states: JointState = JointState.SEEN) -> Pose:
    return Pose(points_m, np.zeros((17, 3, 3)), np.full(17, states, np.uint8), np.zeros(17, np.uint32))


def test_corrected_joints_are_the_bodys_points() -> None:
    bias = drawn_bias()
    for truth in TRUTH[::10]:
        found = moved(truth, bias)
        before = np.linalg.norm(found - truth, axis=1).mean()
        after = np.linalg.norm(corrected(pose(found), bias).joints_m - truth, axis=1).mean()
        assert after < 0.3 * before, "axes of biased points are not quite those of the body"


def test_without_a_bias_nothing_is_changed_to_the_last_bit() -> None:
    found = pose(TRUTH[3])
    np.testing.assert_array_equal(corrected(found, np.zeros((17, 3))).joints_m, found.joints_m)


def test_unknown_joints_stay_as_they_are_and_keep_others_from_nothing_but_their_own_segments() -> None:
    bias = drawn_bias()
    found = pose(TRUTH[3].copy())
    wrist = coco.INDEX["left_wrist"]
    found.states[wrist] = JointState.UNKNOWN
    found.joints_m[wrist] = 0.0
    after = corrected(found, bias)
    assert not after.joints_m[wrist].any()
    assert np.isfinite(after.joints_m).all()
    other = np.arange(17) != wrist
    np.testing.assert_array_equal(after.joints_m[other], corrected(pose(TRUTH[3]), bias).joints_m[other])


def test_without_a_trunk_there_are_no_axes_and_nothing_is_moved() -> None:
    found = pose(TRUTH[3].copy())
    for joint in coco.TRUNK:
        found.states[joint] = JointState.UNKNOWN
        found.joints_m[joint] = 0.0
    after = corrected(found, drawn_bias())
    limbs = [coco.INDEX[name] for name in ("left_wrist", "right_knee")]
    np.testing.assert_array_equal(after.joints_m[limbs], TRUTH[3][limbs])


@pytest.mark.parametrize("name", ["shoulder", "hip"])
def test_a_bias_outwards_is_the_same_number_on_both_sides(name: str) -> None:
    bias = np.zeros((coco.COUNT, 3))
    left, right = PAIRS[name]
    bias[left, 1], bias[right, 1] = 0.1, -0.1
    found = all_biases(looks(bias))[name]
    np.testing.assert_allclose(found.shares, (0, 0.1, 0), atol=0.004)
    np.testing.assert_allclose(found.mm, 1e3 * found.shares * trunk_length_m(TRUTH).mean(), rtol=1e-6)


def fused(gym: Gym, config: FusionConfig) -> list[Motion]:
    state, motions = initial_state(gym.rig), list[Motion]()
    for event in gym.events():
        state, output = step(state, event, config)
        motions += output.motions
    return motions


@pytest.mark.slow
def test_fusion_takes_the_bias_off_what_it_gives_out_and_off_nothing_that_it_fuses() -> None:
    bias = drawn_bias()
    gym = Gym(seconds=1.0, noise_px=0.5, tail=0.0, occlusion=0.0, swap=0.0, distractor=0.0)
    plain, moved_back = (fused(gym, replace(PRESETS["default"], landmark_bias=each)) for each in (None, bias))
    assert len(plain) == len(moved_back)
    assert len(plain) > 10
    for before, after in zip(plain, moved_back, strict=True):
        known = replace(pose(before.joints_m.astype(np.float64)), states=before.states)
        np.testing.assert_allclose(after.joints_m, corrected(known, bias).joints_m, atol=1e-5)
        np.testing.assert_array_equal(after.states, before.states)


def test_the_corrections_that_are_written_are_python_in_the_house_style_and_say_what_was_found() -> None:
    bias = drawn_bias()
    text = source_of(all_biases(looks(bias)), 2)
    found: dict[str, object] = {}
    exec(text, found)  # noqa: S102 - it is our own
    np.testing.assert_allclose(np.array(found["THUNDER"]), bias, atol=0.005)
    assert "from 2 simulated" in text


def test_the_corrections_that_ship_are_symmetric_and_small() -> None:
    shipped = np.array(THUNDER)
    np.testing.assert_array_equal(shipped[list(coco.MIRROR)] * (1, -1, 1), shipped)
    assert np.abs(shipped).max() < 0.15
    assert np.abs(shipped).max() > 0
