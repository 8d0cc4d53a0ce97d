"""Values of a series at instants, and over stretches of time: each a weighted sum of frames, so that its sigma follows."""

from dataclasses import dataclass

import numpy as np

from models.arrays import Float
from services.evaluation.signals.series import Series

_BEYOND: float = 0.5
"""Frames beyond the track's ends for which the end still stands."""


_ROUNDED: float = 0.6
"""Frames by which the smoother moves a top."""


@dataclass(frozen=True, eq=False)
class Sample:
    """A series at one instant.

    Attributes:
        place: of the instant among the frames, in frames.
        weights: (T,) of the frames in the value; they sum to 1.
        value: NaN if unknown.
    """

    place: float
    weights: Float
    value: float


def sample(series: Series, t_s: float) -> Sample:
    """A series at an instant: a cubic through four frames, or a line through two where not all four are known."""
    count = len(series)
    weights = np.zeros(count)
    place = (t_s - float(series.t_s[0])) / series.frame_s if count > 1 else 0.0
    if not -_BEYOND <= place <= count - 1 + _BEYOND:
        return Sample(place, weights, float("nan"))
    place = min(max(place, 0.0), count - 1.0)
    first = min(int(place), max(count - 2, 0))
    share = place - first
    if share < 1e-9:
        weights[first] = 1.0
    elif 1 <= first < count - 2 and np.isfinite(series.value[first - 1 : first + 3]).all():
        weights[first - 1 : first + 3] = _cubic(share)
    else:
        weights[first : first + 2] = (1 - share, share)
    return Sample(place, weights, summed(series.value, weights))


def stretch(series: Series, from_s: float, to_s: float) -> list[Sample]:
    """A series at both ends of a stretch and at all frames between."""
    first, last = sample(series, from_s), sample(series, to_s)
    inside = range(max(int(np.ceil(first.place + 1e-6)), 0), min(int(np.floor(last.place - 1e-6)), len(series) - 1) + 1)
    eye = np.eye(len(series))
    return [first, *(Sample(float(frame), eye[frame], float(series.value[frame])) for frame in inside), last]


def top(series: Series, samples: list[Sample], sign: float = 1.0) -> Sample | None:
    """Where the series is largest (`sign` 1) or smallest (-1): between frames by a parabola. None if nothing is known."""
    values = np.array([sign * one.value for one in samples])
    if not np.isfinite(values).any():
        return None
    number = int(np.nanargmax(values))
    best = samples[number]
    frame = round(best.place)
    if number in {0, len(samples) - 1} or not 0 < frame < len(series) - 1:
        return best
    before, here, after = series.value[frame - 1 : frame + 2]
    bend = before - 2 * here + after
    if not np.isfinite(bend) or sign * bend >= 0:
        return best
    shift = float(np.clip((before - after) / (2 * bend), -0.5, 0.5))
    place = min(max(frame + shift, samples[0].place), samples[-1].place)
    shift = place - frame
    weights = np.zeros(len(series))
    weights[frame - 1 : frame + 2] = (shift * (shift - 1) / 2, 1 - shift**2, shift * (shift + 1) / 2)
    return Sample(place, weights, summed(series.value, weights))


def top_sigma_s(series: Series, at: Sample) -> float:
    """Standard deviation of the instant at which a series has its top: the slope's over the bend."""
    frame = round(at.place)
    if not 0 < frame < len(series) - 1:
        return series.frame_s
    if at.weights[frame] == 1.0:  # the end of a stretch
        return series.frame_s / 2
    before, here, after = series.value[frame - 1 : frame + 2]
    weights = np.zeros(len(series))
    weights[[frame - 1, frame + 1]] = (-0.5, 0.5)
    bend = abs(before - 2 * here + after)
    if bend == 0:
        return float("nan")
    return float(np.hypot(np.sqrt(series.variance(weights)) / bend, _ROUNDED * bool(series.model.timing_s)) * series.frame_s)


def summed(values: Float, weights: Float) -> float:
    """Sum of the values that have a weight."""
    used = weights != 0
    return float(values[used] @ weights[used])


def _cubic(share: float) -> tuple[float, float, float, float]:
    """Lagrange's weights of frames -1, 0, 1 and 2 at a share of the way from 0 to 1."""
    u = share
    return (
        -u * (u - 1) * (u - 2) / 6,
        (u + 1) * (u - 1) * (u - 2) / 2,
        -(u + 1) * u * (u - 2) / 2,
        (u + 1) * u * (u - 1) / 6,
    )
