"""Laws of the offsets between footage and calibration, on a simulated person in front of four cameras."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.arrays import Float
from models.camera.pinhole import Camera
from models.camera.rig import Rig
from services.calibration.shift import residuals_px, solve_shifts

FRAMES = 12


def facing(name: str, angle: float) -> Camera:
    """A camera 4 m from the origin at 2 m height that looks at a person's middle."""
    centre = np.array((4 * np.cos(angle), 4 * np.sin(angle), 2.0))
    forward = np.array((0, 0, 1.0)) - centre
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, (0, 0, 1.0))
    right /= np.linalg.norm(right)
    rotation = np.stack((right, np.cross(forward, right), forward))
    matrix = np.array(((1100.0, 0, 360), (0, 1100.0, 640), (0, 0, 1)))
    distortion = np.array((-0.05, 0.1, 0.0005, 0.0005, 0.0))
    return Camera(name, (720, 1280), matrix, distortion, rotation, -rotation @ centre, np.zeros(2))


RIG = Rig(tuple(facing(f"cam0{i}", angle) for i, angle in enumerate((0.3, 1.9, 3.6, 5.2), start=1)))


def person_points(seed: int) -> Float:
    """(FRAMES, 17, 3) joints of somebody who moves about."""
    random = np.random.default_rng(seed)
    body = random.uniform((-0.4, -0.4, 0.0), (0.4, 0.4, 1.8), (17, 3))
    walk = np.cumsum(random.normal(0, 0.05, (FRAMES, 1, 3)), axis=0) * (1, 1, 0)
    return body + walk + random.normal(0, 0.03, (FRAMES, 17, 3))


def observed(shifts: Float, seed: int, noise_px: float) -> tuple[Float, Float]:
    random = np.random.default_rng(seed + 1)
    points = person_points(seed)
    pixels = np.stack([camera.project(points) for camera in RIG.with_shifts(shifts)], axis=1)
    return pixels + random.normal(0, noise_px, pixels.shape), random.uniform(0.3, 1.0, pixels.shape[:3])


shifts_px = st.lists(st.floats(-15, 15), min_size=8, max_size=8).map(lambda values: np.array(values).reshape(4, 2))
seeds = st.integers(0, 1000)


@pytest.mark.slow
@settings(deadline=None, max_examples=10)
@given(shifts=shifts_px, seed=seeds)
def test_the_solved_offsets_explain_what_was_seen(shifts: Float, seed: int) -> None:
    pixels, scores = observed(shifts, seed, noise_px=1.0)
    solved = solve_shifts(RIG, pixels, scores)
    assert np.nanmedian(residuals_px(RIG.with_shifts(solved), pixels, scores)) < 1.6


@pytest.mark.slow
@settings(deadline=None, max_examples=8)
@given(shifts=shifts_px, seed=seeds)
def test_no_larger_offsets_are_chosen_than_the_pictures_ask_for(shifts: Float, seed: int) -> None:
    pixels, scores = observed(shifts, seed, noise_px=0.5)
    assert np.linalg.norm(solve_shifts(RIG, pixels, scores)) <= np.linalg.norm(shifts) + 3


@pytest.mark.slow
@settings(deadline=None, max_examples=8)
@given(seed=seeds)
def test_footage_that_agrees_with_its_calibration_is_left_alone(seed: int) -> None:
    pixels, scores = observed(np.zeros((4, 2)), seed, noise_px=1.0)
    assert np.abs(solve_shifts(RIG, pixels, scores)).max() < 1.5


@pytest.mark.slow
@settings(deadline=None, max_examples=8)
@given(shifts=shifts_px, seed=seeds)
def test_a_tenth_of_the_keypoints_on_somebody_else_changes_little(shifts: Float, seed: int) -> None:
    pixels, scores = observed(shifts, seed, noise_px=1.0)
    clean = solve_shifts(RIG, pixels, scores)
    wrong = np.random.default_rng(seed + 2).random(scores.shape) < 0.1
    spoilt = np.where(wrong[..., None], pixels + np.array((140.0, -60.0)), pixels)
    assert np.abs(solve_shifts(RIG, spoilt, scores) - clean).max() < 4


def test_unseen_keypoints_are_left_out() -> None:
    pixels, scores = observed(np.full((4, 2), 5.0), 3, noise_px=0.5)
    pixels[::3, 1] = np.nan
    scores[1::3, 2] = 0.0
    assert np.isfinite(solve_shifts(RIG, pixels, scores)).all()


def test_too_little_to_solve_is_said() -> None:
    pixels, scores = observed(np.zeros((4, 2)), 3, noise_px=0.5)
    scores[:, 2:] = 0.0
    with pytest.raises(ValueError, match="only 0 keypoints are seen by three"):
        solve_shifts(RIG, pixels, scores)
