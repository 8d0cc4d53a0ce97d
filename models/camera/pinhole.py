"""Pinhole camera with Brown-Conrady distortion: projection, its Jacobian, and undistortion.

Source: Brown 1966; OpenCV's `calib3d` documentation for the order of the coefficients (k1, k2, p1, p2, k3).
"""

from dataclasses import dataclass

import numpy as np

from models.arrays import Float
from models.errors import UserError

_UNDISTORT_ITERATIONS = 12
_ROTATION_TOLERANCE = 1e-5
MAX_DISTANCE_M = 1000.0


@dataclass(frozen=True, eq=False)
class Camera:
    """One calibrated camera.

    Attributes:
        name: identity on the bus and in the site file.
        size_px: (width, height) of its images.
        matrix_px: (3, 3) intrinsic matrix K; `shift_px` is not contained in it.
        distortion: (5,) k1, k2, p1, p2, k3.
        rotation: (3, 3) world to camera.
        translation_m: (3,) world to camera.
        shift_px: (2,) constant offset of this camera's pictures against its calibration (footage cut after it was
            calibrated); a point that the calibration puts at u appears at u + shift_px.
    """

    name: str
    size_px: tuple[int, int]
    matrix_px: Float
    distortion: Float
    rotation: Float
    translation_m: Float
    shift_px: Float

    def __post_init__(self) -> None:
        where = f"camera '{self.name}'"
        _require_shape(where, "matrix_px", self.matrix_px, (3, 3))
        _require_shape(where, "distortion", self.distortion, (5,))
        _require_shape(where, "rotation", self.rotation, (3, 3))
        _require_shape(where, "translation_m", self.translation_m, (3,))
        _require_shape(where, "shift_px", self.shift_px, (2,))
        if self.size_px[0] < 16 or self.size_px[1] < 16:
            raise UserError(f"{where}: size_px {list(self.size_px)} is no picture; give [width, height] in pixels")
        if not (self.matrix_px[0, 0] > 0 and self.matrix_px[1, 1] > 0):
            raise UserError(f"{where}: focal lengths must be positive; check matrix_px[0][0] and matrix_px[1][1]")
        if not np.array_equal(self.matrix_px[2], (0.0, 0.0, 1.0)) or self.matrix_px[1, 0] != 0:
            raise UserError(f"{where}: matrix_px must be [[fx, s, cx], [0, fy, cy], [0, 0, 1]]")
        if np.abs(self.translation_m).max() > MAX_DISTANCE_M:
            raise UserError(f"{where}: translation_m is more than {MAX_DISTANCE_M:g} m; are its units metres?")
        if np.abs(self.shift_px).max() > max(self.size_px):
            raise UserError(f"{where}: shift_px is larger than the picture; calibrate this camera again")
        error = float(np.abs(self.rotation @ self.rotation.T - np.eye(3)).max())
        determinant = float(np.linalg.det(self.rotation))
        if error > _ROTATION_TOLERANCE or determinant < 0:
            raise UserError(
                f"{where}: rotation is not a rotation matrix (R R^T differs from 1 by {error:.1e}, det {determinant:+.3f}, "
                "needed +1); calibrate this camera again or correct the file"
            )

    @property
    def centre_m(self) -> Float:
        """(3,) position of the camera in the world."""
        return -self.rotation.T @ self.translation_m

    @property
    def projection(self) -> Float:
        """(3, 4) matrix K' [R | t] onto undistorted pixels, K' being K with the principal point moved by `shift_px`."""
        return self.shifted_matrix_px @ np.column_stack((self.rotation, self.translation_m))

    @property
    def shifted_matrix_px(self) -> Float:
        """(3, 3) K with the principal point moved by `shift_px`."""
        matrix = self.matrix_px.copy()
        matrix[:2, 2] += self.shift_px
        return matrix

    def to_camera(self, points_m: Float) -> Float:
        """World points (..., 3) in metres to this camera's frame (..., 3)."""
        return points_m @ self.rotation.T + self.translation_m

    def project(self, points_m: Float) -> Float:
        """World points (..., 3) in metres to distorted image pixels (..., 2); NaN behind the camera."""
        local = self.to_camera(np.asarray(points_m, dtype=np.float64))
        depth = np.where(local[..., 2:] > 1e-9, local[..., 2:], np.nan)
        return self._to_pixels(_distort(local[..., :2] / depth, self.distortion))

    def project_undistorted(self, points_m: Float) -> Float:
        """As `project`, without lens distortion: the plane in which `undistort` puts observed points."""
        local = self.to_camera(np.asarray(points_m, dtype=np.float64))
        depth = np.where(local[..., 2:] > 1e-9, local[..., 2:], np.nan)
        return self._to_pixels(local[..., :2] / depth)

    def projection_jacobian(self, points_m: Float) -> Float:
        """Derivative (..., 2, 3) in px/m of `project_undistorted` at world points (..., 3)."""
        local = self.to_camera(np.asarray(points_m, dtype=np.float64))
        x, y, z = local[..., 0], local[..., 1], local[..., 2]
        zero = np.zeros_like(z)
        d_local = np.stack((np.stack((1 / z, zero, -x / z**2), axis=-1), np.stack((zero, 1 / z, -y / z**2), axis=-1)), axis=-2)
        return self.matrix_px[:2, :2] @ d_local @ self.rotation

    def undistort(self, points_px: Float) -> Float:
        """Observed pixels (..., 2) to the pixels that a lens without distortion would show (..., 2).

        Fixed-point iteration on the normalised coordinates; NaN stays NaN.
        """
        target = self._to_normalised(np.asarray(points_px, dtype=np.float64))
        if not self.distortion.any():
            return self._to_pixels(target)
        guess = target.copy()
        for _ in range(_UNDISTORT_ITERATIONS):
            guess += target - _distort(guess, self.distortion)
        return self._to_pixels(guess)

    def _to_pixels(self, normalised: Float) -> Float:
        return normalised @ self.matrix_px[:2, :2].T + self.matrix_px[:2, 2] + self.shift_px

    def _to_normalised(self, points_px: Float) -> Float:
        return (points_px - self.matrix_px[:2, 2] - self.shift_px) @ np.linalg.inv(self.matrix_px[:2, :2]).T


def _distort(normalised: Float, coefficients: Float) -> Float:
    k1, k2, p1, p2, k3 = coefficients
    x, y = normalised[..., 0], normalised[..., 1]
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    return np.stack(
        (
            x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
            y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
        ),
        axis=-1,
    )


def _require_shape(where: str, field: str, value: Float, shape: tuple[int, ...]) -> None:
    if value.shape != shape:
        raise UserError(f"{where}: {field} must have the shape {shape}, not {value.shape}")
    if not np.isfinite(value).all():
        raise UserError(f"{where}: {field} contains a value that is not a finite number")
