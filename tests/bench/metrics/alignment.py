"""Error of the pose alone: each frame is first laid upon its truth by the best similarity (PA-MPJPE).

Source: Umeyama, "Least-Squares Estimation of Transformation Parameters Between Two Point Patterns", TPAMI 1991; reflections are
excluded, as a person in a mirror is another pose.
"""

import numpy as np

from models.arrays import Float

MIN_POINTS = 4
"""Three points can be laid upon any three others but for the lengths of their sides."""


def aligned(found_m: Float, truth_m: Float) -> Float:
    """One frame (n, 3) after the rotation, scale and shift that bring it nearest to its truth (n, 3), by least squares.

    Joints that are unknown in either take no part; NaN everywhere if fewer than `MIN_POINTS` are left.
    """
    known = np.isfinite(found_m).all(axis=-1) & np.isfinite(truth_m).all(axis=-1)
    if known.sum() < MIN_POINTS:
        return np.full_like(found_m, np.nan)
    middle, target = found_m[known].mean(axis=0), truth_m[known].mean(axis=0)
    own, other = found_m[known] - middle, truth_m[known] - target
    left, singular, right = np.linalg.svd(other.T @ own)
    upright = np.array((1.0, 1.0, np.sign(np.linalg.det(left @ right)) or 1.0))
    size = np.sum(own**2)
    scale = np.sum(singular * upright) / size if size > 0 else 1.0
    rotation = (left * upright) @ right
    result: Float = scale * (found_m - middle) @ rotation.T + target
    return result


def pampjpe_mm(found_m: Float, truth_m: Float) -> float:
    """Mean distance over all joints of all frames (frames, joints, 3) after `aligned`; NaN if no frame can be aligned."""
    errors = [np.linalg.norm(aligned(f, t) - t, axis=-1) for f, t in zip(found_m, truth_m, strict=True)]
    flat = np.concatenate(errors) if errors else np.empty(0)
    flat = flat[np.isfinite(flat)]
    return float(1e3 * flat.mean()) if flat.size else np.nan
