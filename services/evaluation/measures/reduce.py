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
from services.evaluation.measures import keyframe
from services.evaluation.measures.catalogue import FUNCTIONS
from services.evaluation.measures.measured import BACKWARDS, HIDDEN, OUTSIDE, Measured
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.reading import Reading
from services.evaluation.signals.series import SEEN_SHARE, Series
from services.evaluation.signals.signal import Unit
from services.evaluation.signals.stretch import Sample, sample, stretch, summed, top, top_sigma_s

_ENDS: Final = 8
"""Of a mean of so few frames all must have been seen."""
LEVELS: Final = frozenset({"at", "max", "min", "mean"})
"""What is taken of a signal for a number that is a value of the signal itself, and not how far two values are apart, or when."""


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
    return _reduced(measure, series, reading, attempt, "s" if measure.take.startswith("time_") else signal.unit)


def name_of(measure: Measure) -> str:
    """For lists: "knee_flexion max start..peak", "trunk_forward at peak", "jump_height"."""
    if measure.function is not UNSET:
        return measure.function
    first, early_s, last, late_s = measure.stretch
    ends = [f"{phase}{shift_s:+g}s" if shift_s else phase for phase, shift_s in ((first, early_s), (last, late_s))]
    return f"{measure.signal} {measure.take} {ends[0] if ends[0] == ends[1] else '..'.join(ends)}"


@dataclass(frozen=True)
class _Value:
    """What is taken of a stretch.

    Attributes:
        value: NaN if unknown.
        weights: (T,) of the frames that it is a sum of; None if it is none.
        sigma: a standard deviation beside what the weights have.
        seen: whether what it is made of was.
    """

    value: float
    weights: Float | None = None
    sigma: float = 0.0
    seen: bool = False


def _reduced(measure: Measure, series: Series, reading: Reading, attempt: FoundAttempt, unit: Unit) -> Measured:
    phases = [measure.stretch[0], measure.stretch[2]]
    if _is_against_start(measure, series):
        phases.append("start")
    moments: dict[Phase, float] = {phase: attempt.moment_s(phase) for phase in phases}
    name = name_of(measure)
    first_s, last_s = _ends_s(measure, moments)
    if last_s < first_s:
        return Measured(name, math.nan, math.nan, unit, False, BACKWARDS)
    series = series.about(first_s, last_s)
    samples = _samples(measure, series, moments)
    found = _value(measure, series, moments)
    inside = _share_inside(series, samples)
    if not math.isfinite(found.value) or inside < SEEN_SHARE:
        return Measured(name, math.nan, math.nan, unit, False, HIDDEN if inside == 1 else OUTSIDE)
    variance = found.sigma**2 + (0.0 if found.weights is None else series.variance(found.weights))
    for phase in moments:
        moment_s = keyframe.sigma_s(reading, attempt, phase)
        variance += _moment_variance(measure, series, moments, phase, moment_s, found.value)
    known = found.seen and _enough_seen(series, samples) and math.isfinite(variance)
    return Measured(name, found.value, math.sqrt(variance), unit, known, "" if known else HIDDEN)


def _is_against_start(measure: Measure, series: Series) -> bool:
    """Whether the value at the start is to be taken off; where two values are taken from one another it is none of either."""
    return series.from_start and measure.take in LEVELS


def _ends_s(measure: Measure, moments: Mapping[Phase, float]) -> tuple[float, float]:
    first, early_s, last, late_s = measure.stretch
    return moments[first] + early_s, moments[last] + late_s


def _samples(measure: Measure, series: Series, moments: Mapping[Phase, float]) -> list[Sample]:
    first_s, last_s = _ends_s(measure, moments)
    return [sample(series, first_s)] if measure.take == "at" else stretch(series, first_s, last_s)


def _value(measure: Measure, series: Series, moments: Mapping[Phase, float]) -> _Value:
    found = _taken(measure, series, _samples(measure, series, moments))
    if found.weights is None or not _is_against_start(measure, series):
        return found
    start = sample(series, moments["start"])
    seen = found.seen and bool(series.seen[start.weights != 0].all())
    return _Value(found.value - start.value, found.weights - start.weights, found.sigma, seen)


