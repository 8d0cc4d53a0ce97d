"""How firmly somebody stands at the end."""

import math
from typing import Final

import numpy as np

from models.compiled import Counts
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures import keyframe
from services.evaluation.measures.flight import COM_CM
from services.evaluation.measures.measured import HIDDEN, Estimate, Function, unknown
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.reading import Reading
from services.evaluation.signals.series import Series

_FAMILY: Final = "Balance"
_LAST_S: Final = 0.5
_STEADY_M_S: Final = 0.25


def _last(series: Series, attempt: FoundAttempt) -> Counts:
    end_s = attempt.moment_s("end")
    return np.flatnonzero((series.t_s >= end_s - _LAST_S) & (series.t_s <= end_s) & np.isfinite(series.value))


def _sway(reading: Reading, attempt: FoundAttempt) -> Estimate:
    """Root mean square of level distances from the mean; what noise alone would give is taken off."""
    axes = [reading.of(signal, "lead") for signal in COM_CM[:2]]
    frames = _last(axes[0], attempt)
    if len(frames) < _FEWEST:
        return unknown(HIDDEN)
    centred = np.eye(len(frames)) - 1 / len(frames)
    square = noise = 0.0
    for series in axes:
        square += float(np.var(series.value[frames]))
        weights = np.zeros((len(frames), len(series)))
        weights[:, frames] = centred
        noise += float(np.mean([series.variance(row) for row in weights]))
    sway = math.sqrt(max(square - noise, 0.0))
    return Estimate(sway, math.sqrt(noise / 2) if sway**2 > noise else math.sqrt(noise), axes[0].enough_seen(frames))


_FEWEST: Final = 5


def _offset(reading: Reading, attempt: FoundAttempt) -> Estimate:
    ahead, aside = (reading.of(CATALOGUE[name], "lead") for name in ("com_forward", "com_aside"))
    frames = _last(ahead, attempt)
    if len(frames) < _FEWEST:
        return unknown(HIDDEN)
    weights = np.zeros(len(ahead))
    weights[frames] = 1 / len(frames)
    means = [float(series.value[frames].mean()) for series in (ahead, aside)]
    sigmas = [math.sqrt(series.variance(weights)) for series in (ahead, aside)]
    away = math.hypot(*means)
    sigma = math.hypot(means[0] * sigmas[0], means[1] * sigmas[1]) / away if away > max(sigmas) else max(sigmas)
    return Estimate(away, sigma, ahead.enough_seen(frames))


def _steady(reading: Reading, attempt: FoundAttempt) -> Estimate:
    speed = reading.of(CATALOGUE["com_speed"], "lead")
    peak_s = attempt.moment_s("peak")
    after = np.flatnonzero((speed.t_s >= peak_s) & (speed.t_s <= attempt.moment_s("end")))
    if len(after) < 2 or not np.isfinite(speed.value[after]).all():
        return unknown(HIDDEN)
    fast = after[speed.value[after] > _STEADY_M_S]
    peak_sigma_s = keyframe.sigma_s(reading, attempt, "peak")
    if len(fast) == 0:
        return Estimate(0.0, peak_sigma_s, speed.enough_seen(after))
    last = int(fast[-1])
    if last + 1 >= len(speed) or last == after[-1]:
        return unknown("still moved at the end")
    slows = float(speed.value[last] - speed.value[last + 1])
    share = (float(speed.value[last]) - _STEADY_M_S) / slows
    sigma_s = float(speed.sigma[last]) / slows * speed.frame_s
    at_s = float(speed.t_s[last]) + share * speed.frame_s
    return Estimate(at_s - peak_s, math.hypot(sigma_s, peak_sigma_s), speed.enough_seen(after))


FUNCTIONS = (
    Function(
        "sway",
        "cm",
        _FAMILY,
        f"How far the centre of mass strays, along the floor, from its mean place in the last {_LAST_S:g} s of the attempt "
        "(root mean square).",
        "Prieto et al., IEEE Trans. Biomedical Engineering 43(9), 1996 (RMS distance), of the centre of mass instead of pressure",
        _sway,
    ),
    Function(
        "support_offset",
        "pct",
        _FAMILY,
        f"How far the centre of mass is from over the middle of the ankles in the last {_LAST_S:g} s of the attempt.",
        "",
        _offset,
    ),
    Function(
        "time_to_steady",
        "s",
        _FAMILY,
        f"From the peak until the centre of mass stays slower than {_STEADY_M_S:g} m/s.",
        "",
        _steady,
    ),
)
