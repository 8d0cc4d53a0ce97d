"""Robust triangulation of joints from all views at one instant.

Every pair of views proposes a point; the proposal that all views together object to least is refined by Gauss-Newton with
Geman-McClure weights on residuals in sigmas. A confident distractor thus costs its own view and nothing else, where it would
pull a linear solution (DLT) towards itself.
Sources: Hartley and Zisserman, "Multiple View Geometry", ch. 12; Geman and McClure 1987 for the robust function.
"""

from dataclasses import dataclass

import numpy as np

from models.arrays import Bool, Float, UInt32
from models.compiled import compiled
from services.fusion.config import TriangulationConfig
from services.fusion.views import Views

_MIN_PARALLAX2 = 0.05**2
"""Squared sine of the smallest angle (3 degrees) between rays that can propose a point."""
_SMALLEST_PIVOT = 1e-16
"""Share of its diagonal that a pivot keeps where rounding leaves nothing of it, so that there is always an answer."""


@dataclass(frozen=True, eq=False)
class Triangulated:
    """J joints at one instant.

    Attributes:
        points_m: (J, 3) world; NaN where fewer than two views see the joint.
        covariance_m2: (J, 3, 3) from the inliers' information.
        inliers: (J,) bit i set if camera i agrees.
        count: (J,) inlier views.
    """

    points_m: Float
    covariance_m2: Float
    inliers: UInt32
    count: UInt32


def triangulate(
    views: Views,
    points_px: Float,
    sigma_px: Float,
    usable: Bool,
    config: TriangulationConfig,
    prior_m: Float | None = None,
) -> Triangulated:
    """Triangulate J joints.

    Args:
        views: C cameras.
        points_px: (C, J, 2) undistorted.
        sigma_px: (C, J).
        usable: (C, J).
        config: robustness.
        prior_m: (J, 3) where the joint is expected, NaN where nothing is. It may choose between proposals and pull by
            `config.prior_m`; beyond that its influence fades to nothing.
    """
    if prior_m is None:
        prior_m = np.full((points_px.shape[1], 3), np.nan)
    return Triangulated(
        *triangulate_joints(
            views.projections,
            views.centres_m,
            views.rays,
            points_px,
            sigma_px,
            usable,
            prior_m,
            config.robust_sigmas**2,
            config.inlier_sigmas2,
            config.prior_m,
            config.max_step_m,
            config.iterations,
        )
    )


def objections(
    views: Views, points_px: Float, sigma_px: Float, usable: Bool, config: TriangulationConfig, points_m: Float
) -> Float:
    """By how many views points (J, 3) are objected to: (J,) sums of their Geman-McClure costs, each in [0, 1]; NaN of a NaN."""
    return objections_to(views.projections, points_px, sigma_px, usable, config.robust_sigmas**2, points_m)


@compiled
def _project(projection: Float, point: Float, jacobian: Float) -> tuple[float, float, float]:
    """Pixel and depth of a world point; fills the (2, 3) Jacobian. Depth <= 0 is behind the camera."""
    x, y, z = point[0], point[1], point[2]
    w = projection[2, 0] * x + projection[2, 1] * y + projection[2, 2] * z + projection[2, 3]
    if w <= 1e-6:
        return 0.0, 0.0, w
    u = (projection[0, 0] * x + projection[0, 1] * y + projection[0, 2] * z + projection[0, 3]) / w
    v = (projection[1, 0] * x + projection[1, 1] * y + projection[1, 2] * z + projection[1, 3]) / w
    for k in range(3):
        jacobian[0, k] = (projection[0, k] - u * projection[2, k]) / w
        jacobian[1, k] = (projection[1, k] - v * projection[2, k]) / w
    return u, v, w


@compiled
def _residual2(projection: Float, point: Float, pixel: Float, sigma: float, jacobian: Float) -> float:
    u, v, w = _project(projection, point, jacobian)
    if w <= 1e-6:
        return np.inf
    distance2: float = ((pixel[0] - u) ** 2 + (pixel[1] - v) ** 2) / (sigma * sigma)
    return distance2


