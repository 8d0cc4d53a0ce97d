"""What is said after an attempt: what was good first, then at most one thing to correct; nothing where nobody can be sure, and then
whether that is approval.

Rules and texts only: no words are made up here or by any model (docs/decisions/0009-no-language-model.md). The same judgements give
the same words.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from models.messages.feedback import Judgement, MeasureResult
from models.teaching.schema import Teaching
from services.evaluation.agreement import unpraised

CALLED: Final = 0.5
"""From this severity on a fault is corrected."""
SURE: Final = 0.75
"""So likely it must be that a fault is one, to be spoken of."""
VAGUE: Final = 0.48
"""A severity with a larger standard deviation is not spoken of, whatever it looks like: such joints are often quite wrong."""
GOOD: Final = 0.4
SURELY_GOOD: Final = 0.9
"""A point is praised that has less than this severity, so likely."""
POSSIBLE: Final = 0.25
"""A fault that is likelier than this may have been made: to say nothing of it is no approval."""
_WORST: Final = 1.5
"""What is still worse is not corrected with more urgency."""


@dataclass(frozen=True)
class Said:
    """Of one attempt.

    Attributes:
        praise: the fault whose point was good; empty for none.
        cue: the fault that is to be corrected; empty for none.
        certainty: how likely it is that this fault was made; 0 without a cue.
        fine: there is nothing to correct, and that is sure; without a cue and without this nothing is sure enough.
    """

    praise: str = ""
    cue: str = ""
    certainty: float = 0.0
    fine: bool = False


def choose(teaching: Teaching, judgements: Sequence[Judgement], measures: Sequence[MeasureResult]) -> Said:
    """What to say.

    Args:
        teaching: of the action.
        judgements: of its faults, in the same order (`services.evaluation.faults.judge`).
        measures: that the page shows; what one of them calls fair or poor is not praised, and poor is not fine.
    """
    importances = [fault.importance for fault in teaching.fault]
    cue = _largest([_urgency(one, weight) for one, weight in zip(judgements, importances, strict=True)])
    opposite = _opposite(teaching, judgements)
    not_good = unpraised(teaching, measures) | opposite
    merits = [_merit(one, weight) for one, weight in zip(judgements, importances, strict=True)]
    praise = _largest([0.0 if one.fault in not_good else merit for one, merit in zip(judgements, merits, strict=True)])
    return Said(
        praise="" if praise is None else judgements[praise].fault,
        cue="" if cue is None else judgements[cue].fault,
        certainty=0.0 if cue is None else above(judgements[cue], CALLED),
        fine=cue is None and not opposite and _is_fine(judgements, measures),
    )


def above(judgement: Judgement, severity: float) -> float:
    """How likely it is that a fault is more severe than this; 0.5 if nothing is known of it."""
    if judgement.severity is None or judgement.sigma is None:
        return 0.5
    if judgement.sigma == 0:
        return float(judgement.severity > severity)
    return 0.5 * math.erfc((severity - judgement.severity) / (math.sqrt(2) * judgement.sigma))


def _is_fine(judgements: Sequence[Judgement], measures: Sequence[MeasureResult]) -> bool:
    """Whether nothing was wrong: all was judged, and not vaguely, no fault may have been made, and no number says otherwise."""
    judged = all(one.sigma is not None and one.sigma <= VAGUE for one in judgements)
    unlikely = all(above(one, CALLED) <= POSSIBLE for one in judgements)
    return judged and unlikely and all(one.verdict != "poor" for one in measures)


def _opposite(teaching: Teaching, judgements: Sequence[Judgement]) -> set[str]:
    """Names of faults whose opposite is a mistake, too, and may have been made: as far beyond what is good as a fault is corrected.

    It is not corrected: by what numbers a teacher would do so, nobody has said.
    """
    return {
        fault.name
        for fault, one in zip(teaching.fault, judgements, strict=True)
        if fault.either_way
        and one.severity is not None
        and above(Judgement(one.fault, -one.severity, one.sigma), CALLED) > POSSIBLE
    }


def _urgency(judgement: Judgement, importance: float) -> float:
    """Importance times size times certainty; 0 for what is not to be corrected."""
    sure = above(judgement, CALLED)
    if judgement.severity is None or judgement.sigma is None or sure < SURE or judgement.sigma > VAGUE:
        return 0.0
    return importance * min(judgement.severity, _WORST) * sure


def _merit(judgement: Judgement, importance: float) -> float:
    """The same of what was good, of which nothing is better than right; 0 for what is not surely good."""
    sure = 1 - above(judgement, GOOD)
    if judgement.severity is None or judgement.sigma is None or sure < SURELY_GOOD or judgement.sigma > VAGUE:
        return 0.0
    return importance * (1 - max(judgement.severity, 0.0)) * sure


def _largest(values: Sequence[float]) -> int | None:
    """Place of the largest value, the first of equal ones; None if none is above 0."""
    place = max(range(len(values)), key=values.__getitem__, default=None)
    return place if place is not None and values[place] > 0 else None
