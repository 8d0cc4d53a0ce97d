"""How well joints in space explain what the cameras saw."""

import numpy as np

from models.arrays import Float
from models.camera.rig import Rig


def reprojection_px(rig: Rig, joints_m: Float, points_px: Float, scores: Float, *, min_score: float) -> Float:
    """Distances in pixels between observed keypoints and projected joints.

    Args:
        rig: calibration in the resolution of the keypoints.
        joints_m: (frames, 17, 3), NaN where there is none.
        points_px: (frames, cameras, 17, 2) keypoints as observed.
        scores: (frames, cameras, 17).
        min_score: keypoints below are left out.

    Returns:
        (frames, cameras, 17); NaN where a joint or a keypoint is missing or its score too low.
    """
    projected = np.stack([camera.project(joints_m) for camera in rig], axis=1)
    distance: Float = np.linalg.norm(projected - points_px, axis=-1)
    distance[~(scores >= min_score)] = np.nan
    return distance


def rmse(distance: Float) -> float:
    """Root of the mean square of the finite distances, in their unit; NaN without any."""
    finite = distance[np.isfinite(distance)]
    return float(np.sqrt(np.mean(finite**2))) if finite.size else np.nan
