"""The bench of what the running box says can fail: late, missing, false and wrong words are in its figures."""

from collections.abc import Sequence
from typing import Final

import pytest
from msgspec import structs

from models.messages.feedback import Feedback
from models.motions.motion import Attempt
from tests.bench.report import Report
from tests.bench.teaching.live import BARS, Heard, figures, performed
from tests.reported import attempt

ZERO_S: Final = 100.0
FILM: Final = (Attempt("squat", "right", 2.0, 2.5, 3.0, 4.0), Attempt("basketball_shot", "right", 6.0, 6.5, 7.0, 8.0))
FROM_S, TO_S = ZERO_S, ZERO_S + 20.0


def said(true: Attempt, after_s: float = 0.7, cue: str = "") -> Feedback:
    """Of an attempt as it was, so long after its end."""
    moments = (true.start_s, true.exertion_s, true.peak_s, true.end_s)
    start, exertion, peak, end = (round((ZERO_S + moment) * 1e9) for moment in moments)
    made = attempt(true.action, cue=cue, cue_certainty=0.9, praise="") if cue else attempt(true.action)
    return structs.replace(
        made,
        keyframes_ns=(start, exertion, peak, end),
        t_first_ns=start,
        frame_ns=(end - start) // (len(made.states) - 1) + 1,
        t_published_ns=end + round(after_s * 1e9),
    )


def missed(words: Sequence[Feedback], said_in_all: int | None = None) -> list[str]:
    heard = Heard(said=list(words))
    heard.zeros_s[0] = [ZERO_S - 0.001, ZERO_S, ZERO_S + 0.001]
    report = Report("bench-feedback")
    done = performed(heard, FILM, FROM_S, TO_S)
    assert len(done) == len(FILM)
    report.add(figures(done, len(words) if said_in_all is None else said_in_all))
    report.show(BARS)
    return report.missed


def test_what_is_said_in_time_and_right_misses_nothing() -> None:
    assert missed([said(one) for one in FILM]) == []


def test_one_attempt_that_is_told_late_is_missed() -> None:
    assert missed([said(FILM[0]), said(FILM[1], after_s=1.4)]) == ["feedback_delay_s.p95"]


def test_an_attempt_of_which_nothing_is_said_is_missed() -> None:
    assert missed([said(FILM[0])]) == ["attempt_f1"]


def test_what_is_said_of_nothing_is_missed() -> None:
    assert missed([said(one) for one in FILM], said_in_all=3) == ["attempt_f1"]


def test_what_is_taken_for_another_action_is_missed() -> None:
    assert missed([said(FILM[0]), structs.replace(said(FILM[1]), action="badminton_clear")]) == ["attempt_f1"]


def test_a_correction_of_what_was_right_is_missed() -> None:
    fault = attempt("squat").judgements[0].fault
    assert missed([said(FILM[0], cue=fault), said(FILM[1])]) == ["false_cue_pct"]


@pytest.mark.parametrize(("from_s", "to_s"), [(FROM_S + 2.5, TO_S), (FROM_S, ZERO_S + 10.0)])
def test_an_attempt_that_was_not_listened_to_from_its_begin_until_it_must_be_told_does_not_count(
    from_s: float, to_s: float
) -> None:
    heard = Heard()
    heard.zeros_s[0] = [ZERO_S]
    assert len(performed(heard, FILM, from_s, to_s)) == 1
