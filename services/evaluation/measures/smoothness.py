"""How smoothly a part of the body moves."""

import math
from collections.abc import Callable
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.measured import HIDDEN, Estimate, Function, unknown
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.reading import Reading
from services.evaluation.signals.series import Series

_FAMILY: Final = "Smoothness"
_HIGHEST_HZ: Final = 10.0
_AMPLITUDE: Final = 0.05
_PADDING: Final = 4
_FEWEST: Final = 8
_SMOOTHER: Final = {"spectral_arc_length": 0.1, "log_dimensionless_jerk": 0.4}
"""What fusion's smoother adds to smoothness, standard deviation: it cannot know which jerk was the pupil's."""
_DRAWS: Final = 12
"""Realisations of the noise from which a sigma is told; the same ones each time."""


def spectral_arc_length(speed: Float, rate_hz: float) -> float:
    """SPARC: the length of the curve of a speed profile's normalised spectrum, negative; smoother is nearer to 0.

    Args:
        speed: (T,) of one movement, none of it unknown.
        rate_hz: of the frames.
    """
    count = int(2 ** (math.ceil(math.log2(len(speed))) + _PADDING))
    spectrum = np.abs(np.fft.rfft(speed, count))
    if spectrum[0] <= 0:
        return math.nan
    spectrum = spectrum / spectrum[0]
    frequency = np.fft.rfftfreq(count, 1 / rate_hz)
    low = frequency <= _HIGHEST_HZ
    above = np.flatnonzero(spectrum[low] >= _AMPLITUDE)
    kept, along = spectrum[: above[-1] + 1], frequency[: above[-1] + 1]
    width = float(along[-1] - along[0])
    return -float(np.hypot(np.diff(along) / width, np.diff(kept)).sum()) if width > 0 else math.nan


def log_dimensionless_jerk(speed: Float, rate_hz: float) -> float:
    """LDLJ of a speed profile: -ln of (duration^3 / peak speed^2) times the integral of its squared second derivative."""
    second = np.diff(speed, 2) * rate_hz**2
    whole_s = (len(speed) - 1) / rate_hz
    peak = float(np.max(np.abs(speed)))
    total = float((second**2).sum() / rate_hz)
    return -math.log(whole_s**3 / peak**2 * total) if peak > 0 and total > 0 else math.nan


def _of(signal: str, by: Callable[[Float, float], float]) -> Callable[[Reading, FoundAttempt], Estimate]:
    def call(reading: Reading, attempt: FoundAttempt) -> Estimate:
        series = reading.of(CATALOGUE[signal], "lead")
        inside = (series.t_s >= attempt.moments_s[0]) & (series.t_s <= attempt.moments_s[-1])
        speed = series.value[inside]
        if len(speed) < _FEWEST or not np.isfinite(speed).all():
            return unknown(HIDDEN)
        rate_hz = 1 / series.frame_s
        value = by(speed, rate_hz)
        draws = [by(speed + noise, rate_hz) for noise in _noises(series, inside)]
        own = _SMOOTHER[by.__name__] if series.model.timing_s else 0.0
        sigma = math.hypot(float(np.std(draws)), own)
        return Estimate(value, sigma, series.enough_seen(inside))

    return call


def _noises(series: Series, inside: Bool) -> Float:
    """(draws, frames) of a speed's error, alike in time as `Uncertainty` says: these measures are no sums, so no slopes help."""
    frames = np.flatnonzero(inside)
    values, vectors = np.linalg.eigh(series.covariance(frames))
    normal = np.random.default_rng(0).standard_normal((_DRAWS, len(frames)))
    return np.asarray(normal * np.sqrt(np.maximum(values, 0.0)) @ vectors.T)


_SPARC = "Balasubramanian et al., J. NeuroEngineering and Rehabilitation 12:112, 2015"
_LDLJ = "Hogan and Sternad, J. Motor Behavior 41(6), 2009; Balasubramanian et al., 2015"
FUNCTIONS = (
    Function(
        "wrist_smoothness",
        "1",
        _FAMILY,
        "Spectral arc length of the speed of the wrist that leads, over the attempt: negative; smoother is nearer to 0.",
        _SPARC,
        _of("wrist_speed", spectral_arc_length),
    ),
    Function(
        "com_smoothness",
        "1",
        _FAMILY,
        "Spectral arc length of the speed of the centre of mass over the attempt.",
        _SPARC,
        _of("com_speed", spectral_arc_length),
    ),
    Function(
        "wrist_jerk",
        "1",
        _FAMILY,
        "Log dimensionless jerk of the speed of the wrist that leads, over the attempt: larger is smoother.",
        _LDLJ,
        _of("wrist_speed", log_dimensionless_jerk),
    ),
)
