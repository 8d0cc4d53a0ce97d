"""Values of a series at instants, and over stretches of time: each a weighted sum of frames, so that its sigma follows."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float
from models.compiled import Counts
from services.evaluation.signals.series import Series

_BEYOND: Final = 0.5
"""Frames beyond the track's ends for which the end still stands."""
_ROUNDED: Final = 0.6
"""Frames by which the smoother moves a top."""
_LONGEST_UNSEEN_S: Final = 0.4
"""What was not seen for longer may have held anything."""
_SLOPE_FRAMES: Final = 2
"""Frames over which a slope beside what was not seen is taken."""
_SAME: Final = 1e-6


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


@dataclass(frozen=True, eq=False)
class Top(Sample):
    """The largest or smallest value of a stretch.

    Attributes:
        bends: whether the series bends there; it does not where it only ends, or is not known on both sides.
        seen: whether all that it is made of was, and what is beside it in the stretch: else it may be but the edge of what was not.
        hidden: how much further the series may have gone elsewhere in the stretch, where it was not seen: as far as straight lines
            from both sides lead. A standard deviation, beside that of the value; infinite where it may have gone anywhere.
    """

    bends: bool
    seen: bool
    hidden: float

    @property
    def timed(self) -> bool:
        """Whether it is known when it was."""
        return self.seen and self.hidden == 0


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


def top(series: Series, samples: list[Sample], sign: float = 1.0) -> Top | None:
    """Where the series is largest (`sign` 1) or smallest (-1), of what was seen: between frames by a parabola.

    Where nothing at all was seen, it is of what is known otherwise, and not `seen`. None if nothing is known.
    """
    values = np.array([sign * one.value for one in samples])
    if not np.isfinite(values).any():
        return None
    frames = np.clip(np.rint([one.place for one in samples]), 0, len(series) - 1).astype(np.int64)
    seen = series.seen[frames]
    seen[[0, -1]] = [bool(series.seen[one.weights != 0].all()) for one in (samples[0], samples[-1])]
    judged = np.where(seen, values, np.nan)
    number = int(np.nanargmax(judged if np.isfinite(judged).any() else values))
    at, bends = _between_frames(series, samples, number, sign)
    low, high = _frames(series, samples)
    frame = round(at.place)
    beside = np.clip((frame - 1, frame, frame + 1), low, high)
    whole = bool(series.seen[beside].all() and series.seen[at.weights != 0].all())
    return Top(at.place, at.weights, at.value, bends, whole, max(_roof(series, samples, sign) - sign * at.value, 0.0))


def _between_frames(series: Series, samples: list[Sample], number: int, sign: float) -> tuple[Sample, bool]:
    """The top near one of the samples, and whether the series bends there."""
    best = samples[number]
    frame = round(best.place)
    if number in {0, len(samples) - 1} or not 0 < frame < len(series) - 1:
        return best, False
    before, here, after = series.value[frame - 1 : frame + 2]
    bend = before - 2 * here + after
    if not np.isfinite(bend) or sign * bend >= 0:
        return best, False
    shift = float(np.clip((before - after) / (2 * bend), -0.5, 0.5))
    place = min(max(frame + shift, samples[0].place), samples[-1].place)
    shift = place - frame
    weights = np.zeros(len(series))
    weights[frame - 1 : frame + 2] = (shift * (shift - 1) / 2, 1 - shift**2, shift * (shift + 1) / 2)
    return Sample(place, weights, summed(series.value, weights)), True


def _frames(series: Series, samples: list[Sample]) -> tuple[int, int]:
    """The first and the last frame of a stretch; those that its ends lie between count."""
    low, high = int(np.floor(samples[0].place + _SAME)), int(np.ceil(samples[-1].place - _SAME))
    return max(low, 0), max(min(high, len(series) - 1), 0)


def _roof(series: Series, samples: list[Sample], sign: float) -> float:
    """How large the series (times `sign`) may have been in a stretch where it was not seen; minus infinity if all of it was."""
    low, high = _frames(series, samples)
    seen = series.seen & np.isfinite(series.value)
    if seen[low : high + 1].all():
        return -np.inf
    known = np.flatnonzero(seen)
    values = sign * series.value
    roof = -np.inf
    # Of each frame that was not seen, how many were before it: one number for each stretch without any.
    for place in np.unique(np.searchsorted(known, low + np.flatnonzero(~seen[low : high + 1]))).tolist():
        begin = int(known[place - 1]) if place > 0 else -1
        end = int(known[place]) if place < len(known) else len(series)
        if (end - begin) * series.frame_s > _LONGEST_UNSEEN_S:
            return np.inf
        lines = [_line(values, known, edge, way) for edge, way in ((place - 1, -1), (place, 1))]
        roof = max(roof, _crossing(lines, max(begin, samples[0].place), min(end, samples[-1].place)))
    return roof


def _line(values: Float, known: Counts, edge: int, way: int) -> tuple[float, float]:
    """Height in frame 0 and slope of a straight line through the edge of what was not seen and what was seen beyond; infinite if
    there is too little of that."""
    beyond = edge + _SLOPE_FRAMES * way
    if not (0 <= edge < len(known) and 0 <= beyond < len(known)):
        return np.inf, 0.0
    slope = float((values[known[edge]] - values[known[beyond]]) / (known[edge] - known[beyond]))
    return float(values[known[edge]] - slope * known[edge]), slope


def _crossing(lines: list[tuple[float, float]], first: float, last: float) -> float:
    """The highest place under two straight lines between two frames."""
    (one, one_slope), (other, other_slope) = lines
    places = [first, last]
    if np.isfinite(one - other) and one_slope != other_slope:
        places.append(min(max((other - one) / (one_slope - other_slope), first), last))
    return max(min(one + one_slope * place, other + other_slope * place) for place in places)


def top_sigma_s(series: Series, at: Top) -> float:
    """Standard deviation of the instant at which a series has its top: the slope's over the bend."""
    frame = round(at.place)
    if not 0 < frame < len(series) - 1:
        return series.frame_s
    if not at.bends:
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
