"""How long phases take: known only if both keyframes were seen."""

import numpy as np
import pytest

from models.messages.motion import JointState
from models.skeleton import coco
from models.teaching.measure import Measure
from services.evaluation.measures.measured import Measured
from services.evaluation.measures.reduce import evaluate
from services.evaluation.signals.reading import Reading
from services.evaluation.track import Track
from tests.taught import performance

TRACK, ATTEMPT = performance("forward_roll")


def without(around_s: float, half_s: float, *joints: str, state: JointState = JointState.UNKNOWN) -> Track:
    hidden = np.flatnonzero(np.abs(TRACK.t_s - around_s) <= half_s)
    states, joints_m = TRACK.states.copy(), TRACK.joints_m.copy()
    for joint in joints or coco.NAMES:
        states[hidden, coco.INDEX[joint]] = state
        if state == JointState.UNKNOWN:
            joints_m[hidden, coco.INDEX[joint]] = np.nan
    return Track(TRACK.t_s, joints_m, TRACK.covariance_m2, states)


def measured(name: str, track: Track) -> Measured:
    return evaluate(Measure(function=name), Reading(track, "right"), ATTEMPT)


@pytest.mark.parametrize("name", ["recovery_time", "effort_time", "preparation_share"])
def test_a_keyframe_that_nobody_saw_times_nothing(name: str) -> None:
    peak_s = ATTEMPT.moments_s[2]
    assert measured(name, TRACK).known
    for track in (
        without(peak_s, 0.2),
        without(peak_s, 0.2, "left_hip", "right_hip"),
        without(peak_s, 0.2, state=JointState.GUESSED),
    ):
        hidden = measured(name, track)
        assert not hidden.known
        assert hidden.why
    assert measured("preparation_time", without(peak_s, 0.2)).known


def test_limbs_that_are_hidden_in_a_roll_leave_its_time_known() -> None:
    part = without(ATTEMPT.moments_s[2], 0.2, "left_wrist", "right_wrist", "left_ankle", "right_ankle", "nose")
    assert measured("recovery_time", part).known


def test_a_keyframe_beyond_the_recording_times_nothing() -> None:
    assert not measured("recovery_time", TRACK.part(0, round(ATTEMPT.moments_s[2] * 30) + 5)).known
