"""How far answers are from the truth. Pure, so that each figure has a closed-form test."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from models.arrays import Bool, Float
from tests.bench.metrics.position import position_error
from tests.bench.metrics.steadiness import acceleration_error_mm


@dataclass(frozen=True)
class Score:
    """Of one method on one clip, over the judged frames.

    Attributes:
        mpjpe_mm, p95_mm: mean and 95th percentile of the joints' distances from the truth, where every method says something.
        acc_error_mm: mean norm of the error's second difference, mm a frame squared, over the same joints.
        missing_pct: share of joints about which the method says nothing.
        frames_without_pose: frames in which it says something about fewer than nine joints.
    """

    mpjpe_mm: float
    p95_mm: float
    acc_error_mm: float
    missing_pct: float
    frames_without_pose: int


def score_all(joints_m: Mapping[str, Float], truth_m: Mapping[str, Float]) -> dict[str, Score]:
    """Score methods against one another's coverage, so that nobody gains by leaving out what is hard.

    Args:
        joints_m: by method, (frames, joints, 3), NaN where it says nothing; frame k of all methods is about the same instant.
        truth_m: by method, (frames, joints, 3) the truth at the method's own instants.
    """
    claimed: dict[str, Bool] = {method: np.asarray(np.isfinite(joints).all(axis=-1)) for method, joints in joints_m.items()}
    common = np.asarray(np.stack(list(claimed.values())).all(axis=0))[..., None]
    return {method: _score(joints_m[method], truth_m[method], common) for method in joints_m}


def _score(joints_m: Float, truth_m: Float, common: Bool) -> Score:
    own, shared = position_error(joints_m, truth_m), np.where(common, joints_m, np.nan)
    error = position_error(shared, truth_m)
    return Score(
        mpjpe_mm=error.mpjpe_mm,
        p95_mm=error.p95_mm,
        acc_error_mm=acceleration_error_mm(shared, truth_m),
        missing_pct=own.missing_pct,
        frames_without_pose=len(own.without_pose),
    )
