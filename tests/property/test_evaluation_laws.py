"""Laws of the evaluation's step: whatever fusion and tablets send, it goes on, and never says more than was seen."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Final

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.arrays import Float
from models.messages import codec
from models.messages.feedback import ActivityRequest, Colour, Feedback
from models.messages.motion import JointState, Motion
from models.messages.pupil import PupilTurn
from models.motions.motion import Handed
from models.skeleton import coco
from services.evaluation.pipeline import initial_state, step
from tests.taught import performance, placed, some

pytestmark = pytest.mark.slow

ACTIONS: Final = ("basketball_shot", "squat", "soccer_kick")
CONFIG: Final = some(*ACTIONS)
FRAME_NS: Final = 33_333_333
MS: Final = 1_000_000
_STILL: Final = 15

Event = Motion | ActivityRequest | PupilTurn


@dataclass
class Script:
    """Events one after the other, as fusion would number and date them."""

    events: list[Event] = field(default_factory=list)
    sequence: int = 0
    epoch: int = 0
    t_ns: int = 10**12
    stands: Float = field(default_factory=lambda: performance(ACTIONS[0])[0].joints_m[0])

    def show(self, joints_m: Float, state: JointState = JointState.SEEN, variance_m2: float = 1e-4) -> None:
        known = np.asarray(np.isfinite(joints_m).all(axis=1) & (state != JointState.UNKNOWN))
        self.events.append(
            Motion(
                kind="smooth",
                sequence=self.sequence,
                epoch=self.epoch,
                t_ns=self.t_ns,
                t_newest_ns=self.t_ns,
                t_published_ns=self.t_ns,
                joints_m=np.where(known[:, None], joints_m, 0.0).astype(np.float32),
                covariance_m2=np.tile(np.eye(3, dtype=np.float32) * np.float32(variance_m2), (coco.COUNT, 1, 1)),
                states=np.where(known, state, JointState.UNKNOWN).astype(np.uint8),
                views=np.zeros(coco.COUNT, np.uint32),
                cameras=(),
            )
        )
        self.skip()

    def skip(self) -> None:
        self.sequence += 1
        self.t_ns += FRAME_NS

    def stand(self, frames: int) -> None:
        for _ in range(frames):
            self.show(self.stands)

    def part(self, action: str, handed: Handed, first: int, frames: int) -> None:
        for joints_m in performance(action, handed)[0].joints_m[first : first + frames]:
            self.show(joints_m)

    def missing(self, frames: int) -> None:
        for _ in range(frames):
            self.skip()

    def nobody(self, frames: int) -> None:
        for _ in range(frames):
            self.show(self.stands, JointState.UNKNOWN)

    def noise(self, frames: int, seed: int, sigma_m: float) -> None:
        random = np.random.default_rng(seed)
        for _ in range(frames):
            shaken = self.stands + np.clip(sigma_m * random.normal(size=(coco.COUNT, 3)), -3e38, 3e38)
            self.show(np.where(random.uniform(size=(coco.COUNT, 1)) < 0.2, np.nan, shaken))

    def vague(self, frames: int, variance_m2: float) -> None:
        for _ in range(frames):
            self.show(self.stands, variance_m2=variance_m2)

    def count_epochs(self, further: int) -> None:
        self.epoch = max(self.epoch + further, 0)

    def count_anew(self) -> None:
        self.sequence = 0

    def late(self, by_ns: int) -> None:
        self.t_ns = min(max(self.t_ns + by_ns, 0), 2**63 - 10**12)

    def choose(self, activity: str) -> None:
        self.events.append(ActivityRequest(activity))

    def call(self, pupil: str, after_ns: int) -> None:
        self.events.append(PupilTurn(pupil, max(self.t_ns + after_ns, 0)))

    def perform(self, action: str, handed: Handed, number: int = 0, state: JointState = JointState.SEEN) -> None:
        track, _ = performance(action, handed, number)
        self.stands = track.joints_m[0]
        self.stand(_STILL)
        for joints_m in track.joints_m:
            self.show(joints_m, state)
        self.stands = track.joints_m[-1]
        self.stand(_STILL)


def told(events: list[Event]) -> list[Feedback]:
    """What is said of all that, as it arrives elsewhere."""
    return [codec.decode(payload, Feedback) for payload in payloads(events)]


def payloads(events: list[Event]) -> list[bytes]:
    state = initial_state(CONFIG)
    said = []
    for event in events:
        state, output = step(state, event, CONFIG)
        assert output.failure is None
        if output.feedback is not None:
            said.append(codec.encode(output.feedback))
    return said


def _chunks() -> st.SearchStrategy[tuple[object, ...]]:
    frames = st.integers(1, 40)
    hands = st.sampled_from(("right", "left"))
    states = st.sampled_from((JointState.SEEN, JointState.SEEN, JointState.GUESSED, JointState.UNKNOWN))
    return st.one_of(
        st.tuples(st.just("perform"), st.sampled_from(ACTIONS), hands, st.integers(0, 2), states),
        st.tuples(st.just("part"), st.sampled_from(ACTIONS), hands, st.integers(0, 60), frames),
        st.tuples(st.just("stand"), frames),
        st.tuples(st.just("missing"), frames),
        st.tuples(st.just("nobody"), frames),
        st.tuples(st.just("noise"), frames, st.integers(0, 2**32 - 1), st.sampled_from((0.0, 0.05, 1.0, 90.0, 1e6, 3e38))),
        st.tuples(st.just("vague"), frames, st.sampled_from((0.0, 1.0, 1e4, 3e38, -1.0))),
        st.tuples(st.just("count_epochs"), st.integers(-1, 2)),
        st.tuples(st.just("count_anew")),
        st.tuples(st.just("late"), st.sampled_from((-(10**12), -(10**9), -1, 1, 10**7, 10**9, 2**62))),
        st.tuples(st.just("choose"), st.sampled_from(("", *ACTIONS, "pole_vault"))),
        st.tuples(st.just("call"), st.sampled_from(("", "7", "B12")), st.sampled_from((-(10**10), -(10**8), 0, 1, 10**9, 2**62))),
    )


def script_of(chunks: list[tuple[object, ...]]) -> list[Event]:
    """A chunk is the name of one of `Script`'s methods, and what it is called with."""
    script = Script()
    for name, *values in chunks:
        getattr(script, str(name))(*values)
    return script.events


