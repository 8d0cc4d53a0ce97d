"""Whether both sides do the same."""

import math
from collections.abc import Callable
from typing import Final

import numpy as np

from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.measured import HIDDEN, Estimate, Function, unknown
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.reading import Reading
from services.evaluation.signals.series import Series
from services.evaluation.signals.stretch import stretch, top

_FAMILY: Final = "Symmetry"
_PARTS: Final = {
    "knee": "knee_flexion",
    "hip": "hip_flexion",
    "elbow": "elbow_flexion",
    "shoulder": "shoulder_elevation",
}
_LEAST_RANGE_DEG: Final = 10.0
"""Of sides that move less than this no ratio is told."""


def _difference(signal: str) -> Callable[[Reading, FoundAttempt], Estimate]:
    def call(reading: Reading, attempt: FoundAttempt) -> Estimate:
        lead, other = (reading.of(CATALOGUE[signal], side) for side in ("lead", "other"))
        series = lead.plus(other, -1.0)
        inside = (series.t_s >= attempt.moments_s[0]) & (series.t_s <= attempt.moments_s[-1])
        known = inside & np.isfinite(series.value)
        if not known.any():
            return unknown(HIDDEN)
        weights = known / np.count_nonzero(known)
        seen = series.enough_seen(inside)
        return Estimate(float(series.value[known].mean()), math.sqrt(series.variance(weights)), seen)

    return call


def _index(signal: str) -> Callable[[Reading, FoundAttempt], Estimate]:
    def call(reading: Reading, attempt: FoundAttempt) -> Estimate:
        sides = [reading.of(CATALOGUE[signal], side) for side in ("lead", "other")]
        ranges = [_range(series, attempt) for series in sides]
        if not all(math.isfinite(value) for value, _, _ in ranges):
            return unknown(HIDDEN)
        (lead, lead_sigma, lead_seen), (other, other_sigma, other_seen) = ranges
        whole = lead + other
        if whole < 2 * _LEAST_RANGE_DEG:
            return unknown(f"both sides move by less than {_LEAST_RANGE_DEG:g} degrees")
        sigma = 400 / whole**2 * math.hypot(other * lead_sigma, lead * other_sigma)
        return Estimate(200 * (lead - other) / whole, sigma, lead_seen and other_seen)

    return call


def _range(series: Series, attempt: FoundAttempt) -> tuple[float, float, bool]:
    """Of a signal over the attempt, with its standard deviation and whether it was seen."""
    samples = stretch(series, attempt.moments_s[0], attempt.moments_s[-1])
    highest, lowest = top(series, samples), top(series, samples, -1.0)
    if highest is None or lowest is None:
        return math.nan, math.nan, False
    variance = series.variance(highest.weights - lowest.weights) + highest.hidden**2 + lowest.hidden**2
    inside = (series.t_s >= attempt.moments_s[0]) & (series.t_s <= attempt.moments_s[-1])
    return highest.value - lowest.value, math.sqrt(variance), highest.seen and lowest.seen and series.enough_seen(inside)


FUNCTIONS = (
    *(
        Function(
            f"{part}_difference",
            "deg",
            _FAMILY,
            f"Mean over the attempt of how much more the {part} of the side that leads is bent or lifted than the other one.",
            "",
            _difference(signal),
        )
        for part, signal in _PARTS.items()
    ),
    *(
        Function(
            f"{part}_symmetry",
            "pct",
            _FAMILY,
            f"Symmetry index of the ranges of `{signal}`: 200 (lead - other) / (lead + other); 0 is the same on both sides.",
            "Robinson, Herzog and Nigg, J. Manipulative and Physiological Therapeutics 10, 1987",
            _index(signal),
        )
        for part, signal in _PARTS.items()
    ),
)
