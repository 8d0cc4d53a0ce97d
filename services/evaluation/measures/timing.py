"""How long phases take."""

import math

from models.teaching.measure import Phase
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.measured import Estimate, Function
from services.evaluation.signals.reading import Reading

_FAMILY = "Tempo"


def _lasts(first: Phase, last: Phase):  # type: ignore[no-untyped-def]
    def call(reading: Reading, attempt: FoundAttempt) -> Estimate:
        return Estimate(attempt.moment_s(last) - attempt.moment_s(first), math.sqrt(2) * reading.model.moment_s)

    return call


def _preparation_share(reading: Reading, attempt: FoundAttempt) -> Estimate:
    start_s, exertion_s, peak_s, _ = attempt.moments_s
    whole_s = peak_s - start_s
    share = (exertion_s - start_s) / whole_s
    moment_s = reading.model.moment_s
    return Estimate(100 * share, 100 * moment_s / whole_s * math.sqrt(1 + share**2 + (1 - share) ** 2))


FUNCTIONS = (
    Function("preparation_time", "s", _FAMILY, "From the start to the exertion.", "", _lasts("start", "exertion")),
    Function("effort_time", "s", _FAMILY, "From the exertion to the peak.", "", _lasts("exertion", "peak")),
    Function("recovery_time", "s", _FAMILY, "From the peak to the end.", "", _lasts("peak", "end")),
    Function("attempt_time", "s", _FAMILY, "From the start to the end.", "", _lasts("start", "end")),
    Function(
        "preparation_share",
        "pct",
        _FAMILY,
        "Share of the preparation in the time from the start to the peak, percent.",
        "",
        _preparation_share,
    ),
)
