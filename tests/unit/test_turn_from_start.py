"""How far somebody turned counts from where he looked as his attempt began, whatever he did before."""

from dataclasses import replace

import msgspec
import numpy as np
import pytest

from models.arrays import Float
from models.messages.feedback import Feedback
from models.messages.motion import JointState
from models.skeleton import coco
from models.teaching.measure import Measure
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.reduce import evaluate
from services.evaluation.report.curve import Curve, curves_of
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.reading import Reading
from services.evaluation.stature import Stature
from services.evaluation.track import Track, known_track
from services.evaluation.uncertainty import NETWORK
from tests.reported import attempt as reported
from tests.stick_figure import figure
from tests.taught import SIGMA_M, performance, shipped

TURN = Measure(signal="heading", over=("start", "peak"), take="max")
WAIT = 40
"""Frames before the recording of a clear: all that is looked at before its start."""


def on_the_spot(joints_m: Float, degrees: Float) -> Float:
    """(T, 17, 3) each frame turned about the vertical through the middle of its hips, to the left."""
    sine, cosine, zero, one = np.sin(np.radians(degrees)), np.cos(np.radians(degrees)), 0 * degrees, 1 + 0 * degrees
    turns = np.array(((cosine, -sine, zero), (sine, cosine, zero), (zero, zero, one))).transpose(2, 0, 1)
    hips = joints_m[:, [coco.INDEX["left_hip"], coco.INDEX["right_hip"]]].mean(axis=1, keepdims=True)
    return np.asarray((joints_m - hips) @ turns.swapaxes(1, 2) + hips)


def clear(turned_before_deg: float) -> tuple[Track, FoundAttempt]:
    """A clear before which somebody, until half a second before its start, turns on the spot to where he looks then."""
    track, attempt = performance("badminton_clear")
    joints_m = np.concatenate((np.repeat(track.joints_m[:1], WAIT, axis=0), track.joints_m))
    start, exertion, peak, end = (moment_s + WAIT * track.frame_s for moment_s in attempt.moments_s)
    t_s = np.arange(len(joints_m)) * track.frame_s
    away_deg = np.interp(t_s, (start - 1.2, start - 0.5), (turned_before_deg, 0.0))
    moved = known_track(on_the_spot(joints_m, away_deg), track.frame_s, SIGMA_M)
    return moved, replace(attempt, moments_s=(start, exertion, peak, end))


@pytest.mark.parametrize("turned_before_deg", [-50.0, 50.0])
def test_a_turn_before_the_attempt_is_none_of_it(turned_before_deg: float) -> None:
    """Who walked in turned one way and hit without a turn was praised for it; the other way, a turn was corrected."""
    still, turned = (evaluate(TURN, Reading(track, "right"), attempt) for track, attempt in (clear(0.0), clear(turned_before_deg)))
    assert still.known
    assert turned.known
    assert turned.value == pytest.approx(still.value, abs=1e-6)


@pytest.mark.parametrize("apart_s", [0.1, 0.5, 2.0])
def test_a_turn_is_as_unsure_as_the_difference_of_two_directions(apart_s: float) -> None:
    lasting = replace(NETWORK, noise_scale=(0.0,) * coco.COUNT, timing_s=0.0, moment_s=0.0)
    standing = known_track(np.repeat(figure()[None], 90, axis=0), 1 / 30, SIGMA_M)
    reading = Reading(standing, "right", lasting, Stature(1.5, 0.0))
    attempt = FoundAttempt("badminton_clear", "right", (0.3, 0.3 + apart_s / 2, 0.3 + apart_s, 0.6 + apart_s))
    found = evaluate(Measure(signal="heading", at="peak"), reading, attempt)
    alike = np.exp(-((apart_s / lasting.landmark_s) ** 2) / 2)
    assert found.value == pytest.approx(0, abs=1e-9)
    assert found.sigma == pytest.approx(reading.of(CATALOGUE["heading"], "lead").sigma[0] * np.sqrt(2 * (1 - alike)), rel=0.01)


def test_a_turn_from_where_nobody_saw_the_pupil_is_unknown() -> None:
    track, attempt = clear(0.0)
    states = track.states.copy()
    states[np.abs(track.t_s - attempt.moment_s("start")) <= 0.05] = JointState.GUESSED
    assert not evaluate(TURN, Reading(replace(track, states=states), "right"), attempt).known


def test_where_two_values_are_compared_the_start_is_of_no_account() -> None:
    track, attempt = clear(0.0)
    states = track.states.copy()
    states[np.abs(track.t_s - attempt.moment_s("start")) <= 0.05] = JointState.GUESSED
    part, whole = (Reading(one, "right") for one in (replace(track, states=states), track))
    measure = Measure(signal="heading", over=("exertion", "end"), take="range")
    one, other = (evaluate(measure, reading, attempt) for reading in (part, whole))
    assert one.known
    assert one == other


def test_the_curve_of_a_turn_is_against_the_start_as_its_number_is() -> None:
    told = reported("badminton_clear", exemplar=0, cue="no_body_turn", cue_certainty=0.9, praise="")
    start = told.frame_of(told.keyframes_ns[0])
    away_deg = np.where(np.arange(len(told.joints_m)) < start - 2, 50.0, 0.0)
    turned = msgspec.structs.replace(told, joints_m=on_the_spot(told.joints_m.astype(np.float64), away_deg).astype(np.float32))

    def curve_of_the_turn(feedback: Feedback) -> Curve:
        curves = curves_of(feedback, shipped().teachings["badminton_clear"])
        return next(one for one in curves if one.signal == "heading")

    one, other = curve_of_the_turn(told), curve_of_the_turn(turned)
    np.testing.assert_allclose(other.pupil_deg[start:], one.pupil_deg[start:], atol=1e-3)
    for degrees in (one.pupil_deg, one.standard_deg):
        assert np.interp(0.0, one.t_s, degrees) == pytest.approx(0, abs=2)