@compiled
def _midpoint(centre_a: Float, ray_a: Float, centre_b: Float, ray_b: Float, out: Float) -> bool:
    """The point nearest to two rays; False if they are nearly parallel or meet behind a camera."""
    aa = ray_a[0] * ray_a[0] + ray_a[1] * ray_a[1] + ray_a[2] * ray_a[2]
    bb = ray_b[0] * ray_b[0] + ray_b[1] * ray_b[1] + ray_b[2] * ray_b[2]
    ab = ray_a[0] * ray_b[0] + ray_a[1] * ray_b[1] + ray_a[2] * ray_b[2]
    determinant = aa * bb - ab * ab
    if determinant < _MIN_PARALLAX2 * aa * bb:
        return False
    base_a = base_b = 0.0
    for k in range(3):
        base = centre_b[k] - centre_a[k]
        base_a += base * ray_a[k]
        base_b += base * ray_b[k]
    along_a = (base_a * bb - base_b * ab) / determinant
    along_b = (base_a * ab - base_b * aa) / determinant
    if along_a <= 0.0 or along_b <= 0.0:
        return False
    for k in range(3):
        out[k] = 0.5 * (centre_a[k] + along_a * ray_a[k] + centre_b[k] + along_b * ray_b[k])
    return True


@compiled
def _objection(
    projections: Float,
    pixels: Float,
    sigma: Float,
    usable: Bool,
    point: Float,
    prior: Float,
    scale2: float,
    prior_m: float,
    jacobian: Float,
) -> float:
    """Sum of Geman-McClure costs, each in [0, 1], of all views and the prior."""
    total = 0.0
    for camera in range(projections.shape[0]):
        if usable[camera]:
            r2 = _residual2(projections[camera], point, pixels[camera], sigma[camera], jacobian)
            total += r2 / (r2 + scale2) if r2 < np.inf else 1.0
    if not np.isnan(prior[0]):
        d2 = ((point[0] - prior[0]) ** 2 + (point[1] - prior[1]) ** 2 + (point[2] - prior[2]) ** 2) / (prior_m * prior_m)
        total += d2 / (d2 + 1.0)
    return total


@compiled
def objections_to(projections: Float, pixels: Float, sigma: Float, usable: Bool, scale2: float, points: Float) -> Float:
    """The kernel of `objections`."""
    out, no_prior, jacobian = np.empty(points.shape[0]), np.full(3, np.nan), np.empty((2, 3))
    for j in range(points.shape[0]):
        out[j] = _objection(projections, pixels[:, j], sigma[:, j], usable[:, j], points[j], no_prior, scale2, 1.0, jacobian)
    return out


@compiled
def _propose(
    projections: Float,
    centres: Float,
    directions: Float,
    pixels: Float,
    sigma: Float,
    usable: Bool,
    prior: Float,
    scale2: float,
    prior_m: float,
    best: Float,
) -> bool:
    """Fill `best` with the pairwise point that is objected to least; False if no pair proposes any."""
    cameras = projections.shape[0]
    jacobian, candidate = np.empty((2, 3)), np.empty(3)
    least, found = np.inf, False
    for a in range(cameras):
        if not usable[a]:
            continue
        for b in range(a + 1, cameras):
            if usable[b] and _midpoint(centres[a], directions[a], centres[b], directions[b], candidate):
                cost = _objection(projections, pixels, sigma, usable, candidate, prior, scale2, prior_m, jacobian)
                if cost < least:
                    least, found = cost, True
                    best[:] = candidate
    return found


@compiled
def invert(matrix: Float, inverse: Float) -> None:
    """Fill the inverse of a symmetric positive definite (3, 3) matrix, by its factors L D L^T (Golub and Van Loan, 4.1.2)."""
    first = matrix[0, 0]
    l10, l20 = matrix[1, 0] / first, matrix[2, 0] / first
    second = max(matrix[1, 1] - l10 * matrix[1, 0], _SMALLEST_PIVOT * matrix[1, 1])
    l21 = (matrix[2, 1] - l20 * matrix[1, 0]) / second
    third = max(matrix[2, 2] - l20 * matrix[2, 0] - l21 * l21 * second, _SMALLEST_PIVOT * matrix[2, 2])
    m20 = l10 * l21 - l20  # of the inverse of L, whose other entries are -l10 and -l21
    inverse[0, 0] = 1.0 / first + l10 * l10 / second + m20 * m20 / third
    inverse[1, 1] = 1.0 / second + l21 * l21 / third
    inverse[2, 2] = 1.0 / third
    inverse[0, 1] = inverse[1, 0] = -l10 / second - m20 * l21 / third
    inverse[0, 2] = inverse[2, 0] = m20 / third
    inverse[1, 2] = inverse[2, 1] = -l21 / third