@settings(max_examples=25, deadline=None)
@given(st.lists(_chunks(), max_size=10))
def test_whatever_comes_the_evaluation_goes_on_and_what_it_says_can_be_sent(chunks: list[tuple[object, ...]]) -> None:
    events = script_of(chunks)
    for feedback in told(events):
        epochs = {event.epoch for event in events if isinstance(event, Motion)}
        assert feedback.epoch in epochs
        assert feedback.pupil in {"", *(event.pupil for event in events if isinstance(event, PupilTurn))}


_BREAKS: Final = ("late", "count_epochs", "count_anew")
"""After these the clock, or the count, begins anew."""
_TRIED: Final[list[tuple[object, ...]]] = [("nobody", 40), ("choose", ""), ("perform", "squat", "right", 0, JointState.SEEN)]
"""Whoever was there before has gone, and somebody squats for all to see."""


@settings(max_examples=20, deadline=None)
@given(st.lists(_chunks(), max_size=8))
def test_no_movement_is_told_twice_and_one_that_is_seen_is_told(chunks: list[tuple[object, ...]]) -> None:
    said = told(script_of([*(chunk for chunk in chunks if chunk[0] not in _BREAKS), *_TRIED]))
    assert len({feedback.id for feedback in said}) == len(said)
    spans = sorted((feedback.keyframes_ns[0], feedback.keyframes_ns[-1]) for feedback in said)
    assert all(end_ns <= start_ns for (_, end_ns), (start_ns, _) in pairwise(spans))
    assert (said[-1].action, said[-1].handed) == ("squat", "right")


@settings(max_examples=5, deadline=None)
@given(st.lists(_chunks(), min_size=1, max_size=8))
def test_the_same_events_give_the_same_feedback_to_the_last_bit(chunks: list[tuple[object, ...]]) -> None:
    events = script_of([*chunks, *_TRIED])
    assert payloads(events) == payloads(events) != []


