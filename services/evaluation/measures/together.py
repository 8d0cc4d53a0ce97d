"""Whether limbs that belong together move together."""

import math
from typing import Final

from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.measured import HIDDEN, Estimate, Function, unknown
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.reading import Reading
from services.evaluation.signals.stretch import stretch, top, top_sigma_s

_ARMS, _LEGS = "shoulder_elevation", "ankle_apart"
_FAMILY: Final = "Coordination"


def _arms_after_legs(reading: Reading, attempt: FoundAttempt) -> Estimate:
    moments, variance, seen = [], 0.0, True
    for name in (_ARMS, _LEGS):
        series = reading.of(CATALOGUE[name], "both")
        highest = top(series, stretch(series, attempt.moment_s("exertion"), attempt.moment_s("end")))
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
)
