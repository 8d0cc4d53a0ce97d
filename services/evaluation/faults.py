"""How severe each fault was, from its evidence: 0 as it should be, 1 as a teacher would correct at once."""

import math
from typing import Final

from models.messages.feedback import Judgement
from models.teaching.schema import Evidence, Fault, Teaching
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.measured import Measured
from services.evaluation.measures.reduce import evaluate
from services.evaluation.signals.reading import Reading

LEAST_KNOWN: Final = 0.34
"""Share of the evidence, by weight, without which a fault is not judged."""
ALIKE: Final = 0.5
"""Correlation that is taken for the errors of two measures of one attempt: they share joints, and as often differ."""
MISSING_SIGMA: Final = 0.4
"""What is not known of a severity where a share of its evidence is missing: so much for all of it."""
_FARTHEST: Final = (-1.0, 2.5)
"""No single measure counts for more than this: what is beyond is a mistake of the measure, or worse than any fault."""


def judge(teaching: Teaching, reading: Reading, attempt: FoundAttempt) -> tuple[Judgement, ...]:
    """Every fault of the action, in the file's order.

    Args:
        teaching: of the attempt's action.
        reading: of a track that contains the attempt, some frames before and after it at best.
        attempt: on the track's clock.
    """
    return tuple(_judged(fault, [evaluate(evidence, reading, attempt) for evidence in fault.evidence]) for fault in teaching.fault)


def severity(evidence: Evidence, value: float) -> float:
    """Of one measure: 0 at `good`, 1 at `fault`, on a straight line."""
    least, most = _FARTHEST
    return min(max((evidence.good - value) / (evidence.good - evidence.fault), least), most)


def _judged(fault: Fault, measured: list[Measured]) -> Judgement:
    known = [(one, found) for one, found in zip(fault.evidence, measured, strict=True) if found.known]
    whole, weight = sum(one.weight for one in fault.evidence), sum(one.weight for one, _ in known)
    if weight < LEAST_KNOWN * whole:
        return Judgement(fault.name, None, None)
    mean = sum(one.weight * severity(one, found.value) for one, found in known) / weight
    sigmas = [one.weight * found.sigma / abs(one.good - one.fault) / weight for one, found in known]
    variance = (1 - ALIKE) * sum(sigma**2 for sigma in sigmas) + ALIKE * sum(sigmas) ** 2
    return Judgement(fault.name, mean, math.hypot(math.sqrt(variance), MISSING_SIGMA * (1 - weight / whole)))
