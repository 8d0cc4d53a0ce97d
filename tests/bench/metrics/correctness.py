"""Shares of what is right within a tolerance: PCK, the area under its curve, and PCP. What is missing is wrong.

Sources: PCK in 3D and its area, Mehta et al., "Monocular 3D Human Pose Estimation In The Wild", 3DV 2017; PCP-3D, Belagiannis et
al., "3D Pictorial Structures for Multiple Human Pose Estimation", CVPR 2014.
"""

from typing import Any

import numpy as np
import numpy.typing as npt

from models.arrays import Bool, Float

PCP_ALPHA = 0.5


def pck_pct(distance: Float, within: float) -> float:
    """Percent of distances, in any shape and unit, that are at most `within`; NaN counts as wrong."""
    return float(100 * (distance <= within).mean()) if distance.size else np.nan


def pck_auc_pct(distance: Float, limit: float) -> float:
    """Mean of `pck_pct` over all tolerances from 0 to `limit`: the exact area, not one of sampled tolerances."""
    share = np.where(np.isfinite(distance), np.clip(1 - distance / limit, 0, 1), 0.0)
    return float(100 * share.mean()) if share.size else np.nan


def right_parts(found_m: Float, truth_m: Float, ends: npt.NDArray[np.integer[Any]], alpha: float = PCP_ALPHA) -> Bool:
    """Which parts of a body are right: the mean distance of a part's two ends is at most `alpha` times its true length.

    Args:
        found_m, truth_m: (..., joints, 3).
        ends: (parts, 2) joints at the ends of each part.
        alpha: share of the part's length.

    Returns:
        (..., parts)
    """
    distance = np.linalg.norm(found_m - truth_m, axis=-1)
    length = np.linalg.norm(truth_m[..., ends[:, 0], :] - truth_m[..., ends[:, 1], :], axis=-1)
    right: Bool = distance[..., ends].mean(axis=-1) <= alpha * length
    return right
