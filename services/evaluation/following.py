"""Which moment of the standard each frame of an attempt is beside.

Equation 19 lets one frame of an attempt take any number of the standard's: whoever squats half as deep has all deep frames of
the standard taken by his deepest one, and every other frame of his finds the same pose on the standard's way down or up. What is
compared frame by frame must not be passed over so. Here each frame of the attempt has exactly one moment of the standard, moments
never go back, and from one frame to the next there are at most `FASTEST` times as many of them as on average while he moves: a
slope constraint, as Sakoe and Chiba (1978) have it, and like Itakura's ("Minimum prediction residual principle applied to speech
recognition", IEEE Trans. ASSP 23(1), 1975) on the standard's side only, for it is no fault to dwell.

Who dwells takes longer for all of it, and is no slower for that in what he does before and after: frames in which he hardly moves
(`STILL`) have no part in the average.
"""

from typing import Final

import numpy as np

from models.arrays import Float, UInt8
from models.compiled import Counts, compiled
from models.interpolation import between
from models.teaching.standard import FRAME_S

FASTEST: Final = 2
"""A pupil goes through a part of the movement at most so many times as fast as through all of it, both against the standard, and
both where they move."""
STILL: Final = 0.25
"""Who moves no faster than this, as a share of the standard's mean speed, dwells."""
_FINER: Final = 2
"""Moments of the standard a frame of the attempt, at the tempo of the whole."""
_LONGEST_DWELL: Final = 3.0
"""An attempt counts as at most so many times as long as what he moves in it: who hardly moves at all shows no tempo."""
_SPEED_S: Final = 0.1
"""Before and after a frame, over which its speed is taken: errors of single frames are no movement."""


def follow(ours: Float, theirs: Float, frame_s: float = FRAME_S) -> Float:
    """The moments at the least sum of squared distances.

    Args:
        ours: (T, K, 3) at least one frame; NaN is unknown, and counts as `services.evaluation.alignment` says.
        theirs: (S, K, 3) at least one frame, `FRAME_S` apart.
        frame_s: from one frame of ours to the next.

    Returns:
        (T,) frames of theirs, also between two of them, from the first to the last; the first alone if ours is one frame.

    Raises:
        ValueError: a motion has no frame, or they are of different joints.
    """
    if not len(ours) or not len(theirs) or ours.shape[1:] != theirs.shape[1:]:
        raise ValueError(f"a motion of the shape {ours.shape} cannot be followed along one of {theirs.shape}")
    if len(ours) == 1:
        return np.zeros(1)
    last = _FINER * (len(ours) - 1)
    moments = np.arange(last + 1) * (len(theirs) - 1) / last
    most = int(FASTEST * _FINER * dwelling(ours, theirs, frame_s))
    one, other = (np.ascontiguousarray(motion.reshape(len(motion), -1), np.float64) for motion in (ours, between(theirs, moments)))
    return np.asarray(moments[_backwards(_steps(one, other, _FINER, most))])


def dwelling(ours: Float, theirs: Float, frame_s: float = FRAME_S) -> float:
    """How many times as long an attempt is as it were if it dwelt no more than the standard does; 1 if it dwells less.

    Args:
        ours, theirs, frame_s: as in `follow`.
    """
    one, other = _speeds(ours, frame_s), _speeds(theirs, FRAME_S)
    if not np.isfinite(other).any():
        return 1.0
    limit = STILL * float(np.nanmean(other))
    # What nobody saw was no dwelling.
    moves, they_move = (float(np.mean(~(speeds < limit))) for speeds in (one, other))
    return min(max(they_move / moves, 1.0), _LONGEST_DWELL) if moves > 0 else _LONGEST_DWELL


def _speeds(joints_m: Float, frame_s: float) -> Float:
    """(T,) of all known joints in the mean; NaN where none is known before and after a frame."""
    reach = max(round(_SPEED_S / frame_s), 1)
    frames = np.arange(len(joints_m))
    after, before = np.minimum(frames + reach, len(joints_m) - 1), np.maximum(frames - reach, 0)
    moved = np.linalg.norm(joints_m[after] - joints_m[before], axis=2)
    known = np.isfinite(moved)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(known, moved, 0.0).sum(axis=1) / known.sum(axis=1) / (frame_s * (after - before)))


def bridged(joints_m: Float) -> Float:
    """(T, K, 3) joints, and where a frame has none at all those that lie evenly between its neighbours: so that a path cannot pass
    through it for nothing, whatever it passes over. The very same array if there is no such frame, or no other."""
    known = np.isfinite(joints_m).any(axis=(1, 2))
    if known.all() or not known.any():
        return joints_m
    there = np.flatnonzero(known)
    return between(joints_m[there], np.interp(np.arange(len(joints_m)), there, np.arange(len(there))))


@compiled
def _steps(ours: Float, theirs: Float, usual: int, most: int) -> UInt8:
    """(T, M) by how many moments the best way to each cell came from the frame before; of equal ones the usual one."""
    rows, columns, joints = ours.shape[0], theirs.shape[0], ours.shape[1] // 3
    steps = np.zeros((rows, columns), np.uint8)
    before = np.full(columns, np.inf)
    costs = np.full(columns, np.inf)
    for i in range(rows):
        costs[:] = np.inf
        for j in range(max(0, columns - 1 - most * (rows - 1 - i)), min(columns, most * i + 1)):
            best, step = np.inf, usual
            if i == 0:
                best = 0.0
            elif j >= usual:
                best = before[j - usual]
            for ahead in range(min(most, j) + 1 if i > 0 else 0):
                if before[j - ahead] < best:
                    best, step = before[j - ahead], ahead
            apart = 0.0
            for k in range(ours.shape[1]):
                difference = ours[i, k] - theirs[j, k]
                apart += difference * difference
            if np.isnan(apart):
                total, known = 0.0, 0
                for k in range(0, ours.shape[1], 3):
                    x, y, z = ours[i, k] - theirs[j, k], ours[i, k + 1] - theirs[j, k + 1], ours[i, k + 2] - theirs[j, k + 2]
                    squared = x * x + y * y + z * z
                    if not np.isnan(squared):
                        total += squared
                        known += 1
                apart = total * joints / known if known else 0.0
            costs[j] = best + apart
            steps[i, j] = step
        before, costs = costs, before
    return steps


@compiled
def _backwards(steps: UInt8) -> Counts:
    """(T,) the moments, from the last cell back."""
    path = np.empty(steps.shape[0], np.int64)
    j = steps.shape[1] - 1
    for i in range(steps.shape[0] - 1, -1, -1):
        path[i] = j
        if i > 0:
            j -= steps[i, j]
    return path
