"""How far the whole body goes, and which of its parts moves first."""

import math
from typing import Final

from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.flight import COM_CM
from services.evaluation.measures.measured import HIDDEN, Estimate, Function, unknown
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.reading import Reading
from services.evaluation.signals.series import Series
from services.evaluation.signals.stretch import sample, stretch, top, top_sigma_s

_COM: Final = "Centre of mass"
_ORDER: Final = "Order of movements"


def _travels(reading: Reading, attempt: FoundAttempt) -> Estimate:
    ends = []
    for signal in COM_CM[:2]:
        series = reading.of(signal, "lead")
        first, last = (sample(series, attempt.moments_s[end]) for end in (0, -1))
        weights = last.weights - first.weights
        ends.append((last.value - first.value, series.variance(weights), bool(series.seen[weights != 0].all())))
    (x, x_variance, seen), (y, y_variance, _) = ends
    away = math.hypot(x, y)
    if not math.isfinite(away):
        return unknown(HIDDEN)
    variance = (x**2 * x_variance + y**2 * y_variance) / away**2 if away > 0 else max(x_variance, y_variance)
    return Estimate(away, math.sqrt(variance), seen)


def _rises_and_falls(reading: Reading, attempt: FoundAttempt) -> Estimate:
    series = reading.of(COM_CM[2], "lead")
    samples = stretch(series, attempt.moments_s[0], attempt.moments_s[-1])
    highest, lowest = top(series, samples), top(series, samples, -1.0)
    if highest is None or lowest is None:
        return unknown(HIDDEN)
    variance = series.variance(highest.weights - lowest.weights) + highest.hidden**2 + lowest.hidden**2
    seen = highest.seen and lowest.seen and _seen(series, attempt)
    return Estimate(highest.value - lowest.value, math.sqrt(variance), seen)


def _rise(reading: Reading, attempt: FoundAttempt) -> Estimate:
    series = reading.of(COM_CM[2], "lead")
    samples = stretch(series, attempt.moments_s[0], attempt.moments_s[-1])
    highest = top(series, samples)
    if highest is None or not math.isfinite(samples[0].value):
        return unknown(HIDDEN)
    first = samples[0]
    variance = series.variance(highest.weights - first.weights) + highest.hidden**2
    seen = highest.seen and bool(series.seen[first.weights != 0].all()) and _seen(series, attempt)
    return Estimate(highest.value - first.value, math.sqrt(variance), seen)


def _seen(series: Series, attempt: FoundAttempt) -> bool:
    inside = (series.t_s >= attempt.moments_s[0]) & (series.t_s <= attempt.moments_s[-1])
    return series.enough_seen(inside)


def _hips_then_wrist(reading: Reading, attempt: FoundAttempt) -> Estimate:
    times, variance, seen = [], 0.0, True
    for name in ("hip_speed", "wrist_speed"):
        series = reading.of(CATALOGUE[name], "lead")
        at = top(series, stretch(series, attempt.moment_s("exertion"), attempt.moment_s("end")))
        if at is None:
            return unknown(HIDDEN)
        times.append(at.place * series.frame_s)
        variance += top_sigma_s(series, at) ** 2
        seen &= at.timed and _seen(series, attempt)
    return Estimate(times[1] - times[0], math.sqrt(variance), seen)


FUNCTIONS = (
    Function(
        "com_travel",
        "cm",
        _COM,
        "How far the centre of mass goes along the floor from the start to the end.",
        "the paper's horizontal displacement",
        _travels,
    ),
    Function(
        "com_oscillation",
        "cm",
        _COM,
        "Highest less lowest place of the centre of mass in the attempt.",
        "the paper's vertical oscillation",
        _rises_and_falls,
    ),
    Function("com_rise", "cm", _COM, "Highest place of the centre of mass above where it is at the start.", "", _rise),
    Function(
        "hips_then_wrist",
        "s",
        _ORDER,
        "From the top speed of the hips to the top speed of the wrist that leads: throws and hits begin at the hips.",
        "proximal-to-distal sequence: Putnam, J. Biomechanics 26 suppl. 1, 1993",
        _hips_then_wrist,
    ),
)
