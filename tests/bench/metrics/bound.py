"""The Cramer-Rao bound of triangulation: no unbiased estimate from one frame's keypoints alone errs less.

Of a point that cameras c see with independent Gaussian noise of sigma_c in each pixel axis, the information is the sum over c of
J_c^T J_c / sigma_c^2, J_c being the derivative of the camera's undistorted projection at the true point; the bound of the root mean
square error is the root of the trace of its inverse. It is a bound a frame, without any prior: not for an estimate that also
knows the frames before and after, the limbs' lengths or the noise's heavy tails, which may lie below it.
"""

import numpy as np

from models.arrays import Bool, Float
from models.camera.rig import Rig


def triangulation_bound_m(rig: Rig, points_m: Float, sigma_px: Float, seen: Bool) -> Float:
    """Root mean square error that cannot be undercut.

    Args:
        rig: C cameras.
        points_m: (..., 3) true points.
        sigma_px: (..., C) standard deviation of the keypoints in each pixel axis, after undistortion.
        seen: (..., C) which cameras have a keypoint.

    Returns:
        (...) metres; NaN where fewer than two cameras see the point, or all of them along one line.
    """
    slopes = np.stack([camera.projection_jacobian(points_m) for camera in rig], axis=-3)
    weight = np.where(seen, 1 / np.square(sigma_px), 0.0)[..., None, None]
    information = (weight * slopes.swapaxes(-1, -2) @ slopes).sum(axis=-3)
    usable = (seen.sum(axis=-1) >= 2) & np.isfinite(information).all(axis=(-1, -2))
    information = np.where(usable[..., None, None], information, np.eye(3))
    eigenvalues = np.linalg.eigvalsh(information)
    usable &= eigenvalues[..., 0] > 1e-9 * eigenvalues[..., -1]
    variance = (1 / np.where(usable[..., None], eigenvalues, 1.0)).sum(axis=-1)
    return np.where(usable, np.sqrt(variance), np.nan)


def sigma_of_distances(distance_px: Float) -> float:
    """Sigma in each axis of a two-dimensional Gaussian of which half lies within the median of these distances; NaN without any.

    By the median, so that outliers do not make the bound easy to reach.
    """
    finite = distance_px[np.isfinite(distance_px)]
    return float(np.median(finite) / np.sqrt(2 * np.log(2))) if finite.size else np.nan