def attempts(action: str, handed: Handed = "right", number: int = 0) -> list[Event]:
    script = Script()
    script.perform(action, handed, number)
    return script.events


@pytest.mark.parametrize("action", ACTIONS)
def test_live_motions_are_not_looked_at(action: str) -> None:
    live = [msgspec.structs.replace(event, kind="live") for event in attempts(action) if isinstance(event, Motion)]
    assert told([*live]) == []


@settings(max_examples=6, deadline=None)
@given(st.floats(-3.1, 3.1), st.floats(-2, 2), st.sampled_from(ACTIONS))
def test_where_in_the_room_and_facing_where_an_attempt_is_made_changes_nothing(heading: float, aside_m: float, action: str) -> None:
    events = attempts(action)
    (here,) = told(events)
    (there,) = told(list(_elsewhere(events, heading, aside_m)))
    assert there.keyframes_ns == pytest.approx(here.keyframes_ns, abs=2 * 10**6)
    assert there.score == pytest.approx(here.score, abs=0.5)
    assert (there.cue, there.action, there.handed) == (here.cue, here.action, here.handed)
    assert (there.colours == here.colours).mean() > 0.99


def _elsewhere(events: list[Event], heading: float, aside_m: float) -> Iterator[Event]:
    for event in events:
        assert isinstance(event, Motion)
        joints_m = placed(event.joints_m.astype(np.float64)[None], "right", heading, (aside_m, -aside_m))[0]
        yield msgspec.structs.replace(event, joints_m=joints_m.astype(np.float32))


@pytest.mark.parametrize("action", ACTIONS)
def test_an_attempt_over_an_epochs_end_is_none(action: str) -> None:
    events = attempts(action)
    half = len(events) // 2
    torn = [msgspec.structs.replace(event, epoch=int(number > half)) for number, event in enumerate(events)]
    assert told(torn) == []


