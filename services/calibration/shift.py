"""One constant 2D offset a camera between footage and its calibration, from the keypoints of a moving person.

Footage that was cropped or scaled after it was calibrated is wrong by the same few pixels everywhere. The offsets s_i and the
points X_p are estimated together: minimise sum_{p,i} w_pi rho(|u_pi - Pi_i(X_p) - s_i|) + lambda sum_i |s_i|^2 with
Geman-McClure rho, by iteratively reweighted Gauss-Newton; the points are eliminated by the Schur complement, so that the
system has only 2 x cameras unknowns. A movement of all offsets together that a movement of the world could nearly explain is
hardly determined by the pictures (the gauge); lambda gives it its smallest norm.

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
        gauge: lambda as a share of what the pictures say about an offset in the mean; on the built-in footage anything from
            0.0001 to 0.1 gives the same residuals.
        scales_px: scales of Geman-McClure, lowered as the solution settles.
        steps: Gauss-Newton steps at each scale.
    """

    score_min: float = 0.3
    gauge: float = 0.02
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
    observed, weights = _seen_by_three(keypoints_px, scores, config)
    if len(observed) < 4 * len(rig):
        raise ValueError(f"only {len(observed)} keypoints are seen by three or more cameras; {4 * len(rig)} are needed")
    shifts = np.zeros((len(rig), 2))
    points = np.zeros((len(observed), 3))
    for number, scale in enumerate(config.scales_px):
        for _ in range(config.steps):
            shifted = rig.with_shifts(shifts)
            flat = _undistorted(shifted, observed)
            if number == 0:
                points = _best_pair(shifted, flat, weights, scale)
            system = _Linearised(shifted, flat, weights, points, scale)
            delta = system.solve_shifts(shifts, config.gauge)
            shifts, points = shifts + delta, points + system.solve_points(delta)
    return shifts


def residuals_px(rig: Rig, keypoints_px: Float, scores: Float, config: ShiftConfig = DEFAULT) -> Float:
    """Distances (n, cameras) in px of the confident keypoints that three cameras see to their robust triangulation.

    Args:
        rig, keypoints_px, scores, config: as in `solve_shifts`; the rig's own shifts count. NaN where a camera saw nothing.
    """
    observed, weights = _seen_by_three(keypoints_px, scores, config)
    flat = _undistorted(rig, observed)
    points = _best_pair(rig, flat, weights, config.scales_px[0])
    still = np.zeros((len(rig), 2))
    for _ in range(2 * config.steps):
        points = points + _Linearised(rig, flat, weights, points, config.scales_px[-1]).solve_points(still)
    residual = flat - np.stack([camera.project_undistorted(points) for camera in rig], axis=1)
    return np.where(weights > 0, np.linalg.norm(residual, axis=2), np.nan)


def _seen_by_three(keypoints_px: Float, scores: Float, config: ShiftConfig) -> tuple[Float, Float]:
    """Pixels (n, cameras, 2) and weights (n, cameras), 0 where not seen, of the keypoints that three cameras or more see."""
    frames, cameras, joints = scores.shape
    observed = np.moveaxis(keypoints_px, 1, 2).reshape(frames * joints, cameras, 2)
    weights = np.moveaxis(scores, 1, 2).reshape(frames * joints, cameras)
    weights = np.where(np.isfinite(observed).all(axis=2) & (weights >= config.score_min), weights, 0.0)
    enough = (weights > 0).sum(axis=1) >= 3
    return observed[enough], weights[enough]


def _undistorted(rig: Rig, observed: Float) -> Float:
    return np.stack([camera.undistort(observed[:, i]) for i, camera in enumerate(rig)], axis=1)


class _Linearised:
    """The problem around a rig and points, as normal equations with the points eliminated."""

    def __init__(self, rig: Rig, flat: Float, weights: Float, points: Float, scale_px: float) -> None:
        residual = flat - np.stack([camera.project_undistorted(points) for camera in rig], axis=1)
        jacobian = np.stack([camera.projection_jacobian(points) for camera in rig], axis=1)  # (points, cameras, 2, 3)
        seen = (weights > 0) & np.isfinite(residual).all(axis=2)
        residual = np.where(seen[..., None], residual, 0.0)
        jacobian = np.where(seen[..., None, None], jacobian, 0.0)
        weight = np.where(seen, weights, 0.0) * (1 + (residual**2).sum(axis=2) / scale_px**2) ** -2
        rows = jacobian.reshape(len(points), -1, 3)  # a row is one coordinate of one camera
        self._right = residual.reshape(len(points), -1)
        self._row_weight = np.repeat(weight, 2, axis=1)
        self._weighted = rows * self._row_weight[..., None]
        # The ridge is a millionth of one camera's usual information (1 / (1 mm / px)^2) and keeps points that nobody sees finite.
        self._inverse = np.linalg.inv(np.einsum("pri,prj->pij", self._weighted, rows) + np.eye(3))
        self._gradient = np.einsum("pri,pr->pi", self._weighted, self._right)

    def solve_shifts(self, shifts: Float, gauge: float) -> Float:
        """Step (cameras, 2) of the offsets, given where they are."""
        weighted, inverse = self._weighted, self._inverse
        reduced = np.diag(self._row_weight.sum(axis=0)) - np.einsum("pri,pij,psj->rs", weighted, inverse, weighted, optimize=True)
        right = (self._row_weight * self._right).sum(axis=0)
        right = right - np.einsum("pri,pij,pj->r", weighted, inverse, self._gradient, optimize=True)
        prior = gauge * float(self._row_weight.sum()) / shifts.size
        delta: Float = np.linalg.solve(reduced + prior * np.eye(shifts.size), right - prior * shifts.ravel())
        return delta.reshape(-1, 2)

    def solve_points(self, delta: Float) -> Float:
        """Step (points, 3) of the points when the offsets move by `delta`."""
        left = self._gradient - np.einsum("pri,r->pi", self._weighted, delta.ravel())
        step: Float = np.einsum("pij,pj->pi", self._inverse, left)
        return step


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
