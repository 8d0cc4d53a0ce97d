"""From feedbacks to a report: numbers, names and texts, for whichever form."""

import datetime as dt
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from models.errors import UserError
from models.messages.feedback import Feedback, MeasureResult
from models.teaching.schema import Fault, Language, Shown, Teaching
from services.evaluation.report import document
from services.evaluation.uncertainty import NETWORK

NOBODY: Final = "-"
"""In the place of a pupil's code where nobody was named."""
_DIGITS: Final = 4
_TIME_DIGITS: Final = 3


@dataclass(frozen=True, eq=False)
class Tried:
    """An attempt, and whose it is.

    Attributes:
        feedback: what was made of it.
        pupil: code of the pupil; `NOBODY` if it is not known.
    """

    feedback: Feedback
    pupil: str = NOBODY


@dataclass(frozen=True)
class LessonFacts:
    """What is to be known of a lesson beside its attempts.

    Attributes:
        name: as lessons are listed.
        title: what people call it; may be empty.
        begun: when, with its time zone.
        begun_ns: the same as CLOCK_MONOTONIC.
        seconds: its length.
        kinebox: version that recorded it.
        source: see `document.Report`.
    """

    name: str
    title: str
    begun: dt.datetime
    begun_ns: int
    seconds: float
    kinebox: str
    source: document.Source

    def wall(self, t_ns: int) -> dt.datetime:
        """Day and time of an instant of the lesson."""
        return self.begun + dt.timedelta(microseconds=(t_ns - self.begun_ns) // 1000)

    def since_s(self, t_ns: int) -> float:
        """Seconds from the lesson's beginning to an instant."""
        return round((t_ns - self.begun_ns) * 1e-9, _TIME_DIGITS)


@dataclass(frozen=True, eq=False)
class Sheet:
    """A report, with what its drawings need.

    Attributes:
        report: all in numbers and words.
        tried: the attempts of `report.attempts`, in the same order.
        teachings: what is taught, by action.
    """

    report: document.Report
    tried: tuple[Tried, ...]
    teachings: Mapping[str, Teaching]


def sheet_of(
    facts: LessonFacts, tried: Iterable[Tried], teachings: Mapping[str, Teaching], language: Language, pupil: str | None = None
) -> Sheet:
    """Make a report.

    Args:
        facts: of the lesson.
        tried: all its attempts, in their order in the lesson.
        teachings: for titles and texts, by action; attempts at others have none.
        language: of these.
        pupil: only this one's attempts; None for all.

    Raises:
        UserError: the lesson has no attempt, or none of this pupil.
    """
    ordered = list(tried)
    if not ordered:
        raise UserError(
            f"lesson {facts.name} has no attempt to report; what is tried must be one of the activities, and seen from start to end"
        )
    numbered = [(number, one) for number, one in enumerate(ordered, start=1) if pupil in {None, one.pupil}]
    if not numbered:
        codes = ", ".join(f"'{code}'" for code in sorted({one.pupil for one in ordered}, key=_as_counted))
        raise UserError(f"lesson {facts.name} has no attempt of pupil '{pupil}'; its pupils are {codes}")
    attempts = tuple(_attempt(facts, number, one, teachings.get(one.feedback.action), language) for number, one in numbered)
    report = document.Report(
        language=language,
        source=facts.source,
        lesson=document.Lesson(
            name=facts.name,
            title=facts.title,
            begun=facts.begun.isoformat(timespec="seconds"),
            seconds=round(facts.seconds, _TIME_DIGITS),
            kinebox=facts.kinebox,
        ),
        pupils=_pupils(attempts),
        attempts=attempts,
    )
    return Sheet(report, tuple(one for _, one in numbered), teachings)


def _attempt(facts: LessonFacts, number: int, tried: Tried, teaching: Teaching | None, language: Language) -> document.Attempt:
    feedback = tried.feedback
    faults: Mapping[str, Fault] = {} if teaching is None else {fault.name: fault for fault in teaching.fault}
    start, exertion, peak, end = map(facts.since_s, feedback.keyframes_ns)
    return document.Attempt(
        number=number,
        id=feedback.id,
        pupil=None if tried.pupil == NOBODY else tried.pupil,
        action=feedback.action,
        title=None if teaching is None else teaching.title.of(language),
        by=feedback.by,
        handed=feedback.handed,
        begun=facts.wall(feedback.keyframes_ns[0]).isoformat(timespec="milliseconds"),
        keyframes_s=document.Keyframes(
            start=start, exertion=exertion, peak=peak, end=end, sigma=NETWORK.moment_s, unseen=feedback.keyframes_unseen
        ),
        score=_rounded(feedback.score),
        score_sigma=_rounded(feedback.score_sigma),
        praise=_praise(feedback, faults.get(feedback.praise), language),
        cue=_cue(feedback, faults.get(feedback.cue), language),
        silence=feedback.silence,
        measures=_measures(feedback, teaching, language),
        judgements=tuple(
            document.Judgement(fault=one.fault, severity=_rounded(one.severity), sigma=_rounded(one.sigma))
            for one in feedback.judgements
        ),
    )


def _praise(feedback: Feedback, taught: Fault | None, language: Language) -> document.Praise | None:
    if not feedback.praise:
        return None
    return document.Praise(point=feedback.praise, text=None if taught is None else taught.praise.of(language))


def _cue(feedback: Feedback, taught: Fault | None, language: Language) -> document.Cue | None:
    if not feedback.cue:
        return None
    text = None if taught is None else taught.cue.of(language)
    return document.Cue(fault=feedback.cue, text=text, certainty=round(feedback.cue_certainty, _DIGITS))


def _measures(feedback: Feedback, teaching: Teaching | None, language: Language) -> tuple[document.Measure, ...]:
    """Those that are shown first, in their order."""
    taught = {} if teaching is None else {shown.name: shown for shown in teaching.shown}
    ordered = sorted(feedback.measures, key=lambda one: feedback.shown.index(one.name) if one.name in feedback.shown else 10**9)
    return tuple(_measure(one, one.name in feedback.shown, taught.get(one.name), language) for one in ordered)


def _measure(result: MeasureResult, shown: bool, taught: Shown | None, language: Language) -> document.Measure:
    return document.Measure(
        name=result.name,
        title=None if taught is None else taught.title.of(language),
        shown=shown,
        value=_rounded(result.value),
        sigma=_rounded(result.sigma),
        unit=result.unit,
        verdict=result.verdict,
        low=_rounded(result.low),
        high=_rounded(result.high),
    )


def _pupils(attempts: Sequence[document.Attempt]) -> tuple[document.PupilSummary, ...]:
    codes = sorted({attempt.pupil for attempt in attempts}, key=lambda code: (code is None, _as_counted(code or "")))
    found = []
    for code in codes:
        own = [attempt for attempt in attempts if attempt.pupil == code]
        actions = tuple(
            _action([one for one in own if one.action == action]) for action in dict.fromkeys(one.action for one in own)
        )
        found.append(document.PupilSummary(pupil=code, attempts=len(own), actions=actions))
    return tuple(found)


def _as_counted(code: str) -> tuple[list[tuple[str, int]], str]:
    """By which codes are sorted as people do: 7 before 12, B2 before B10; and 07 before 7, always."""
    return [(letters, int(digits or 0)) for letters, digits in re.findall(r"([^0-9]*)([0-9]*)", code)], code


def _action(attempts: Sequence[document.Attempt]) -> document.ActionSummary:
    scores = [(one.score, one.score_sigma) for one in attempts if one.score is not None and one.score_sigma is not None]
    # Attempts of nobody who was named are of several pupils: their mean would be taken for somebody's.
    meant = scores if attempts[0].pupil is not None else []
    cues = [one.cue for one in attempts if one.cue is not None]
    # Counted from the last one on: of those that were said as often, the latest matters more.
    most = Counter(cue.fault for cue in reversed(cues)).most_common(1)
    name, count = most[0] if most else (None, 0)
    return document.ActionSummary(
        action=attempts[0].action,
        title=attempts[0].title,
        attempts=len(attempts),
        scored=len(scores),
        score=_rounded(sum(score for score, _ in meant) / len(meant)) if meant else None,
        score_sigma=_rounded(sum(sigma for _, sigma in meant) / len(meant)) if meant else None,
        cue=name,
        cue_text=next((cue.text for cue in cues if cue.fault == name), None),
        cue_count=count,
    )


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, _DIGITS)
