"""The list of attempts of a server that was started again, and of one whose evaluation or recorder was."""

from collections.abc import Iterator

import pytest

from models.messages.attempts import REMEMBERED, AttemptsBegin, FeedbackRequest, RememberedFeedback
from models.messages.feedback import Feedback
from models.messages.health import EvaluationHealth, RecorderHealth
from services.evaluation.memory import Memory
from services.tablet.attempts import SINCE_THE_BOX
from services.tablet.lesson_so_far import PATIENCE_NS, LessonSoFar
from tests.mutations.samples import feedback

T0 = 10**12
SECOND_NS = 10**9
LATE_NS = T0 + 10**6 * SECOND_NS
ATTEMPTS = [feedback(T0 + number * SECOND_NS) for number in range(70)]
IDS = [attempt.id for attempt in ATTEMPTS]


def said(memory: Memory) -> EvaluationHealth:
    """What the evaluation says once a second."""
    listed = (memory.since_ns, memory.count, memory.newest)
    return EvaluationHealth("", "site", "waiting", 0, 0.1, 0.0, 0, 0, "", 0, *listed)


def recorded(attempts: list[Feedback], began_ns: int = T0, total: int | None = None) -> RecorderHealth:
    newest = tuple(attempt.id for attempt in attempts[-REMEMBERED:])
    return RecorderHealth("2026", "7b", 60.0, 10**6, 0, began_ns, len(attempts) if total is None else total, newest)


NOBODY_RECORDS = RecorderHealth("", "", 0.0, 0, 0)


class Box:
    """A server's list, and an evaluation that answers it until it is killed."""

    def __init__(self, memory: Memory | None = None) -> None:
        self.memory = memory or Memory()
        self.told: list[AttemptsBegin | FeedbackRequest] = []
        self.list = LessonSoFar(self.told.append, T0)
        self.lost: Iterator[bool] = iter(())

    def start_server(self) -> None:
        """The server was killed, and another one takes its place."""
        self.told = []
        self.list = LessonSoFar(self.told.append, T0)

    def end(self, attempt: Feedback, *, heard: bool = True) -> None:
        """An attempt ended."""
        self.memory.note(attempt)
        if heard:
            self.list.take(attempt)

    def speak(self) -> None:
        """The evaluation says how it is, and answers until nothing more is asked; some answers are lost."""
        self.list.hear_evaluation(said(self.memory), LATE_NS)
        while self.told:
            told = self.told.pop(0)
            if isinstance(told, AttemptsBegin):
                if self.memory.begin(told):
                    self.list.hear_evaluation(said(self.memory), LATE_NS)
            elif not next(self.lost, False):
                self.list.hear_remembered(self.memory.before(told.before), LATE_NS)

    @property
    def shown(self) -> list[tuple[int, int | None]]:
        listed = self.list.shown(LATE_NS + PATIENCE_NS, restarted=True)
        assert listed is not None
        return [(attempt.id, attempt.number) for attempt in listed.attempts]

    @property
    def earlier(self) -> str:
        listed = self.list.shown(LATE_NS + PATIENCE_NS, restarted=True)
        assert listed is not None
        return listed.earlier


def test_a_server_that_was_started_again_has_the_whole_list_with_the_numbers_of_before() -> None:
    box = Box()
    box.speak()
    for attempt in ATTEMPTS:
        box.end(attempt)
    before = box.shown
    assert before == list(zip(IDS[20:], range(21, 71), strict=True))
    box.start_server()
    box.speak()
    assert box.shown == before
    assert box.earlier == "listed"


def test_answers_that_are_lost_are_asked_for_again_with_the_next_word() -> None:
    box = Box()
    box.speak()
    for attempt in ATTEMPTS[:9]:
        box.end(attempt)
    box.start_server()
    box.lost = iter([False, True, False, False, True, True, False])
    for _ in range(3):
        box.speak()
        assert len(box.shown) < 9
    box.speak()
    assert box.shown == list(zip(IDS[:9], range(1, 10), strict=True))


