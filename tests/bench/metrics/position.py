"""How far joints are from where they truly are: no alignment, nothing left out in silence."""

from dataclasses import dataclass

import numpy as np

from models.arrays import Bool, Float

MIN_JOINTS = 9
"""A frame with fewer joints than that has no pose."""


@dataclass(frozen=True)
class PositionError:
    """Of one reconstruction.

    Attributes:
        mpjpe_mm: mean distance of all joints about which something is said, visible or not.
        p95_mm: 95th percentile of these distances.
        missing_pct: share of joints, whose truth is known, about which nothing is said.
        without_pose: numbers of the frames with fewer than `MIN_JOINTS` joints (or than have a known truth, if those are fewer);
            what is said in them counts all the same.
        count: joints that the mean is of.
    """

    mpjpe_mm: float
    p95_mm: float
    missing_pct: float
    without_pose: tuple[int, ...]
    count: int


def distances_m(found_m: Float, truth_m: Float) -> Float:
    """(frames, joints) distance of each joint from its truth; NaN where either is unknown."""
    return np.asarray(np.linalg.norm(found_m - truth_m, axis=-1))


def position_error(found_m: Float, truth_m: Float) -> PositionError:
    """Hold joints against the truth, both (frames, joints, 3). With nothing to measure, the error is NaN."""
    distance = distances_m(found_m, truth_m)
    known = np.isfinite(distance)
    asked: Bool = np.asarray(np.isfinite(truth_m).all(axis=-1))
    told_mm = 1e3 * distance[known]
    return PositionError(
        mpjpe_mm=float(told_mm.mean()) if told_mm.size else np.nan,
        p95_mm=float(np.percentile(told_mm, 95)) if told_mm.size else np.nan,
        missing_pct=float(100 * (1 - known.sum() / asked.sum())) if asked.any() else np.nan,
        without_pose=frames_without_pose(known, asked),
        count=int(known.sum()),
    )


def frames_without_pose(known: Bool, asked: Bool) -> tuple[int, ...]:
    """Numbers of the frames with too few known joints; see `PositionError`. Both (frames, joints)."""
    least = np.minimum(MIN_JOINTS, asked.sum(axis=1))
    return tuple(int(frame) for frame in np.flatnonzero(known.sum(axis=1) < least))


def margin_pct(ours: float, theirs: float) -> float:
    """How much smaller our error is, in percent of theirs."""
    return 100 * (1 - ours / theirs)
