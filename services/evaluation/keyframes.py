"""The four keyframes of an attempt: carried over from performances of the standard, then put where the motion itself says.

Energy alone (`services.evaluation.energy`, equation 17) tells that something happened, not what. What a keyframe is, a standard and
its exemplars show. Each of them is aligned with the attempt (equation 19), which carries its keyframes over, to a few frames: along
a warping path any frame of a stand is as good as another. Then the stretch of the performance around the keyframe is laid over the
attempt anew, shifted as a whole at the attempt's tempo, and stays where it fits best. Of what all performances say the median is
taken, each weighed by how well it fits.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np

from models.arrays import Float
from models.interpolation import between
from models.teaching.standard import FRAME_S, Exemplar, Standard
from services.evaluation.alignment import warp
from services.evaluation.attempt import FoundAttempt
from services.evaluation.features import JOINTS
from services.evaluation.following import bridged
from services.evaluation.normalise import Placing, PlacingError, lead_right, placed, placing_of, size_m
from services.evaluation.track import Track

BEFORE_S: Final = 0.4
AFTER_S: Final = 0.37
"""Keyframes are looked for in so much more of the motion before and after an attempt."""
_BAND: Final = 0.35
_WINDOWS_S: Final = ((-0.15, 0.3), (-0.2, 0.2), (-0.2, 0.2), (-0.47, 0.14))
"""The stretch around each keyframe that is laid over the attempt: of the start and the end mostly what is inside."""
_SHIFT_S: Final = 0.2
"""How far it may be shifted at most."""
_PER_FRAME: Final = 2
"""Shifts that are tried a frame; between them, and where they are best, by a parabola."""
_TEMPO: Final = (0.7, 1.4)
_LEAST_KNOWN: Final = 0.5
"""Share of a stretch's joints that must be known."""
_APART_S: Final = 0.034
"""Keyframes follow one another, a frame apart at least."""


@dataclass(frozen=True, eq=False)
class _Model:
    """A performance of the standard, prepared.

    Attributes:
        joints_m: (S, K, 3) in the canonical frame, the middle of the hips above the origin.
        frames: (4,) its keyframes.
        size_m: of the body.
    """

    joints_m: Float
    frames: Float
    size_m: float


def refine(track: Track, found: FoundAttempt, standards: Sequence[Standard]) -> FoundAttempt:
    """Put the keyframes of an attempt where they are.

    Args:
        track: the attempt, with `BEFORE_S` before it and `AFTER_S` after it as far as they are there.
        found: roughly where it is.
        standards: of all actions; those of the attempt's action count.

    Returns:
        The attempt as it was found if no standard shows its action, or the track does not show the pupil.
    """
    if len(track) < 2:
        return found
    side = lead_right(track, found.handed)
    first, last = found.moments_s[0] - BEFORE_S, found.moments_s[-1] + AFTER_S
    begin = min(max(int(np.ceil(track.frame_at(first) - 1e-6)), 0), len(track) - 2)
    end = max(int(np.floor(track.frame_at(last) + 1e-6)) + 1, begin + 2)
    part = side.part(begin, end)
    frames = keyframes_of(part.joints_m, track.frame_s, standards, found.action)
    if frames is None:
        return found
    start, exertion, peak, stop = (float(part.t_s[0] + frame * track.frame_s) for frame in frames)
    return FoundAttempt(found.action, found.handed, (start, exertion, peak, stop))


def keyframes_of(joints_m: Float, frame_s: float, standards: Sequence[Standard], action: str) -> Float | None:
    """(4,) frames of the keyframes of an attempt, (T, 17, 3) joints in the world of a pupil who leads with the right; None if they
    show nowhere how large he is or to where he looks, are fewer than `room_for` says, or no standard shows the action."""
    said = [
        carried
        for standard in standards
        if standard.action == action
        for model in _models(standard)
        if (carried := _carried(joints_m, frame_s, model)) is not None
    ]
    if not said:
        return None
    frames, weights = np.array([one[0] for one in said]), np.array([one[1] for one in said])
    together = np.array([_weighted_median(*pair) for pair in zip(frames.T, weights.T, strict=True)])
    return in_order(together, len(joints_m), frame_s) if len(joints_m) >= room_for(frame_s) else None


def room_for(frame_s: float) -> int:
    """So many frames it takes for the keyframes to follow one another."""
    return math.ceil(3 * _APART_S / frame_s) + 1