def test_an_attempt_that_ends_while_the_others_are_told_again_has_its_place() -> None:
    box = Box()
    box.speak()
    for attempt in ATTEMPTS[:5]:
        box.end(attempt)
    box.start_server()
    box.end(ATTEMPTS[5])
    box.speak()
    assert box.shown == list(zip(IDS[:6], range(1, 7), strict=True))


def test_an_attempt_that_was_lost_on_its_way_is_asked_for_and_nothing_is_told_twice() -> None:
    box = Box()
    box.speak()
    for number, attempt in enumerate(ATTEMPTS[:8]):
        box.end(attempt, heard=number != 7)
    box.list.hear_evaluation(said(box.memory), LATE_NS)
    assert [request for request in box.told if isinstance(request, FeedbackRequest)] == box.told
    asked = len(box.told)
    while box.told:
        told = box.told.pop(0)
        assert isinstance(told, FeedbackRequest)
        box.list.hear_remembered(box.memory.before(told.before), LATE_NS)
        asked += len(box.told)
    assert asked == 2, "the one that is missing, and the one before, which is known"
    assert box.shown == list(zip(IDS[:8], range(1, 9), strict=True))


def test_nothing_is_shown_until_the_evaluation_has_told_or_is_not_heard_for_some_seconds() -> None:
    box = Box()
    assert box.list.shown(T0 + PATIENCE_NS - 1, restarted=False) is None
    waited = box.list.shown(T0 + PATIENCE_NS, restarted=False)
    assert waited is not None
    assert (waited.attempts, waited.earlier) == ([], "listed")
    box.speak()
    assert box.list.shown(T0, restarted=False) is not None


def test_an_answer_that_nobody_asked_for_changes_nothing() -> None:
    box = Box()
    box.speak()
    box.list.hear_remembered(RememberedFeedback(ATTEMPTS[3], 4), LATE_NS)
    assert box.shown == []
    assert box.told == []


def test_the_teacher_s_beginning_empties_the_list_and_outlives_the_server() -> None:
    box = Box()
    box.speak()
    for attempt in ATTEMPTS[:5]:
        box.end(attempt)
    box.list.begin(ATTEMPTS[5].t_published_ns)
    assert box.shown == []
    box.speak()
    box.end(ATTEMPTS[6])
    box.start_server()
    box.speak()
    assert box.shown == [(IDS[6], 1)]


def test_an_evaluation_that_was_started_again_goes_on_with_the_numbers_also_for_the_next_server() -> None:
    box = Box()
    box.speak()
    for attempt in ATTEMPTS[:5]:
        box.end(attempt)
    box.memory = Memory()
    box.speak()
    box.end(ATTEMPTS[5])
    box.speak()
    assert box.shown == list(zip(IDS[:6], range(1, 7), strict=True))
    box.start_server()
    box.speak()
    assert box.shown == [(IDS[5], 6)]
    assert box.earlier == "lost", "five are missing"


def test_a_list_that_is_full_is_not_said_to_miss_those_that_left_it() -> None:
    box = Box()
    box.list.begin(T0)
    for attempt in ATTEMPTS:
        box.end(attempt)
    assert box.shown[0] == (IDS[20], 21)
    assert box.earlier == "listed"


def test_attempts_of_which_only_the_count_is_known_are_lost_and_the_count_goes_on() -> None:
    box = Box()
    box.speak()
    for attempt in ATTEMPTS[:5]:
        box.end(attempt)
    box.memory = Memory()
    box.speak()
    assert [number for _, number in box.shown] == [1, 2, 3, 4, 5]
    box.start_server()
    box.speak()
    assert (box.shown, box.earlier) == ([], "lost")
    box.end(ATTEMPTS[5])
    assert (box.shown, box.earlier) == ([(IDS[5], 6)], "lost")


