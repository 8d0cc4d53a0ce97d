"""What one pupil does in a lesson: attempts and what is between them, put one after the other."""

from collections.abc import Iterable
from functools import partial

from models.motions.between import Between, spend
from models.motions.motion import Motion
from models.motions.perform import perform
from models.motions.performance import Performance
from models.motions.sequence import Act, Sequence
from models.motions.standpoint import Standpoint
from models.motions.subject import Subject

Entry = Performance | Between


def lesson(entries: Iterable[Entry], subject: Subject, start: Standpoint | None = None) -> Sequence:
    """All entries in their order, begun at `start` (the world's origin, looking along x, if left out).

    Raises:
        UserError: an action or a fault that is not known.
        ValueError: no entry at all.
    """
    return Sequence([_act(entry, subject) for entry in entries], start)


def _act(entry: Entry, subject: Subject) -> Act:
    return partial(_performed, entry, subject) if isinstance(entry, Performance) else partial(spend, entry, subject)


def _performed(performance: Performance, subject: Subject, at: Standpoint) -> Motion:
    del at  # an attempt goes on where the pupil stands
    return perform(performance, subject)
