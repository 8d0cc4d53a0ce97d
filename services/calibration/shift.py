"""One constant 2D offset a camera between footage and its calibration, from the keypoints of a moving person.

Footage that was cropped or scaled after it was calibrated is wrong by the same few pixels everywhere. The offsets s_i and the
points X_p are estimated together: minimise sum_{p,i} w_pi rho(|u_pi - Pi_i(X_p) - s_i|) + sum_i |s_i|^2 / sigma_s^2 with
Geman-McClure rho, by iteratively reweighted Gauss-Newton; the points are eliminated by the Schur complement, so that the
system has only 2 x cameras unknowns. A common movement of all offsets that a movement of the world could explain is not
determined by the pictures (the gauge); the prior sigma_s gives it its smallest norm.

Source: Triggs et al., "Bundle adjustment - a modern synthesis", 2000 (elimination, gauge); Black and Rangarajan,
"On the unification of line processes", IJCV 1996 (Geman-McClure with a scale that is lowered step by step).
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from models.arrays import Bool, Float
from models.camera.rig import Rig


@dataclass(frozen=True)
class ShiftConfig:
    """How offsets are solved.

    Attributes:
        score_min: keypoints below this confidence are left out.
        prior_px: standard deviation of an offset before anything is seen.
        scales_px: scales of Geman-McClure, lowered as the solution settles.
        steps: Gauss-Newton steps at each scale.
    """

    score_min: float = 0.3
    prior_px: float = 30.0
    scales_px: tuple[float, ...] = (24.0, 12.0, 6.0)
    steps: int = 8


DEFAULT = ShiftConfig()


def solve_shifts(rig: Rig, keypoints_px: Float, scores: Float, config: ShiftConfig = DEFAULT) -> Float:
    """Offsets (cameras, 2) in px to put into the rig with `Rig.with_shifts`; they replace those that it has.

    Args:
        rig: its cameras in the order of the second axis of `keypoints_px`.
        keypoints_px: (frames, cameras, 17, 2) observed pixels of one person, the same instant in all cameras; NaN if unseen.
        scores: (frames, cameras, 17).

    Raises:
        ValueError: too few keypoints are seen in three or more views to determine anything.
    """
    frames, cameras, joints = scores.shape
    observed = np.moveaxis(keypoints_px, 1, 2).reshape(frames * joints, cameras, 2)
    weights = np.moveaxis(scores, 1, 2).reshape(frames * joints, cameras)
    weights = np.where(np.isfinite(observed).all(axis=2) & (weights >= config.score_min), weights, 0.0)
    enough = (weights > 0).sum(axis=1) >= 3
    if enough.sum() < 4 * cameras:
        raise ValueError(f"only {enough.sum()} keypoints are seen by three or more cameras; {4 * cameras} are needed")
    observed, weights = observed[enough], weights[enough]

    shifts = np.zeros((cameras, 2))
    points = np.zeros((len(observed), 3))
    for number, scale in enumerate(config.scales_px):
        for _ in range(config.steps):
            shifted = rig.with_shifts(shifts)
            flat = np.stack([camera.undistort(observed[:, i]) for i, camera in enumerate(shifted)], axis=1)
            if number == 0:
                points = _best_pair(shifted, flat, weights, scale)
            shifts, points = _step(shifted, flat, weights, points, shifts, scale, config.prior_px)
    return shifts


def _step(
    rig: Rig, flat: Float, weights: Float, points: Float, shifts: Float, scale_px: float, prior_px: float
) -> tuple[Float, Float]:
    """One Gauss-Newton step on offsets and points together."""
    residual = flat - np.stack([camera.project_undistorted(points) for camera in rig], axis=1)
    jacobian = np.stack([camera.projection_jacobian(points) for camera in rig], axis=1)  # (points, cameras, 2, 3)
    seen = (weights > 0) & np.isfinite(residual).all(axis=2)
    residual = np.where(seen[..., None], residual, 0.0)
    jacobian = np.where(seen[..., None, None], jacobian, 0.0)
    weight = np.where(seen, weights, 0.0) * (1 + (residual**2).sum(axis=2) / scale_px**2) ** -2

    count, size = len(points), 2 * len(rig)
    row_weight = np.repeat(weight, 2, axis=1)  # (points, 2 cameras)
    rows = jacobian.reshape(count, size, 3)
    right = residual.reshape(count, size)
    weighted = rows * row_weight[..., None]
    information = np.einsum("pri,prj->pij", weighted, rows) + 1e-6 * np.eye(3)
    gradient = np.einsum("pri,pr->pi", weighted, right)
    inverse = np.linalg.inv(information)
    reduced = np.diag(row_weight.sum(axis=0)) - np.einsum("pri,pij,psj->rs", weighted, inverse, weighted)
    reduced_right = (row_weight * right).sum(axis=0) - np.einsum("pri,pij,pj->r", weighted, inverse, gradient)

    # The prior of one keypoint's noise is a pixel or two; in these units an offset's information is 1 / prior_px^2.
    prior = 1.0 / prior_px**2
    delta = np.linalg.solve(reduced + prior * np.eye(size), reduced_right - prior * shifts.ravel())
    moved = np.einsum("pij,pj->pi", inverse, gradient - np.einsum("prj,r->pj", weighted, delta))
    return shifts + delta.reshape(-1, 2), points + moved


def _best_pair(rig: Rig, flat: Float, weights: Float, scale_px: float) -> Float:
    """Points (n, 3), each from the pair of views whose triangulation the other views agree with most (Geman-McClure)."""
    best = np.full(len(flat), np.inf)
    points = np.zeros((len(flat), 3))
    seen = weights > 0
    for pair in combinations(range(len(rig)), 2):
        candidate = _linear(rig, flat, pair)
        squared = np.stack([((flat[:, i] - c.project_undistorted(candidate)) ** 2).sum(axis=1) for i, c in enumerate(rig)], axis=1)
        squared = np.where(np.isfinite(squared), squared, 1e12)
        cost = (weights * squared / (squared + scale_px**2)).sum(axis=1)
        better = seen[:, pair[0]] & seen[:, pair[1]] & (cost < best)
        best, points = _replace(better, best, cost, points, candidate)
    return points


def _replace(where: Bool, best: Float, cost: Float, points: Float, candidate: Float) -> tuple[Float, Float]:
    return np.where(where, cost, best), np.where(where[:, None], candidate, points)


def _linear(rig: Rig, flat: Float, views: tuple[int, ...]) -> Float:
    """Linear least-squares triangulation (n, 3) from some views; Hartley and Zisserman, "Multiple View Geometry", 12.2."""
    rows = []
    for i in views:
        projection = rig.cameras[i].projection
        pixels = np.nan_to_num(flat[:, i])
        rows += [pixels[:, :1] * projection[2] - projection[0], pixels[:, 1:] * projection[2] - projection[1]]
    system = np.stack(rows, axis=1)
    system = system / np.linalg.norm(system[..., :3], axis=2, keepdims=True)
    solution = np.linalg.svd(system)[2][:, -1]
    return solution[:, :3] / np.where(np.abs(solution[:, 3:]) > 1e-12, solution[:, 3:], 1e-12)
