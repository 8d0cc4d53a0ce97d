"""Whose attempts a recorded lesson holds: what was said on the day, and what a teacher corrected since. Nothing is rewritten.

Pure: a lesson's parts go in, as its reader gives them.
"""

from collections.abc import Iterable
from typing import Final

import msgspec

from models.messages.feedback import Feedback
from models.messages.health import Health
from models.messages.lesson import Entry
from models.messages.pupil import PupilCorrections, PupilTurn, pupil_at
from models.process import EVALUATION
from services.lesson.lesson_reader import LessonPart
from services.lesson.replay import decode

BEFORE_NS: Final = 500_000_000
"""So much earlier than on the day may an attempt begin when it is found once more."""
_KINDS: Final = frozenset({"health", "feedback", "corrections"})


def attempts_told(parts: Iterable[LessonPart]) -> tuple[Feedback, ...]:
    """The attempts as they were judged on the day, each with its pupil as corrected; UserError if one cannot be read."""
    return _told(_entries(parts))


def turns_of(parts: Iterable[LessonPart]) -> tuple[PupilTurn, ...]:
    """Who was up when, for whoever looks for the attempts once more: during each of them it is whose it was after all.

    Returns:
        In the order of their times; the first may be from before the lesson.

    Raises:
        UserError: an entry cannot be read.
    """
    entries = _entries(parts)
    turns = _turns_told(entries)
    for feedback in _told(entries):
        start_ns, end_ns = feedback.keyframes_ns[0], feedback.keyframes_ns[-1]
        if pupil_at(turns, start_ns) != feedback.pupil:
            own = PupilTurn(feedback.pupil, max(start_ns - BEFORE_NS, 0))
            after = PupilTurn(pupil_at(turns, end_ns), end_ns + 1)
            others = [turn for turn in turns if not own.t_ns <= turn.t_ns <= after.t_ns]
            turns = sorted([*others, own, after], key=lambda turn: turn.t_ns)
    return tuple(turns)


def _entries(parts: Iterable[LessonPart]) -> list[Entry]:
    return [entry for part in parts for entry in part.entries if entry.kind in _KINDS]


def _told(entries: list[Entry]) -> tuple[Feedback, ...]:
    feedbacks: list[Feedback] = []
    codes: dict[int, str] = {}
    for entry in entries:
        if entry.kind == "feedback":
            feedbacks.append(decode(entry, Feedback))
        elif entry.kind == "corrections":
            codes |= {one.attempt: one.pupil for one in decode(entry, PupilCorrections).corrections}
    return tuple(msgspec.structs.replace(one, pupil=codes[one.id]) if one.id in codes else one for one in feedbacks)


def _turns_told(entries: list[Entry]) -> list[PupilTurn]:
    """As the evaluation said who was up."""
    turns: list[PupilTurn] = []
    heard: PupilTurn | None = None
    for entry in entries:
        health = decode(entry, Health) if entry.kind == "health" else None
        if health is None or health.process != EVALUATION or health.evaluation is None:
            continue
        said = PupilTurn(health.evaluation.pupil, health.evaluation.pupil_since_ns)
        if said != heard:
            heard = said
            # One that was started again knows of nobody at first, and then perhaps of the old turn: both count from then on.
            news = not turns or said.t_ns > turns[-1].t_ns
            turns.append(said if news else PupilTurn(said.pupil, entry.t_ns))
    return turns
