"""What the evaluation remembers of attempts, for a page's server that was started again."""

import msgspec

from models.messages.attempts import REMEMBERED, AttemptsBegin
from models.messages.pupil import PupilCorrection
from services.evaluation.memory import Memory
from tests.mutations.samples import feedback

T0 = 10**12
SECOND_NS = 10**9
LAST = 2**63 - 1
ATTEMPTS = [feedback(T0 + number * SECOND_NS) for number in range(60)]


def memory_of(count: int) -> Memory:
    memory = Memory()
    for attempt in ATTEMPTS[:count]:
        memory.note(attempt)
    return memory


def remembered(memory: Memory) -> list[int]:
    """All of it as a server asks for it: one after the other, the newest first."""
    found: list[int] = []
    answer = memory.before(LAST)
    while answer.feedback is not None:
        found.append(answer.feedback.id)
        assert (answer.older == 0) == (memory.before(answer.feedback.id).feedback is None)
        answer = memory.before(answer.feedback.id)
    return found


def test_nothing_is_remembered_at_first() -> None:
    memory = Memory()
    assert (memory.since_ns, memory.count, memory.newest) == (0, 0, 0)
    assert remembered(memory) == []


def test_the_newest_attempts_are_told_again_the_newest_first_and_all_are_counted() -> None:
    memory = memory_of(60)
    assert remembered(memory) == [attempt.id for attempt in reversed(ATTEMPTS[60 - REMEMBERED :])]
    assert (memory.count, memory.newest) == (60, ATTEMPTS[59].id)


def test_a_list_that_begins_anew_is_without_what_was_published_before() -> None:
    memory = memory_of(5)
    assert memory.begin(AttemptsBegin(ATTEMPTS[3].t_published_ns))
    assert remembered(memory) == [ATTEMPTS[4].id, ATTEMPTS[3].id]
    assert (memory.since_ns, memory.count) == (ATTEMPTS[3].t_published_ns, 2)
    memory.note(ATTEMPTS[5])
    assert (memory.count, memory.newest) == (3, ATTEMPTS[5].id)


def test_of_two_beginnings_the_later_one_counts() -> None:
    memory = memory_of(3)
    assert memory.begin(AttemptsBegin(T0 + 10 * SECOND_NS))
    assert not memory.begin(AttemptsBegin(T0 + 10 * SECOND_NS, 7, 1))
    assert not memory.begin(AttemptsBegin(T0, 7, 1))
    assert (memory.since_ns, memory.count, memory.newest) == (T0 + 10 * SECOND_NS, 0, 0)


def test_an_evaluation_that_was_started_again_goes_on_with_the_count() -> None:
    memory = Memory()
    memory.note(ATTEMPTS[12])
    memory.note(ATTEMPTS[13])
    # The server has heard of the first of these two already.
    assert memory.begin(AttemptsBegin(T0, 13, ATTEMPTS[12].id))
    assert memory.count == 14
    assert remembered(memory) == [ATTEMPTS[13].id, ATTEMPTS[12].id]


def test_whose_an_attempt_was_after_all_is_remembered() -> None:
    memory = memory_of(3)
    memory.correct([PupilCorrection(ATTEMPTS[1].id, "B12"), PupilCorrection(5, "7")])
    told = [memory.before(attempt.id + 1).feedback for attempt in ATTEMPTS[:3]]
    assert [each.pupil for each in told if each is not None] == ["", "B12", ""]
    assert msgspec.structs.asdict(ATTEMPTS[1])["pupil"] == "", "what was published stays as it was"
