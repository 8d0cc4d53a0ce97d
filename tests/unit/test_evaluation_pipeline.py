"""What becomes of an attempt: whatever was hidden, goes wrong with it or follows it, it is told of once, or counted."""

from dataclasses import replace
from functools import cache

import msgspec
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from models.messages.feedback import MAX_FRAMES, ActivityRequest, Colour, Feedback
from models.messages.motion import JointState, Motion
from models.skeleton import coco
from models.teaching.standard import FRAME_S, LONGEST_S, Exemplar
from services.evaluation import attempts, pipeline
from services.evaluation.attempts import DEFAULT
from services.evaluation.config import EvaluationConfig
from services.evaluation.keyframes import BEFORE_S
from services.evaluation.pipeline import NOTHING, EvaluationOutput, EvaluationState, finish, initial_state, step
from services.evaluation.stream import KEPT_S
from tests.property.test_evaluation_laws import CONFIG, Event, Script, told
from tests.taught import performance, shipped
from tests.unit.test_attempts import stretched

pytestmark = pytest.mark.slow

SOON = 4
"""Frames after an attempt's end: fewer than it is waited for something better."""


def just_ended() -> Script:
    """A squat, and only a moment after it."""
    script = Script()
    script.perform("squat", "right")
    state = initial_state(CONFIG)
    for number, event in enumerate(script.events):
        state, output = step(state, event, CONFIG)
        if output.feedback is not None:
            script.events = script.events[: number + 1 - SOON]
            break
    newest = script.events[-1]
    assert isinstance(newest, Motion)
    script.sequence, script.t_ns = newest.sequence, newest.t_ns
    script.skip()
    return script


@pytest.mark.parametrize("change", ["epoch", "fusion", "pause"])
def test_an_attempt_that_ended_before_the_stream_is_told_of_once(change: str) -> None:
    script = just_ended()
    assert told(script.events) == []
    if change == "epoch":
        script.count_epochs(1)
    elif change == "fusion":
        script.count_anew()
    else:
        script.late(5 * 10**9)
    script.stand(60)
    (feedback,) = told(script.events)
    assert feedback.action == "squat"
    assert feedback.epoch == 0


def test_who_chooses_the_next_action_is_still_told_of_the_last_attempt() -> None:
    script = just_ended()
    state = initial_state(CONFIG)
    for event in script.events:
        state, output = step(state, event, CONFIG)
        assert output == EvaluationOutput()
    state, output = step(state, ActivityRequest("soccer_kick"), CONFIG)
    assert output.feedback is not None
    assert (output.feedback.action, output.feedback.by) == ("squat", "recognised")
    assert state.activity == "soccer_kick"


def test_the_same_choice_again_costs_no_attempt() -> None:
    script = Script()
    script.choose("squat")
    script.perform("squat", "right")
    again = [choice for event in script.events for choice in (event, ActivityRequest("squat"))]
    assert len(told(again)) == 1


def test_at_the_end_of_all_motion_the_last_attempt_is_told_of_once() -> None:
    script = just_ended()
    state = initial_state(CONFIG)
    for event in script.events:
        state, output = step(state, event, CONFIG)
        assert output == NOTHING
    last = finish(state, CONFIG).feedback
    assert last is not None
    assert last.action == "squat"
    assert finish(state, CONFIG) == NOTHING
    assert finish(initial_state(CONFIG), CONFIG) == NOTHING


def hidden(events: list[Event], joints: tuple[str, ...], first: int, end: int) -> list[Event]:
    """The same, but that nobody saw these joints in some of the motions."""
    places = [coco.INDEX[name] for name in joints]
    out = list(events)
    for number in range(max(first, 0), min(end, len(events))):
        motion = events[number]
        assert isinstance(motion, Motion)
        states = motion.states.copy()
        states[places] = JointState.UNKNOWN
        out[number] = msgspec.structs.replace(motion, states=states)
    return out


@cache
def squat() -> tuple[list[Event], int, Feedback]:
    """Somebody stands, squats and stands; the motion with which he begins to, and what is said of it.

    He stands for long enough to be decided on also where the end of his squat was hidden.
    """
    script = Script()
    script.perform("squat", "right")
    for _ in range(20):
        script.show(performance("squat", "right")[0].joints_m[-1])
    (feedback,) = told(script.events)
    times_ns = [event.t_ns for event in script.events if isinstance(event, Motion)]
    return script.events, int(np.searchsorted(times_ns, feedback.keyframes_ns[0])), feedback


def test_whose_hip_was_hidden_until_he_began_is_told_of_and_coloured_as_ever() -> None:
    events, start, seen = squat()
    (feedback,) = told(hidden(events, ("left_hip",), start - 12, start))
    assert feedback.action == "squat"
    assert feedback.keyframes_ns == pytest.approx(seen.keyframes_ns, abs=10**8)
    during = slice(feedback.frame_of(feedback.keyframes_ns[0]), None)
    assert (feedback.colours[during] == Colour.GREEN).mean() > 0.9
    assert feedback.score is not None


