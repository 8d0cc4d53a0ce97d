"""Equation 17: energy in per-frame units, and its maxima."""

import numpy as np
import pytest

from models.arrays import Float
from services.evaluation.energy import EnergyConfig, keyframes_of_energy, motion_energy


def _strokes(*centres: int, frames: int = 90) -> Float:
    """(T, 17, 3) a hand that moves fastest at these frames."""
    joints = np.zeros((frames, 17, 3))
    for centre in centres:
        joints[:, 9, 0] += 0.25 * np.tanh((np.arange(frames) - centre) / 3)
    return joints


def test_energy_is_that_of_the_formula_in_units_of_frames() -> None:
    t = np.arange(12.0)
    joints = np.zeros((12, 17, 3))
    joints[:, 4, 1] = 0.01 * t**2
    expected = (0.02 * t[1:-1]) ** 2 + 0.3 * 0.02**2
    np.testing.assert_allclose(motion_energy(joints)[1:-1], expected)


def test_unknown_joints_count_as_the_mean_of_the_known_ones_and_unknown_frames_as_the_nearest() -> None:
    joints = np.zeros((12, 17, 3))
    joints[:, :, 0] = 0.02 * np.arange(12.0)[:, None]
    whole = motion_energy(joints)
    joints[:, :9] = np.nan
    joints[5:7] = np.nan
    np.testing.assert_allclose(motion_energy(joints), whole)
    assert (motion_energy(np.full((12, 17, 3), np.nan)) == 0).all()


def test_maxima_are_found_where_the_motion_is_fastest() -> None:
    np.testing.assert_allclose(keyframes_of_energy(_strokes(25, 60)), [25, 60], atol=1)


def test_of_two_maxima_that_are_near_the_lower_one_is_suppressed() -> None:
    joints = _strokes(30)
    joints[:, 10, 0] += 0.2 * np.tanh((np.arange(90) - 39) / 3)
    assert len(keyframes_of_energy(joints)) == 2
    np.testing.assert_allclose(keyframes_of_energy(joints, EnergyConfig(apart=15)), [30], atol=1)


@pytest.mark.parametrize("frames", [0, 1, 2, 5, 6])
def test_what_is_shorter_than_the_window_has_no_keyframe(frames: int) -> None:
    assert len(keyframes_of_energy(_strokes(3, frames=frames))) == 0
    assert len(motion_energy(_strokes(3, frames=frames))) == frames