@compiled
def _newton_step(normal: Float, gradient: Float, inverse: Float, step: Float) -> float:
    """Fill the step that solves `normal` x step = gradient; returns its length."""
    invert(normal, inverse)
    for k in range(3):
        step[k] = inverse[k, 0] * gradient[0] + inverse[k, 1] * gradient[1] + inverse[k, 2] * gradient[2]
    length: float = np.sqrt(step[0] ** 2 + step[1] ** 2 + step[2] ** 2)
    return length


@compiled
def _refine(
    projections: Float,
    pixels: Float,
    sigma: Float,
    usable: Bool,
    prior: Float,
    scale2: float,
    prior_m: float,
    max_step: float,
    iterations: int,
    point: Float,
) -> None:
    """Gauss-Newton on the robust cost, in place."""
    jacobian, normal, gradient = np.empty((2, 3)), np.empty((3, 3)), np.empty(3)
    inverse, step = np.empty((3, 3)), np.empty(3)
    for _ in range(iterations):
        normal[:] = 0.0
        gradient[:] = 0.0
        for camera in range(projections.shape[0]):
            if not usable[camera]:
                continue
            u, v, w = _project(projections[camera], point, jacobian)
            if w <= 1e-6:
                continue
            du, dv = pixels[camera, 0] - u, pixels[camera, 1] - v
            r2 = (du * du + dv * dv) / (sigma[camera] * sigma[camera])
            weight = (scale2 / (r2 + scale2)) ** 2 / (sigma[camera] * sigma[camera])
            for k in range(3):
                gradient[k] += weight * (jacobian[0, k] * du + jacobian[1, k] * dv)
                for m in range(3):
                    normal[k, m] += weight * (jacobian[0, k] * jacobian[0, m] + jacobian[1, k] * jacobian[1, m])
        if not np.isnan(prior[0]):
            d2 = ((point[0] - prior[0]) ** 2 + (point[1] - prior[1]) ** 2 + (point[2] - prior[2]) ** 2) / (prior_m * prior_m)
            weight = 1.0 / (1.0 + d2) ** 2 / (prior_m * prior_m)
            for k in range(3):
                gradient[k] += weight * (prior[k] - point[k])
                normal[k, k] += weight
        for k in range(3):
            normal[k, k] += 1e-3
        length = _newton_step(normal, gradient, inverse, step)
        shrink = min(1.0, max_step / max(length, 1e-12))
        for k in range(3):
            point[k] += shrink * step[k]
        if length < 1e-5:
            break


@compiled
def triangulate_joints(
    projections: Float,
    centres: Float,
    rays: Float,
    pixels: Float,
    sigma: Float,
    usable: Bool,
    prior: Float,
    scale2: float,
    inlier2: float,
    prior_m: float,
    max_step: float,
    iterations: int,
) -> tuple[Float, Float, UInt32, UInt32]:
    """The kernel of `triangulate`."""
    cameras, joints = pixels.shape[0], pixels.shape[1]
    points = np.full((joints, 3), np.nan)
    covariance = np.zeros((joints, 3, 3))
    inliers, count = np.zeros(joints, np.uint32), np.zeros(joints, np.uint32)
    directions, jacobian, normal, point = np.empty((cameras, 3)), np.empty((2, 3)), np.empty((3, 3)), np.empty(3)
    for j in range(joints):
        for camera in range(cameras):
            for k in range(3):
                ray = rays[camera, k]
                directions[camera, k] = ray[0] * pixels[camera, j, 0] + ray[1] * pixels[camera, j, 1] + ray[2]
        seen = pixels[:, j], sigma[:, j], usable[:, j]
        if not _propose(projections, centres, directions, *seen, prior[j], scale2, prior_m, point):
            continue
        _refine(projections, *seen, prior[j], scale2, prior_m, max_step, iterations, point)
        normal[:] = 0.0
        for camera in range(cameras):
            if not usable[camera, j]:
                continue
            if _residual2(projections[camera], point, pixels[camera, j], sigma[camera, j], jacobian) <= inlier2:
                inliers[j] |= np.uint32(1 << camera)
                count[j] += np.uint32(1)
                weight = 1.0 / (sigma[camera, j] * sigma[camera, j])
                for k in range(3):
                    for m in range(3):
                        normal[k, m] += weight * (jacobian[0, k] * jacobian[0, m] + jacobian[1, k] * jacobian[1, m])
        for k in range(3):
            normal[k, k] += 1e-3
        points[j] = point
        invert(normal, covariance[j])
    return points, covariance, inliers, count
