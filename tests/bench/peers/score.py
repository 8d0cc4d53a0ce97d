"""How far answers are from the truth. Pure, so that each figure has a closed-form test."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from models.arrays import Bool, Float


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


MIN_JOINTS = 9


def score_all(joints_m: Mapping[str, Float], truth_m: Mapping[str, Float]) -> dict[str, Score]:
    """Score methods against one another's coverage, so that nobody gains by leaving out what is hard.

    Args:
        joints_m: by method, (frames, joints, 3), NaN where it says nothing; frame k of all methods is about the same instant.
        truth_m: by method, (frames, joints, 3) the truth at the method's own instants.
    """
    claimed: dict[str, Bool] = {method: np.asarray(np.isfinite(joints).all(axis=-1)) for method, joints in joints_m.items()}
    common = np.stack(list(claimed.values())).all(axis=0)
    return {method: _score(joints_m[method] - truth_m[method], claimed[method], np.asarray(common)) for method in joints_m}


def _score(error_m: Float, claimed: Bool, common: Bool) -> Score:
    distance = 1e3 * np.linalg.norm(error_m, axis=-1)[common]
    lasting = common[2:] & common[1:-1] & common[:-2]
    acceleration = 1e3 * np.linalg.norm(np.diff(error_m, n=2, axis=0), axis=-1)[lasting]
    return Score(
        mpjpe_mm=float(distance.mean()),
        p95_mm=float(np.percentile(distance, 95)),
        acc_error_mm=float(acceleration.mean()),
        missing_pct=float(100 * (~claimed).mean()),
        frames_without_pose=int((claimed.sum(axis=1) < MIN_JOINTS).sum()),
    )


def margin_pct(ours: float, theirs: float) -> float:
    """How much smaller our error is, in percent of theirs."""
    return 100 * (1 - ours / theirs)