def in_order(frames: Float, count: int, frame_s: float) -> Float:
    """(4,) keyframes within an attempt's `count` frames, which are at least `room_for`, each after the one before it."""
    apart = _APART_S / frame_s
    order = apart * np.arange(4)
    # Each no sooner than the ones before it allow, and then no later than those after it do.
    soonest = np.maximum.accumulate(np.maximum(frames, 0.0) - order) + order
    return np.asarray(np.minimum(soonest, count - 1.0 - order[::-1]))


def _placing(joints_m: Float, frame_s: float, to_size_m: float) -> Placing | None:
    """Roughly: an attempt whose beginning was hidden is timed like any other."""
    try:
        return placing_of(joints_m, frame_s, to_size_m, math.inf)
    except PlacingError:
        return None


def _carried(joints_m: Float, frame_s: float, model: _Model) -> tuple[Float, Float] | None:
    """(4,) keyframes of a performance in an attempt, and (4,) what they weigh."""
    placing = _placing(joints_m, frame_s, model.size_m)
    if placing is None:
        return None
    ours = placed(joints_m, placing)[:, JOINTS]
    radius = int(np.ceil(_BAND * max(len(ours), len(model.joints_m))))
    alignment = warp(bridged(ours), bridged(model.joints_m), radius)
    frames = np.array([alignment.onto(frame) for frame in model.frames])
    slowness = (frames[-1] - frames[0]) / (model.frames[-1] - model.frames[0])
    pace = float(np.clip(slowness * frame_s / FRAME_S, *_TEMPO)) * FRAME_S / frame_s
    weights = np.empty(4)
    for number, window_s in enumerate(_WINDOWS_S):
        shift, misfit = _laid_over(ours, frames[number], model, number, window_s, pace, round(_SHIFT_S / frame_s))
        frames[number] += shift
        weights[number] = 1.0 / (misfit + _SMALL_M2)
    return frames, weights


_SMALL_M2: Final = 1e-4
"""Misfits below this, per joint, are of noise."""


def _laid_over(
    ours: Float, at: float, model: _Model, number: int, window_s: tuple[float, float], pace: float, farthest: int
) -> tuple[float, float]:
    """By how many frames to shift keyframe `number`, carried over to frame `at`, and the mean square of what remains a joint."""
    steps = np.arange(round(window_s[0] / FRAME_S), round(window_s[1] / FRAME_S) + 1)
    theirs = between(model.joints_m, model.frames[number] + steps)
    shifts = np.arange(-farthest * _PER_FRAME, farthest * _PER_FRAME + 1) / _PER_FRAME
    shown = between(ours, at + shifts[:, None] + pace * steps)
    apart = shown - theirs
    known = np.isfinite(apart)
    counts = known.sum(axis=1)
    sums = np.where(known, apart, 0.0)
    # Where a joint is on the whole is of its owner's build; how it moves is what is laid over.
    means = sums.sum(axis=1) / np.maximum(counts, 1)
    squared = np.where(known, (apart - means[:, None]) ** 2, 0.0).sum(axis=(1, 2, 3))
    total = counts.sum(axis=(1, 2))
    misfit = np.where(total >= _LEAST_KNOWN * known[0].size, 3 * squared / np.maximum(total, 1), np.inf)
    best = int(np.argmin(misfit))
    if not np.isfinite(misfit[best]):
        return 0.0, 1.0
    shift = float(shifts[best])
    if 0 < best < len(shifts) - 1 and np.isfinite(misfit[best - 1 : best + 2]).all():
        before, here, after = misfit[best - 1 : best + 2]
        bend = before - 2 * here + after
        shift += float((before - after) / (2 * bend) / _PER_FRAME) if bend > 0 else 0.0
    return shift, float(misfit[best])


def _weighted_median(values: Float, weights: Float) -> float:
    """Where half of the weight is below; between values it goes evenly."""
    order = np.argsort(values)
    share = np.cumsum(weights[order]) - weights[order] / 2
    return float(np.interp(weights.sum() / 2, share, values[order]))


@lru_cache(maxsize=64)
def _models(standard: Standard) -> tuple[_Model, ...]:
    """The performances of a standard that show a body."""
    models = (_model(one) for one in (standard.performance, *standard.exemplars))
    return tuple(model for model in models if model is not None)


def _model(exemplar: Exemplar) -> _Model | None:
    size = size_m(exemplar.joints_m)
    placing = _placing(exemplar.joints_m, FRAME_S, size)
    if placing is None:
        return None
    joints = placed(exemplar.joints_m, placing)[:, JOINTS]
    return _Model(joints, np.array(exemplar.moments_s) / FRAME_S, size)
