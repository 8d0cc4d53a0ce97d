"""The benchmark's own arithmetic, against closed forms: a wrong ruler makes every figure wrong."""

import numpy as np
import pytest

from models.camera.rig import Rig
from tests.bench.figures import inside, limb_variation_pct, peak_speed_m_s, reprojection_px
from tests.property.test_camera_laws import camera


def test_a_perfect_reconstruction_has_no_reprojection_error() -> None:
    ours = camera()
    joints = np.random.default_rng(0).uniform(-0.5, 0.5, (4, 17, 3))
    points = ours.project(joints)[:, None]
    assert np.allclose(reprojection_px(Rig((ours,)), joints, points, np.ones((4, 1, 17)), min_score=0.3), 0)


def test_reprojection_is_measured_in_pixels_and_leaves_out_low_scores() -> None:
    ours = camera()
    joints = np.zeros((1, 17, 3))
    points = ours.project(joints)[:, None] + np.array((3.0, 4.0))
    scores = np.full((1, 1, 17), 0.2)
    scores[0, 0, 5] = 0.3
    distance = reprojection_px(Rig((ours,)), joints, points, scores, min_score=0.3)
    assert distance[0, 0, 5] == pytest.approx(5.0)
    assert np.isnan(distance).sum() == 16


def test_rigid_limbs_do_not_vary_and_a_breathing_one_does() -> None:
    joints = np.random.default_rng(1).uniform(-1, 1, (1, 17, 3)).repeat(50, axis=0)
    assert max(limb_variation_pct(joints).values()) < 1e-9
    joints[:, 9] = joints[:, 7] + np.array((0.25, 0, 0))
    joints[::2, 9] = joints[::2, 7] + np.array((0.35, 0, 0))
    assert limb_variation_pct(joints)["left_forearm"] == pytest.approx(100 * 0.05 / 0.30)


def test_peak_speed_of_a_uniform_motion_is_its_speed() -> None:
    positions = np.arange(20)[:, None] * np.array((0.1, 0.0, 0.0))
    assert peak_speed_m_s(positions, 30.0) == pytest.approx(3.0)


def test_points_on_the_border_of_a_box_are_inside() -> None:
    assert inside(np.array(((0.0, 0.0), (10.0, 5.0), (10.1, 5.0))), np.array((0.0, 0.0, 10.0, 5.0))).tolist() == [True, True, False]
