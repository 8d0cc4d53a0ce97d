"""Whether what belongs together comes together: of simulated pupils at the box's rate, who are told when to do what."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from models.messages.motion import JointState
from models.motions.perform import perform
from models.motions.performance import Performance
from models.skeleton import coco
from models.teaching.measure import Measure
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.measured import Measured
from services.evaluation.measures.reduce import evaluate
from services.evaluation.signals.reading import Reading
from services.evaluation.track import Track, known_track
from tests.bench.teaching.twinned import Truth, attempt_of
from tests.pupils import pupil

pytestmark = pytest.mark.slow


@cache
def _performed(action: str, severity: float, fault: str) -> tuple[Track, FoundAttempt]:
    motion = perform(Performance(action, faults={fault: severity} if severity else {}), pupil())
    (attempt,) = motion.attempts
    joints_m = Truth(pupil(), motion).joints_m(np.arange(0, motion.duration_s, 1 / 30))
    return known_track(joints_m, 1 / 30, 0.005), attempt_of(attempt)


def _hand_after_body(track: Track, attempt: FoundAttempt) -> Measured:
    return evaluate(Measure(function="hand_after_body"), Reading(track, attempt.handed), attempt)


@pytest.mark.parametrize("severity", [0.0, 0.5, 1.0, 2.0])
def test_a_hit_is_as_late_after_the_top_of_the_jump_as_it_was_told_to_be(severity: float) -> None:
    found = _hand_after_body(*_performed("volleyball_spike", severity, "late_hit"))
    assert found.known
    assert found.value == pytest.approx(0.1 * severity, abs=0.03)
    assert found.sigma < 0.05


@pytest.mark.parametrize("off_s", [-0.05, 0.05])
def test_a_keyframe_that_is_a_frame_and_a_half_off_makes_no_hit_late(off_s: float) -> None:
    track, attempt = _performed("volleyball_spike", 1.0, "late_hit")
    start, exertion, peak, end = attempt.moments_s
    moved = _hand_after_body(track, replace(attempt, moments_s=(start, exertion, peak + off_s, end)))
    assert moved.value == pytest.approx(_hand_after_body(track, attempt).value, abs=0.01)


def test_of_a_hand_that_was_hidden_at_the_hit_nobody_knows_when_it_was_highest() -> None:
    track, attempt = _performed("volleyball_spike", 0.0, "late_hit")
    states = track.states.copy()
    states[np.abs(track.t_s - attempt.moment_s("peak")) < 0.05, coco.INDEX[f"{attempt.handed}_wrist"]] = JointState.GUESSED
    assert not _hand_after_body(replace(track, states=states), attempt).known
