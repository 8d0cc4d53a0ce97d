"""Whether limbs that belong together move together."""

import math
from dataclasses import dataclass
from typing import Final

from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.measured import HIDDEN, Estimate, Function, unknown
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.posture import SideAsked
from services.evaluation.signals.reading import Reading
from services.evaluation.signals.stretch import stretch, top, top_sigma_s

_ARMS, _LEGS = "shoulder_elevation", "ankle_apart"
_FAMILY: Final = "Coordination"
_STRIKES_S, _JUMPS_S = 0.15, 0.35
"""The hand is highest within so long of the peak, and the body not longer before it."""


@dataclass(frozen=True)
class _Highest:
    """A signal that has its largest value from one instant to another."""

    signal: str
    side: SideAsked
    from_s: float
    to_s: float


def _arms_after_legs(reading: Reading, attempt: FoundAttempt) -> Estimate:
    from_s, to_s = attempt.moment_s("exertion"), attempt.moment_s("end")
    return _later(reading, *(_Highest(name, "both", from_s, to_s) for name in (_ARMS, _LEGS)))


def _hand_after_body(reading: Reading, attempt: FoundAttempt) -> Estimate:
    peak_s = attempt.moment_s("peak")
    hand = _Highest("wrist_height", "lead", peak_s - _STRIKES_S, peak_s + _STRIKES_S)
    return _later(reading, hand, _Highest("com_height", "both", peak_s - _JUMPS_S, peak_s + _STRIKES_S))


def _later(reading: Reading, one: _Highest, other: _Highest) -> Estimate:
    """Seconds from the second one's top to the first one's."""
    moments, variance, seen = [], 0.0, True
    for each in (one, other):
        series = reading.of(CATALOGUE[each.signal], each.side)
        highest = top(series, stretch(series, each.from_s, each.to_s))
        if highest is None:
            return unknown(HIDDEN)
        moments.append(highest.place * series.frame_s)
        variance += top_sigma_s(series, highest) ** 2
        seen &= highest.timed
    return Estimate(moments[0] - moments[1], math.sqrt(variance), seen)


FUNCTIONS = (
    Function(
        "arms_after_legs",
        "s",
        _FAMILY,
        "How much later the arms are raised highest than the feet are furthest apart, from the exertion to the end; negative for "
        "arms that come first.",
        "",
        _arms_after_legs,
    ),
    Function(
        "hand_after_body",
        "s",
        _FAMILY,
        "How much later the hand that leads is highest, around the peak, than the centre of mass: positive for a hit on "
        "the way down. Both tops are of the movement itself, and need no keyframe that is right to a hundredth of a second.",
        "",
        _hand_after_body,
    ),
)
