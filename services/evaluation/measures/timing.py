"""How long phases take."""

import math
from collections.abc import Callable
from typing import Final

from models.teaching.measure import Phase
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures import keyframe
from services.evaluation.measures.measured import HIDDEN, Estimate, Function
from services.evaluation.signals.reading import Reading

_FAMILY: Final = "Tempo"


def _lasts(first: Phase, last: Phase) -> Callable[[Reading, FoundAttempt], Estimate]:
    def call(reading: Reading, attempt: FoundAttempt) -> Estimate:
        lasts_s = attempt.moment_s(last) - attempt.moment_s(first)
        return _estimate(lasts_s, math.sqrt(2) * reading.model.moment_s, _seen(reading, attempt, first, last))

    return call


def _preparation_share(reading: Reading, attempt: FoundAttempt) -> Estimate:
    start_s, exertion_s, peak_s, _ = attempt.moments_s
    whole_s = peak_s - start_s
    share = (exertion_s - start_s) / whole_s
    moment_s = reading.model.moment_s
    sigma = 100 * moment_s / whole_s * math.sqrt(1 + share**2 + (1 - share) ** 2)
    return _estimate(100 * share, sigma, _seen(reading, attempt, "start", "exertion", "peak"))


def _estimate(value: float, sigma: float, seen: bool) -> Estimate:
    return Estimate(value, sigma, seen, "" if seen else HIDDEN)


def _seen(reading: Reading, attempt: FoundAttempt, *phases: Phase) -> bool:
    return all(keyframe.is_seen(reading, attempt, phase) for phase in phases)


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
