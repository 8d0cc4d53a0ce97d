"""What the footage benchmark computes from joints, keypoints and cameras. Pure, so that each has a closed-form test."""

import numpy as np

from models.arrays import Bool, Float
from models.camera.rig import Rig
from models.skeleton import coco


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


def limb_variation_pct(joints_m: Float) -> dict[str, float]:
    """Standard deviation over mean of each limb's length over time, percent; (frames, 17, 3), NaN frames left out."""
    variation = {}
    for limb, (proximal, distal) in coco.LIMBS.items():
        length = np.linalg.norm(joints_m[:, proximal] - joints_m[:, distal], axis=-1)
        length = length[np.isfinite(length)]
        variation[limb] = float(100 * length.std() / length.mean()) if len(length) > 1 else float("nan")
    return variation


def peak_speed_m_s(positions_m: Float, rate_hz: float, half_span: int = 2) -> float:
    """Largest speed of a point (frames, 3) by a least-squares line over 2 `half_span` + 1 frames.

    A longer span than two frames, so that noise of single frames is not taken for speed.
    """
    offsets = np.arange(-half_span, half_span + 1)
    windows = np.lib.stride_tricks.sliding_window_view(positions_m, len(offsets), axis=0)
    velocity = windows @ offsets / (offsets @ offsets) * rate_hz
    speed = np.linalg.norm(velocity, axis=-1)
    return float(np.nanmax(speed))


def inside(points_px: Float, box_px: Float) -> Bool:
    """Which points (..., 2) lie in a box (x0, y0, x1, y1)."""
    return np.asarray(((points_px >= box_px[:2]) & (points_px <= box_px[2:])).all(axis=-1))
