"""How tall a pupil is: by what was seen of him, and less surely by what was guessed."""

import numpy as np
import pytest

from models.messages.motion import JointState
from models.skeleton import coco
from services.evaluation.signals.series import ERRORS, Series
from services.evaluation.stature import stature_of
from services.evaluation.track import Track, known_track
from services.evaluation.uncertainty import NETWORK
from tests.stick_figure import figure, still

FRAMES = 60
ANKLES = [coco.INDEX["left_ankle"], coco.INDEX["right_ankle"]]


def guessed(share: float) -> Track:
    """The ankles are guessed 15 cm too low in so many frames."""
    track = still(figure(), FRAMES)
    states, joints_m = track.states.copy(), track.joints_m.copy()
    frames = slice(0, round(share * FRAMES))
    for ankle in ANKLES:
        states[frames, ankle] = JointState.GUESSED
        joints_m[frames, ankle] -= (0.0, 0.0, 0.15)
    return Track(track.t_s, joints_m, track.covariance_m2, states)


def test_guessed_joints_do_not_tell_how_tall_somebody_is() -> None:
    true = stature_of(guessed(0.0))
    assert stature_of(guessed(0.8)).metres == pytest.approx(true.metres)


def test_who_is_known_but_by_guessed_joints_is_as_tall_as_they_say_and_nobody_is_sure_of_it() -> None:
    true, told = stature_of(guessed(0.0)), stature_of(guessed(1.0))
    assert told.sigma_m > 1.8 * true.sigma_m
    assert np.isfinite(told.metres)


def test_few_frames_make_it_less_sure() -> None:
    random = np.random.default_rng(0)
    joints = np.repeat(figure()[None], FRAMES, axis=0) + 0.03 * random.standard_normal((FRAMES, coco.COUNT, 3))
    few, many = (stature_of(known_track(joints[:count], 1 / 30)) for count in (6, FRAMES))
    assert few.sigma_m > 1.5 * many.sigma_m


def test_an_error_of_the_stature_is_the_same_however_far_apart_two_instants_are() -> None:
    """Hips that sink from 50 to 25 % of a stature that is known to 1.3 % sink by 25 +- 0.33, not 0.73."""
    t_s = np.arange(FRAMES) / 10
    heights = np.linspace(50, 25, FRAMES)
    nothing = np.zeros((FRAMES, ERRORS))
    series = Series("pct", t_s, heights, nothing, nothing, 0.013 * heights, np.ones(FRAMES, np.bool_), NETWORK)
    change, mean = np.zeros(FRAMES), np.full(FRAMES, 1 / FRAMES)
    change[[0, -1]] = (-1, 1)
    assert np.sqrt(series.variance(change)) == pytest.approx(0.013 * 25)
    assert np.sqrt(series.variance(mean)) == pytest.approx(0.013 * 37.5)
    assert series.sigma == pytest.approx(0.013 * heights)