def _taken(measure: Measure, series: Series, samples: list[Sample]) -> _Value:
    if measure.take == "mean":
        return _mean(series, samples)
    if measure.take in {"at", "change"}:
        first, last = samples[0], samples[-1]
        weights = first.weights if measure.take == "at" else last.weights - first.weights
        value = first.value if measure.take == "at" else last.value - first.value
        return _Value(value, weights, seen=bool(series.seen[weights != 0].all()))
    extreme = top(series, samples, -1.0 if measure.take.endswith("min") else 1.0)
    other = top(series, samples, -1.0) if measure.take == "range" else extreme
    if extreme is None or other is None:
        return _Value(math.nan)
    if measure.take == "range":
        hidden = math.hypot(extreme.hidden, other.hidden)
        return _Value(extreme.value - other.value, extreme.weights - other.weights, hidden, extreme.seen and other.seen)
    if measure.take.startswith("time_"):
        return _Value((extreme.place - samples[0].place) * series.frame_s, None, top_sigma_s(series, extreme), extreme.timed)
    return _Value(extreme.value, extreme.weights, extreme.hidden, extreme.seen)


def _mean(series: Series, samples: list[Sample]) -> _Value:
    """Of what was seen; where nothing was, of what is known otherwise, and not `seen`."""
    known = [one for one in samples if math.isfinite(one.value)]
    if not known:
        return _Value(math.nan)
    frames = series.seen[np.any([one.weights != 0 for one in known], axis=0)]
    enough = np.count_nonzero(frames) >= SEEN_SHARE * len(frames) if len(frames) > _ENDS else frames.all()
    seen = [one for one in known if series.seen[one.weights != 0].all()]
    used = seen or known
    weights = np.mean([one.weights for one in used], axis=0)
    hidden = _unseen_share(samples, len(seen)) * _spread([one.value for one in used])
    return _Value(summed(series.value, weights), weights, hidden, bool(enough))


def _unseen_share(samples: list[Sample], seen: int) -> float:
    """Of a stretch; what lies beyond the track has no samples, and was not seen, either."""
    whole = max(len(samples), samples[-1].place - samples[0].place + 1)
    return 1 - seen / whole


def _spread(values: list[float]) -> float:
    """How far the mean of what was not seen may be from that of what was, as a standard deviation: half of the range.

    The values' own standard deviation would do if any frame were as likely to be lost. It is the fast ones at the turning points.
    """
    return (max(values) - min(values)) / 2


def _moment_variance(
    measure: Measure, series: Series, moments: Mapping[Phase, float], phase: Phase, moment_s: float, value: float
) -> float:
    """By how much the value varies as the keyframe's instant does; beside what is not known, as on the other side of it. NaN where
    that is not known on either."""
    if not moment_s:
        return 0.0
    changes = [
        _value(measure, series, {**moments, phase: moments[phase] + shift_s}).value - value for shift_s in (-moment_s, moment_s)
    ]
    # Each by itself: where the value turns about, as it does at many a peak, earlier and later are alike, and both off.
    known = [change**2 for change in changes if math.isfinite(change)]
    return sum(known) / len(known) if known else math.nan


def _share_inside(series: Series, samples: list[Sample]) -> float:
    """Of a stretch, how much lies within the track; an end may lie half a frame beside it."""
    first, last, end = samples[0].place, samples[-1].place, len(series) - 1
    if first == last:
        return float(-0.5 <= first <= end + 0.5)
    beside = max(-first - 0.5, 0.0) + max(last - end - 0.5, 0.0)
    return max(1 - beside / (last - first), 0.0)


def _enough_seen(series: Series, samples: list[Sample]) -> bool:
    """Whether most of the stretch was."""
    return series.enough_seen(np.array([min(max(round(one.place), 0), len(series) - 1) for one in samples]))
