"""Standing, the poses between samples, and what a timeline refuses."""

import numpy as np
import pytest

from models.body.limits import excess_rad, limits_rad
from models.motions import rotations
from models.motions.motion import CONTACTS, RATE_HZ, Motion
from models.motions.standing import stand
from models.motions.timeline import Timeline
from models.motions.vocabulary import Body
from models.skeleton import coco_feet, smpl
from tests.pupils import some_pupil


@pytest.mark.parametrize(("age", "sex", "seed"), [(6, "female", 1), (9, "male", 2), (14, "female", 3), (35, "male", 4)])
def test_whoever_stands_has_both_soles_on_the_floor_and_his_weight_over_them(age: float, sex: str, seed: int) -> None:
    subject = some_pupil(age, "male" if sex == "male" else "female", seed)
    pose = stand(subject)
    skin, points = subject.body.vertices_m(pose), subject.body.coco_m(pose)
    assert abs(skin[:, 2].min()) < 1e-3
    for side in ("left", "right"):
        toe, heel = (points[coco_feet.INDEX[f"{side}_{name}"]] for name in ("big_toe", "heel"))
        assert heel[0] < skin[:, 0].mean() < toe[0]
    assert skin[:, 2].max() > 0.98 * subject.body.stature_m
    assert not excess_rad(pose.rotations_rad, limits_rad(age)).any()
    assert np.allclose(pose.translation_m[:2], 0.0)


def test_hanging_arms_do_not_touch_the_thighs() -> None:
    subject = some_pupil(10, "female", 5)
    points = subject.body.joints_m(stand(subject))
    hip, wrist, shoulder = (points[smpl.INDEX[f"left_{name}"]] for name in ("hip", "wrist", "shoulder"))
    assert 0.05 < wrist[1] - hip[1] < 0.25
    assert wrist[2] < shoulder[2] - 0.3


def turning(count: int = 25) -> Motion:
    """Falls freely and turns about one axis at an even pace."""
    times = np.arange(count) / RATE_HZ
    turned = np.zeros((count, smpl.COUNT, 3))
    turned[:, :, 2] = 6.0 * times[:, None]
    places = np.stack((times, np.zeros(count), 1 - 4.9 * times**2), axis=-1)
    return Motion(places, turned, np.zeros((count, len(CONTACTS)), bool))


def test_poses_between_samples_are_on_the_motion() -> None:
    motion = turning()
    for t_s in np.linspace(0, motion.duration_s, 37):
        pose = motion.pose_at(float(t_s))
        assert np.allclose(pose.rotations_rad[:, 2], 6.0 * t_s, atol=1e-9)
        assert np.allclose(pose.translation_m, (t_s, 0, 1 - 4.9 * t_s**2), atol=2e-5)


def test_the_pose_at_a_samples_time_is_that_sample() -> None:
    motion = turning()
    for number in (0, 7, 24):
        assert np.allclose(motion.pose_at(number / RATE_HZ).vector, motion.pose(number).vector, atol=1e-9)


@pytest.mark.parametrize("t_s", [-0.001, 0.2, float("nan")])
def test_there_is_no_pose_outside_a_motion(t_s: float) -> None:
    with pytest.raises(ValueError, match=r"has poses from 0 to 0\.1 s"):
        turning().pose_at(t_s)


def test_turns_survive_the_way_to_matrices_and_back_also_near_half_a_turn() -> None:
    generator = np.random.default_rng(3)
    axes = rotations.unit(generator.normal(size=(400, 3)))
    angles = np.concatenate((generator.uniform(0, np.pi, 200), np.pi - 10.0 ** -generator.uniform(1, 9, 100), np.zeros(100)))
    turned = axes * angles[:, None]
    assert np.allclose(rotations.vectors(rotations.matrices(turned)), turned, atol=1e-9)


def test_a_foot_cannot_step_while_it_is_in_the_air() -> None:
    line = Timeline(some_pupil(10, "male", 1))
    line.step("left", 0.2, 0.6, (0.5, 0))
    with pytest.raises(ValueError, match=r"left foot lifts at 0\.500 s, but is in the air"):
        line.step("left", 0.5, 0.8, (0.9, 0))


def test_a_flight_needs_keys_of_the_pelvis_at_its_ends_and_none_within() -> None:
    line = Timeline(some_pupil(10, "male", 1))
    line.key(0.5, Body(height=1.1))
    line.flight(0.5, 0.9)
    with pytest.raises(ValueError, match=r"flight begins or ends at 0\.900 s"):
        line.motion(1.2)
    line.key(0.9, Body(height=1.1))
    line.key(0.7, Body(height=1.3))
    with pytest.raises(ValueError, match=r"where gravity rules"):
        line.motion(1.2)
