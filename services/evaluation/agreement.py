"""Which of the numbers that the page shows are about the same thing as what is said: one must never contradict the other."""

from collections.abc import Sequence
from typing import Final

import msgspec
from msgspec import UNSET

from models.messages.feedback import MeasureResult
from models.teaching.measure import PHASES, Measure, Side, Take
from models.teaching.schema import Fault, Teaching
from services.evaluation.signals.catalogue import CATALOGUE

_KINDS: Final[tuple[frozenset[Take], ...]] = (
    frozenset(("at", "mean", "max")),
    frozenset(("at", "mean", "min")),
    frozenset(("range", "change")),
    frozenset(("time_of_max",)),
    frozenset(("time_of_min",)),
)
"""Of one stretch, numbers of one kind grow with one another; how far an arm bends at most says nothing of how straight it gets."""
_APART: Final[frozenset[frozenset[Side]]] = frozenset((frozenset(("lead", "other")), frozenset(("left", "right"))))


def alike(one: Measure, other: Measure) -> bool:
    """Whether two measures look at the same limb at the same time, and take the same kind of number."""
    if one.signal is UNSET or other.signal is UNSET:
        return one.function is not UNSET and one.function == other.function
    if one.signal != other.signal or not any(one.take in kind and other.take in kind for kind in _KINDS):
        return False
    if CATALOGUE[one.signal].sided and frozenset((one.side, other.side)) in _APART:
        return False
    (begin, end), (later_begin, later_end) = sorted((_stretch(one), _stretch(other)))
    return later_begin < end or later_begin == begin or later_begin == later_end == end


def about(shown: Measure, fault: Fault) -> bool:
    """Whether a number on the page is evidence of a fault."""
    return any(alike(shown, evidence) for evidence in fault.evidence)


def unpraised(teaching: Teaching, measures: Sequence[MeasureResult]) -> set[str]:
    """Names of faults whose point is not called good: a number beside it says that it was not.

    Severity has but one side. Whoever bends his knees far beyond what is good is furthest from the fault of not bending them.
    """
    verdicts = {measure.name: measure.verdict for measure in measures}
    doubted = [shown for shown in teaching.shown if verdicts.get(shown.name) in {"fair", "poor"}]
    return {fault.name for fault in teaching.fault if any(about(shown, fault) for shown in doubted)}


def beside_cue(teaching: Teaching, cue: str, measures: Sequence[MeasureResult]) -> tuple[MeasureResult, ...]:
    """The measures, of which none is called good that is evidence of the fault that is corrected."""
    corrected = [fault for fault in teaching.fault if fault.name == cue]
    named = {shown.name for shown in teaching.shown if any(about(shown, fault) for fault in corrected)}
    return tuple(
        msgspec.structs.replace(one, verdict="fair") if one.name in named and one.verdict == "good" else one for one in measures
    )


def _stretch(measure: Measure) -> tuple[tuple[int, float], tuple[int, float]]:
    """Its ends, which sort in the order of time."""
    first, early_s, last, late_s = measure.stretch
    return (PHASES.index(first), early_s), (PHASES.index(last), late_s)
