"""Tracks at another rate: places between frames lie on the motion, and what is not known stays so."""

import numpy as np
import pytest

from models.arrays import Float
from models.messages.motion import JointState
from services.evaluation.resampling import resampled
from services.evaluation.track import Track, known_track

FRAME_S = 1 / 30


def swinging(rate_hz: float, seconds: float = 2.0) -> Track:
    """Every joint swings at 2 Hz and 30 cm, with up to 47 m/s2."""
    t_s = np.arange(0, seconds, 1 / rate_hz)
    return known_track(places(t_s), 1 / rate_hz, 0.01)


def places(t_s: Float) -> Float:
    phases = np.arange(17)[None, :, None] + np.arange(3)[None, None, :]
    return np.asarray(0.3 * np.sin(2 * np.pi * 2.0 * t_s[:, None, None] + phases))


@pytest.mark.parametrize("rate_hz", [25.0, 50.0, 59.94, 100.0, 240.0, 1000.0])
def test_places_between_frames_are_those_of_the_motion(rate_hz: float) -> None:
    track = resampled(swinging(rate_hz), FRAME_S)
    assert track.frame_s == pytest.approx(FRAME_S)
    inside = (track.t_s > 0.1) & (track.t_s < 1.8)
    np.testing.assert_allclose(track.joints_m[inside], places(track.t_s)[inside], atol=0.004)
    assert track.t_s[-1] <= swinging(rate_hz).t_s[-1] + 1e-6
    assert (track.states == JointState.SEEN).all()


def test_a_track_that_has_the_rate_is_left_as_it_is() -> None:
    track = swinging(30.0)
    assert resampled(track, FRAME_S) is track


def test_every_second_frame_of_a_fast_track_is_as_it_was() -> None:
    fast = swinging(60.0)
    slow = resampled(fast, FRAME_S)
    np.testing.assert_allclose(slow.joints_m, fast.joints_m[::2], atol=1e-12)
    np.testing.assert_array_equal(slow.covariance_m2, fast.covariance_m2[::2])


def test_what_is_unknown_or_guessed_on_either_side_is_unknown_or_guessed() -> None:
    fast = swinging(50.0)
    states = fast.states.copy()
    states[20:30, 9] = JointState.UNKNOWN
    states[40:50, 9] = JointState.GUESSED
    states[3:, 4] = JointState.UNKNOWN
    known = (states != JointState.UNKNOWN)[..., None]
    hidden = np.where(known, fast.joints_m, np.nan)
    track = resampled(Track(fast.t_s, hidden, np.where(known[..., None], fast.covariance_m2, np.nan), states), FRAME_S)
    # Frames 20 to 29 are at 0.4 to 0.58 s: who lies between 19 and 30 has an unknown neighbour.
    unknown = (track.t_s > 0.38 + 1e-9) & (track.t_s < 0.6 - 1e-9)
    np.testing.assert_array_equal(track.states[:, 9] == JointState.UNKNOWN, unknown)
    np.testing.assert_array_equal(np.isnan(track.joints_m[:, 9]).all(axis=1), unknown)
    np.testing.assert_array_equal(np.isnan(track.covariance_m2[:, 9, 0, 0]), unknown)
    guessed = (track.t_s > 0.78 + 1e-9) & (track.t_s < 1.0 - 1e-9)
    np.testing.assert_array_equal(track.states[:, 9] == JointState.GUESSED, guessed)
    assert (track.states[:, 4] == JointState.UNKNOWN).all(), "three frames are no curve"
    assert (track.states[:, 0] == JointState.SEEN).all()


def test_frames_of_two_are_enough_or_nothing_is_known() -> None:
    track = resampled(known_track(places(np.array((0.0, 0.2))), 0.2), FRAME_S)
    assert len(track) == 7
    assert (track.states == JointState.UNKNOWN).all()
