"""Whose attempts a recorded lesson holds, also when it was corrected, and when processes were started again."""

from collections.abc import Iterator

import msgspec
import pytest

from models.errors import UserError
from models.messages import codec
from models.messages.feedback import Feedback
from models.messages.health import EvaluationHealth, Health
from models.messages.lesson import Entry
from models.messages.pupil import PupilCorrection, PupilCorrections, PupilTurn, pupil_at
from services.lesson.lesson_reader import LessonPart
from services.lesson.pupils import BEFORE_NS, attempts_told, turns_of
from tests.mutations.samples import feedback

SECOND_NS = 10**9
T0 = 10**12


def parts(*entries: Entry) -> Iterator[LessonPart]:
    """One entry a part."""
    for sequence, entry in enumerate(entries):
        yield LessonPart(T0, sequence, sequence == 0, "", (entry,))


def attempt(ended_ns: int, pupil: str = "") -> Entry:
    made = msgspec.structs.replace(feedback(ended_ns), pupil=pupil)
    return Entry("feedback", ended_ns, codec.encode(made))


def corrected(t_ns: int, **codes: str) -> Entry:
    """Codes by the ends of attempts, such as t4 for the one that ended 4 s after the beginning."""
    ids = {feedback(T0 + int(name[1:]) * SECOND_NS).id: code for name, code in codes.items()}
    made = PupilCorrections(tuple(PupilCorrection(attempt, code) for attempt, code in ids.items()))
    return Entry("corrections", t_ns, codec.encode(made))


def said(t_ns: int, pupil: str, since_ns: int, process: str = "evaluation") -> Entry:
    evaluation = EvaluationHealth("", "site", "waiting", 0, 0.1, 0.0, 0, 0, pupil, since_ns)
    return Entry("health", t_ns, codec.encode(Health(process, 1, t_ns, "ok", (), 0.1, 1.0, evaluation=evaluation)))


def whose(*entries: Entry) -> list[str]:
    return [one.pupil for one in attempts_told(parts(*entries))]


def at(second: float) -> int:
    return T0 + round(second * SECOND_NS)


def test_an_attempt_is_whose_it_was_on_the_day_unless_it_was_corrected() -> None:
    log = [attempt(at(4), "7"), attempt(at(8), "7"), attempt(at(12))]
    assert whose(*log) == ["7", "7", ""]
    assert whose(*log, corrected(at(13), t8="8", t12="9")) == ["7", "8", "9"]
    assert whose(*log, corrected(at(13), t4="")) == ["", "7", ""]


def test_the_last_correction_counts_and_those_of_before_stay() -> None:
    log = [attempt(at(4), "7"), corrected(at(5), t4="8"), attempt(at(8), "7"), corrected(at(9), t8="9")]
    assert whose(*log) == ["8", "9"], "the tablet server was started again between them and knew of the second only"
    assert whose(*log, corrected(at(10), t4="7", t8="9")) == ["7", "9"]


def test_codes_that_are_none_today_are_read_as_they_were() -> None:
    log = [said(at(1), "7-2", at(1)), attempt(at(4), "EMMA2"), attempt(at(8), "7-2"), corrected(at(9), t8="07")]
    assert whose(*log) == ["EMMA2", "07"]
    assert {turn.pupil for turn in turns_of(parts(*log))} == {"7-2", "EMMA2", "07"}


def test_a_correction_of_an_attempt_that_is_not_in_the_lesson_changes_nothing() -> None:
    assert whose(corrected(at(1), t2="9"), attempt(at(4), "7")) == ["7"]


def test_nothing_else_of_an_attempt_is_changed() -> None:
    log = [attempt(at(4), "7"), corrected(at(5), t4="8")]
    (told,) = attempts_told(parts(*log))
    same = codec.encode(msgspec.structs.replace(told, pupil="7"))
    assert same == log[0].payload
    assert codec.decode(log[0].payload, Feedback).pupil == "7"


def test_turns_are_as_the_evaluation_said_and_from_when_they_were() -> None:
    log = [said(at(1), "", 0), said(at(2), "7", at(1.9)), said(at(3), "7", at(1.9)), said(at(9), "8", at(8.5))]
    assert turns_of(parts(*log)) == (PupilTurn("", 0), PupilTurn("7", at(1.9)), PupilTurn("8", at(8.5)))


def test_the_turn_that_the_lesson_began_with_is_from_before_it() -> None:
    assert turns_of(parts(said(at(1), "7", at(-50)))) == (PupilTurn("7", at(-50)),)


def test_after_an_evaluation_that_was_started_again_nobody_is_up_until_it_is_told_again() -> None:
    log = [said(at(1), "7", at(0.5)), said(at(6), "", 0)]
    turns = turns_of(parts(*log, said(at(7), "7", at(0.5))))
    assert [pupil_at(turns, at(second)) for second in (0, 1, 5, 6, 6.5, 7, 100)] == ["", "7", "7", "", "", "7", "7"]
    forgotten = turns_of(parts(*log))
    assert pupil_at(forgotten, at(100)) == "", "never of one who may have gone"


def test_no_other_process_says_who_is_up() -> None:
    assert turns_of(parts(said(at(1), "7", at(1), process="fusion"))) == ()


def test_during_an_attempt_that_was_corrected_the_other_one_is_up_and_then_again_who_was() -> None:
    log = [said(at(1), "7", at(1)), attempt(at(4), "7"), attempt(at(8), "7"), corrected(at(9), t8="8")]
    turns = turns_of(parts(*log))
    (first, second) = (codec.decode(entry.payload, Feedback).keyframes_ns for entry in log[1:3])
    assert pupil_at(turns, first[0]) == "7"
    assert [pupil_at(turns, t_ns) for t_ns in (second[0] - BEFORE_NS - 1, second[0] - BEFORE_NS)] == ["7", "8"]
    assert [pupil_at(turns, t_ns) for t_ns in (second[0], second[-1], second[-1] + 1)] == ["8", "8", "7"]
    assert list(turns) == sorted(turns, key=lambda turn: turn.t_ns)


def test_a_turn_within_an_attempt_that_was_corrected_counts_after_it() -> None:
    made = attempt(at(8), "7")
    start_ns, _, peak_ns, end_ns = codec.decode(made.payload, Feedback).keyframes_ns
    log = [said(at(1), "7", at(1)), said(peak_ns + 1, "8", peak_ns), made, corrected(at(9), t8="6")]
    turns = turns_of(parts(*log))
    assert [pupil_at(turns, t_ns) for t_ns in (start_ns, end_ns, end_ns + 1)] == ["6", "6", "8"]


def test_what_cannot_be_read_is_one_line() -> None:
    for kind in ("feedback", "corrections", "health"):
        with pytest.raises(UserError, match="holds what this KineBox cannot read"):
            turns_of(parts(Entry(kind, at(1), b"what is this")))