def test_where_nobody_remembers_that_is_said_and_no_longer_once_the_list_begins() -> None:
    box = Box()
    box.speak()
    box.end(ATTEMPTS[0])
    box.memory = Memory()
    box.start_server()
    box.speak()
    assert (box.shown, box.earlier) == ([], "lost")
    first = box.list.shown(LATE_NS, restarted=False)
    assert first is not None
    assert first.earlier == "listed", "the first server of a box has lost nothing"
    box.list.begin(LATE_NS)
    assert box.earlier == "listed"


def test_a_recording_that_begins_empties_the_list_and_two_recordings_begin_with_nothing() -> None:
    box = Box()
    box.speak()
    for attempt in ATTEMPTS[:5]:
        box.end(attempt)
    began_ns = ATTEMPTS[5].t_published_ns - 1
    box.list.hear_recorder(recorded([], began_ns), LATE_NS)
    assert (box.shown, box.earlier) == ([], "listed")
    box.end(ATTEMPTS[5])
    box.list.hear_recorder(recorded([ATTEMPTS[5]], began_ns), LATE_NS)
    box.speak()
    assert box.shown == [(IDS[5], 1)]
    box.list.hear_recorder(NOBODY_RECORDS, LATE_NS)
    box.end(ATTEMPTS[6])
    assert box.shown == [(IDS[5], 1), (IDS[6], 2)], "what was recorded is still looked at"
    box.list.hear_recorder(recorded([], ATTEMPTS[7].t_published_ns - 1), LATE_NS)
    assert box.shown == []


def test_an_attempt_that_was_published_before_the_recorder_spoke_is_the_lesson_s_first() -> None:
    box = Box()
    box.speak()
    box.end(ATTEMPTS[0])
    box.end(ATTEMPTS[1])
    box.list.hear_recorder(recorded([], ATTEMPTS[1].t_published_ns), LATE_NS)
    assert box.shown == [(IDS[1], 1)]
    box.speak()
    assert box.memory.count == 1


def test_numbers_are_the_file_s_however_many_the_server_and_the_evaluation_count() -> None:
    box = Box()
    box.list.hear_recorder(recorded([]), LATE_NS)
    box.speak()
    for attempt in ATTEMPTS[:6]:
        box.end(attempt)
    # Fusion was started again, and one attempt was published before its log went on.
    in_file = [*ATTEMPTS[:2], *ATTEMPTS[3:6]]
    box.list.hear_recorder(recorded(in_file), LATE_NS)
    box.speak()
    assert [number for _, number in box.shown] == [1, 2, None, 3, 4, 5]


def test_a_server_that_begins_in_the_middle_of_a_long_lesson_has_its_numbers() -> None:
    box = Box()
    box.list.hear_recorder(recorded([]), LATE_NS)
    box.speak()
    for attempt in ATTEMPTS:
        box.end(attempt)
    box.start_server()
    box.list.hear_recorder(recorded(ATTEMPTS), LATE_NS)
    box.speak()
    assert box.shown == list(zip(IDS[20:], range(21, 71), strict=True))


def test_attempts_that_nobody_but_the_lesson_holds_are_said_to_be_in_the_report() -> None:
    box = Box()
    box.list.hear_recorder(recorded(ATTEMPTS[:4]), LATE_NS)
    box.speak()
    assert (box.shown, box.earlier) == ([], "recorded")
    box.end(ATTEMPTS[4])
    box.list.hear_recorder(recorded(ATTEMPTS[:5]), LATE_NS)
    assert (box.shown, box.earlier) == ([(IDS[4], 5)], "recorded")


@pytest.mark.parametrize("wrong", ["evaluation", "recorder"])
def test_a_beginning_of_the_future_is_not_believed(wrong: str) -> None:
    box = Box()
    box.speak()
    box.end(ATTEMPTS[0])
    if wrong == "recorder":
        box.list.hear_recorder(recorded([ATTEMPTS[0]], LATE_NS + 1), LATE_NS)
    else:
        future = Memory()
        future.begin(AttemptsBegin(LATE_NS + 1))
        box.list.hear_evaluation(said(future), LATE_NS)
    assert box.shown == [(IDS[0], 1)]
    assert box.list.attempts.since_ns == SINCE_THE_BOX