def test_whose_shoulder_was_hidden_until_after_he_began_is_told_of_and_grey() -> None:
    """Nobody knows how far he has turned by then."""
    events, start, seen = squat()
    (feedback,) = told(hidden(events, ("left_shoulder",), start - 12, start + 6))
    assert feedback.action == "squat"
    assert feedback.keyframes_ns == pytest.approx(seen.keyframes_ns, abs=10**8)
    assert (feedback.colours == Colour.GREY).all()
    assert np.isnan(feedback.standard_m).all()


def test_of_whom_no_shank_was_seen_while_he_tried_is_told_that_nothing_can_be_said() -> None:
    """Its keyframes cannot be told either, so nothing may be measured by them."""
    events, _, seen = squat()
    (feedback,) = told(hidden(events, ("left_ankle", "right_ankle"), 1, len(events)))
    assert (feedback.action, feedback.score, feedback.cue, feedback.praise) == ("squat", None, "", "")
    assert feedback.keyframes_ns == pytest.approx(seen.keyframes_ns, abs=4 * 10**8)
    assert (feedback.colours == Colour.GREY).all()
    assert not any(judgement.known for judgement in feedback.judgements)
    assert {measure.verdict for measure in feedback.measures} == {"unknown"}
    assert (feedback.states == JointState.SEEN).any(), "the pupil himself is shown"


@settings(max_examples=40, deadline=None)
@given(
    st.sampled_from(
        (("left_hip",), ("right_hip",), ("left_shoulder",), ("right_shoulder", "left_elbow"), ("left_hip", "right_hip"))
    ),
    st.integers(-14, 90),
    st.integers(1, 12),
)
@example(("left_hip",), 60, 11)
def test_a_trunk_that_is_hidden_for_a_moment_costs_no_attempt(joints: tuple[str, ...], after: int, frames: int) -> None:
    events, start, _ = squat()
    (feedback,) = told(hidden(events, joints, start + after, start + after + frames))
    assert feedback.action == "squat"
    assert (feedback.colours[feedback.states == JointState.UNKNOWN] == Colour.GREY).all()


@settings(max_examples=20, deadline=None)
@given(
    st.sampled_from((("left_ankle", "right_ankle"), ("left_shoulder",), ("right_shoulder",), ("left_knee", "right_ankle"))),
    st.integers(-40, 90),
)
def test_whoever_is_half_hidden_from_some_instant_on_is_told_of_all_the_same(joints: tuple[str, ...], after: int) -> None:
    events, start, _ = squat()
    (feedback,) = told(hidden(events, joints, max(start + after, 1), len(events)))
    assert feedback.action == "squat"


def slow_descent(slower: float) -> tuple[EvaluationConfig, Script]:
    """A school teaches to go down into a squat for as long as a movement may take; somebody takes so many times longer."""
    shown = shipped().standards["squat"]
    down = shown.joints_m[: round(shown.moments_s[2] / FRAME_S) + 1]
    joints = stretched(down, round((LONGEST_S - 0.1) / FRAME_S))
    spread = np.full(joints.shape[:2], np.nan)
    moments = (0.2, 5.0, 10.0, LONGEST_S - 0.4)
    standard = replace(shown, performance=Exemplar(joints, moments), spread_m=spread, exemplars=())
    script = Script(stands=joints[0])
    script.stand(20)
    for joints_m in stretched(joints, round(slower * len(joints))):
        script.show(joints_m)
    script.stands = joints[-1]
    script.stand(50)
    return EvaluationConfig({"squat": shipped().teachings["squat"]}, {"squat": standard}), script


def test_an_attempt_of_more_than_half_a_minute_is_told_of_as_a_whole() -> None:
    config, script = slow_descent(1.7)
    (output,) = (output for output in outputs_of(script.events, config)[1] if output != NOTHING)
    assert output.failure is None
    assert output.feedback is not None
    assert 30.0 / FRAME_S < len(output.feedback.states) <= MAX_FRAMES
    assert (output.feedback.colours == Colour.GREEN).mean() > 0.9


def test_what_is_remembered_of_the_motion_holds_the_longest_attempt_and_can_be_told() -> None:
    assert LONGEST_S * DEFAULT.tempo[1] + BEFORE_S + DEFAULT.patience_s < KEPT_S <= MAX_FRAMES * FRAME_S


@pytest.mark.parametrize("part", ["appraise", "keyframes_of"])
def test_an_attempt_with_which_something_is_wrong_is_counted_and_the_next_one_is_told(
    part: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    wrong = ZeroDivisionError("a mistake of ours")
    where = pipeline if part == "appraise" else attempts
    right = getattr(where, part)
    calls: list[object] = []

    def once_wrong(*told_of: object) -> object:
        calls.append(told_of)
        if len(calls) == 1:
            raise wrong
        return right(*told_of)

    monkeypatch.setattr(where, part, once_wrong)
    script = Script()
    script.perform("squat", "right")
    script.perform("soccer_kick", "right")
    state, outputs = outputs_of(script.events)
    assert [output.failure for output in outputs if output != NOTHING] == [wrong, None]
    assert [output.feedback.action for output in outputs if output.feedback is not None] == ["soccer_kick"]
    assert state.failures == 1


def outputs_of(events: list[Event], config: EvaluationConfig = CONFIG) -> tuple[EvaluationState, list[EvaluationOutput]]:
    state, outputs = initial_state(config), []
    for event in events:
        state, output = step(state, event, config)
        outputs.append(output)
    return state, outputs
