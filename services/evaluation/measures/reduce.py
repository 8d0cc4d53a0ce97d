"""Evaluates a measure as files say it: a signal reduced over a stretch of an attempt, or a function."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from msgspec import UNSET

from models.arrays import Float
from models.teaching.measure import Measure, Phase
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.catalogue import FUNCTIONS
from services.evaluation.measures.measured import HIDDEN, OUTSIDE, Measured
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.reading import Reading
from services.evaluation.signals.series import SEEN_SHARE, Series
from services.evaluation.signals.signal import Unit
from services.evaluation.signals.stretch import Sample, sample, stretch, summed, top, top_sigma_s

_ENDS: Final = 8
"""So many frames are in a difference of two instants; more are in a mean."""


def evaluate(measure: Measure, reading: Reading, attempt: FoundAttempt) -> Measured:
    """A measure of an attempt.

    Args:
        measure: what to measure.
        reading: of a track that contains the attempt, some frames before and after it at best.
        attempt: when its phases were, on the track's clock.

    Raises:
        KeyError: there is no such signal or function; `models.teaching.schema` refuses files with them.
    """
    if measure.function is not UNSET:
        function = FUNCTIONS[measure.function]
        found = function.call(reading, attempt)
        known = found.seen and math.isfinite(found.value) and math.isfinite(found.sigma)
        return Measured(function.name, found.value, found.sigma, function.unit, known, found.why or ("" if known else HIDDEN))
    if measure.signal is UNSET:
        raise ValueError("a measure has a signal or a function")
    signal = CATALOGUE[measure.signal]
    series = reading.of(signal, measure.side)
    return _reduced(measure, series, attempt, "s" if measure.take.startswith("time_") else signal.unit)


def name_of(measure: Measure) -> str:
    """For lists: "knee_flexion max start..peak", "trunk_forward at peak", "jump_height"."""
    if measure.function is not UNSET:
        return measure.function
    first, early_s, last, late_s = measure.stretch
    ends = [f"{phase}{shift_s:+g}s" if shift_s else phase for phase, shift_s in ((first, early_s), (last, late_s))]
    return f"{measure.signal} {measure.take} {ends[0] if ends[0] == ends[1] else '..'.join(ends)}"


@dataclass(frozen=True)
class _Value:
    value: float
    weights: Float | None
    sigma: float = math.nan


def _reduced(measure: Measure, series: Series, attempt: FoundAttempt, unit: Unit) -> Measured:
    moments: dict[Phase, float] = {phase: attempt.moment_s(phase) for phase in set(measure.stretch[::2])}
    samples = _samples(measure, series, moments)
    found = _taken(measure, series, samples)
    name = name_of(measure)
    inside = _share_inside(series, samples)
    if not math.isfinite(found.value) or inside < SEEN_SHARE:
        return Measured(name, math.nan, math.nan, unit, False, HIDDEN if inside == 1 else OUTSIDE)
    variance = found.sigma**2 if found.weights is None else series.variance(found.weights)
    for phase in moments:
        variance += _moment_variance(measure, series, moments, phase)
    known = _seen(series, samples, found.weights) and math.isfinite(variance)
    return Measured(name, found.value, math.sqrt(variance), unit, known, "" if known else HIDDEN)


def _samples(measure: Measure, series: Series, moments: Mapping[Phase, float]) -> list[Sample]:
    first, early_s, last, late_s = measure.stretch
    if measure.take == "at":
        return [sample(series, moments[first] + early_s)]
    return stretch(series, moments[first] + early_s, moments[last] + late_s)


def _taken(measure: Measure, series: Series, samples: list[Sample]) -> _Value:
    if measure.take == "mean":
        return _mean(series, samples)
    if measure.take in {"at", "change"}:
        first, last = samples[0], samples[-1]
        return _Value(first.value, first.weights) if measure.take == "at" else _difference(last, first)
    extreme = top(series, samples, -1.0 if measure.take.endswith("min") else 1.0)
    other = top(series, samples, -1.0) if measure.take == "range" else extreme
    if extreme is None or other is None:
        return _Value(math.nan, None)
    if measure.take == "range":
        return _difference(extreme, other)
    if measure.take.startswith("time_"):
        return _Value((extreme.place - samples[0].place) * series.frame_s, None, top_sigma_s(series, extreme))
    return _Value(extreme.value, extreme.weights)


def _difference(last: Sample, first: Sample) -> _Value:
    return _Value(last.value - first.value, last.weights - first.weights)


def _mean(series: Series, samples: list[Sample]) -> _Value:
    known = [one for one in samples if math.isfinite(one.value)]
    if not known:
        return _Value(math.nan, None)
    weights = np.mean([one.weights for one in known], axis=0)
    return _Value(summed(series.value, weights), weights)


def _moment_variance(measure: Measure, series: Series, moments: Mapping[Phase, float], phase: Phase) -> float:
    """By how much the value varies as the keyframe's instant does."""
    moment_s = series.model.moment_s
    if not moment_s:
        return 0.0
    values = []
    for shift_s in (-moment_s, moment_s):
        moved = _samples(measure, series, {**moments, phase: moments[phase] + shift_s})
        values.append(_taken(measure, series, moved).value)
    change = (values[1] - values[0]) / 2
    return change**2 if math.isfinite(change) else 0.0


def _share_inside(series: Series, samples: list[Sample]) -> float:
    """Of a stretch, how much lies within the track; an end may lie half a frame beside it."""
    first, last, end = samples[0].place, samples[-1].place, len(series) - 1
    if first == last:
        return float(-0.5 <= first <= end + 0.5)
    beside = max(-first - 0.5, 0.0) + max(last - end - 0.5, 0.0)
    return max(1 - beside / (last - first), 0.0)


def _seen(series: Series, samples: list[Sample], weights: Float | None) -> bool:
    """Whether enough of the stretch was seen, and all frames that an extreme or an end is made of."""
    frames = [min(max(round(one.place), 0), len(series) - 1) for one in samples]
    used = series.seen[weights != 0] if weights is not None else np.ones(1, np.bool_)
    many = np.count_nonzero(used) >= SEEN_SHARE * len(used) if len(used) > _ENDS else used.all()
    return bool(many) and series.enough_seen(np.array(frames))