def test_half_an_attempt_that_was_not_seen_has_no_green_in_it() -> None:
    events = attempts("squat")
    middle = slice(len(events) // 2 - 4, len(events) // 2 + 4)
    for number in range(middle.start, middle.stop):
        event = events[number]
        assert isinstance(event, Motion)
        events[number] = msgspec.structs.replace(event, states=np.full(coco.COUNT, JointState.UNKNOWN, np.uint8))
    (feedback,) = told(events)
    unseen = (feedback.states == JointState.UNKNOWN).all(axis=1)
    assert unseen.sum() == 8
    assert (feedback.colours[unseen] == Colour.GREY).all()
    assert (feedback.colours[~unseen] == Colour.GREEN).any()


def test_a_few_motions_that_were_lost_leave_a_grey_gap_and_the_attempt_is_found() -> None:
    events = attempts("squat")
    del events[len(events) // 2 : len(events) // 2 + 4]
    (feedback,) = told(events)
    assert (feedback.states == JointState.UNKNOWN).all(axis=1).sum() == 4


def test_only_what_was_chosen_is_found_and_it_is_said_so() -> None:
    events = attempts("squat")
    assert [feedback.by for feedback in told(events)] == ["recognised"]
    assert [feedback.by for feedback in told([ActivityRequest("squat"), *events])] == ["chosen"]
    assert told([ActivityRequest("soccer_kick"), *events]) == []
    assert len(told([ActivityRequest("soccer_kick"), ActivityRequest(""), *events])) == 1


def test_an_action_that_there_is_not_is_refused_and_changes_nothing() -> None:
    state = initial_state(CONFIG)
    state, output = step(state, ActivityRequest("pole_vault"), CONFIG)
    assert output.refused
    assert (state.activity, state.chosen_by) == ("", "site")
    state, output = step(state, ActivityRequest("squat"), CONFIG)
    assert not output.refused
    assert (state.activity, state.chosen_by) == ("squat", "tablet")


def test_what_the_pupil_does_is_known_only_while_he_is_seen() -> None:
    state = initial_state(CONFIG)
    assert state.doing == "unknown"
    seen = set()
    for event in attempts("squat"):
        state, _ = step(state, event, CONFIG)
        seen.add(state.doing)
    assert seen == {"waiting", "moving"}
    script = Script(sequence=1000, t_ns=2 * 10**12)
    script.show(script.stands, JointState.UNKNOWN)
    state, _ = step(state, script.events[0], CONFIG)
    assert state.doing == "unknown"


def start_and_end_ns(events: list[Event]) -> tuple[int, int]:
    (feedback,) = told(events)
    return feedback.keyframes_ns[0], feedback.keyframes_ns[-1]


def taken_in_after(events: list[Event], turn: PupilTurn) -> list[Event]:
    """The same events, and a turn as soon as the motion is there that shows its time."""
    later = [number for number, event in enumerate(events) if isinstance(event, Motion) and event.t_ns > turn.t_ns]
    place = later[0] if later else len(events)
    return [*events[:place], turn, *events[place:]]


def test_an_attempt_is_of_the_pupil_who_was_up_when_it_began() -> None:
    events = attempts("squat")
    start_ns, end_ns = start_and_end_ns(events)
    before, after = PupilTurn("7", start_ns - 10**8), PupilTurn("8", start_ns + MS)
    assert [one.pupil for one in told(events)] == [""]
    assert [one.pupil for one in told(taken_in_after(events, before))] == ["7"]
    assert [one.pupil for one in told(taken_in_after(taken_in_after(events, before), after))] == ["7"]
    assert [one.pupil for one in told(taken_in_after(taken_in_after(events, before), PupilTurn("8", end_ns)))] == ["7"]
    assert [one.pupil for one in told(taken_in_after(events, after))] == [""], "never of one who was called later"
    gone = taken_in_after(taken_in_after(events, before), PupilTurn("", start_ns - MS))
    assert [one.pupil for one in told(gone)] == [""]


def test_a_turn_that_is_heard_of_late_counts_from_when_it_was() -> None:
    events = attempts("squat")
    start_ns, _ = start_and_end_ns(events)
    half = len(events) // 2
    assert [one.pupil for one in told([*events[:half], PupilTurn("7", start_ns - MS), *events[half:]])] == ["7"]


def test_of_two_turns_the_later_one_counts_in_whatever_order_they_come_and_however_often() -> None:
    events = attempts("squat")
    start_ns, _ = start_and_end_ns(events)
    older, newer = PupilTurn("7", start_ns - 3 * MS), PupilTurn("8", start_ns - 2 * MS)
    for turns in ([older, newer], [newer, older], [older, newer, older, newer, older]):
        state = initial_state(CONFIG)
        for turn in turns:
            state, _ = step(state, turn, CONFIG)
        assert state.turn == newer
        assert [one.pupil for one in told([*turns, *events])] == ["8"]


def test_whose_it_was_before_the_turns_that_are_remembered_is_not_known() -> None:
    events = attempts("squat")
    start_ns, _ = start_and_end_ns(events)
    many: list[Event] = [PupilTurn("8", start_ns + MS + number) for number in range(100)]
    assert [one.pupil for one in told([PupilTurn("7", start_ns - MS), *many, *events])] == [""]


def test_an_attempt_of_a_lesson_that_is_played_faster_is_of_whoever_was_up_when_it_was_shown_to_begin() -> None:
    config = replace(CONFIG, speed=4.0, slack_frames=15.0)
    first_ns = next(event.t_ns for event in attempts("squat") if isinstance(event, Motion))
    faster: list[Event] = [
        msgspec.structs.replace(event, t_ns=first_ns + (event.t_ns - first_ns) // 4)
        for event in attempts("squat")
        if isinstance(event, Motion)
    ]
    start_ns, _ = start_and_end_ns(attempts("squat"))
    shown_ns = first_ns + (start_ns - first_ns) // 4
    for pupil, called_ns in (("7", shown_ns - 3 * 10**7), ("", shown_ns + 3 * 10**7)):
        state, found = initial_state(config), []
        for event in taken_in_after(faster, PupilTurn("7", called_ns)):
            state, output = step(state, event, config)
            found += [output.feedback.pupil] if output.feedback is not None else []
        assert found == [pupil]
