"""A camera's lens as renderer and truth use it: a projection that never folds, and where moving points land on rolling rows.

Beyond some radius Brown's polynomial turns back, and would draw what is far outside the field into the picture. So it is used as
far as the picture's corners need it and continued as a straight line from there: what is outside stays outside. Inside the
picture it is `Camera.project`, to the last digit.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from models.arrays import Float
from models.camera.pinhole import Camera
from models.compiled import compiled
from models.errors import UserError

NEAR_M = 0.05
"""What is nearer to a camera's plane than this is not seen."""
FAR_M = 200.0

_WIDEST = 12.0
_STEPS = 24001
_SPARE = 1.02
_ITERATIONS = 12
_CLOSE_ROWS = 1e-3


@dataclass(frozen=True, eq=False)
class Lens:
    """A camera as kernels and shaders take it.

    Attributes:
        camera: the camera.
        limit: tangent of the angle off the axis up to which the polynomial is used.
    """

    camera: Camera
    limit: float

    @cached_property
    def numbers(self) -> Float:
        """(23,) rotation row by row, translation, fx, skew, cx, fy, cy, k1, k2, p1, p2, k3, limit."""
        matrix = self.camera.shifted_matrix_px
        intrinsic = (matrix[0, 0], matrix[0, 1], matrix[0, 2], matrix[1, 1], matrix[1, 2])
        parts = (self.camera.rotation.ravel(), self.camera.translation_m, intrinsic, self.camera.distortion, (self.limit,))
        return np.concatenate([np.asarray(part, np.float64) for part in parts])

    def project(self, points_m: Float) -> Float:
        """World points (..., 3) to pixels (..., 2); NaN nearer than `NEAR_M`."""
        still = np.asarray(points_m, np.float64).reshape(1, -1, 3)
        return land(still, self.numbers, 0.0, 0.0, 2)[0].reshape(*points_m.shape[:-1], 2)


def lens_of(camera: Camera) -> Lens:
    """The lens of a camera.

    Raises:
        UserError: the distortion turns back inside the picture, so that no point of the world is seen in its corners.
    """
    width, height = camera.size_px
    edge = np.array([(x, y) for x in (-0.5, width / 2, width - 0.5) for y in (-0.5, height / 2, height - 0.5)])
    matrix = camera.shifted_matrix_px
    distorted = (edge - matrix[:2, 2]) @ np.linalg.inv(matrix[:2, :2]).T
    k1, k2, p1, p2, k3 = camera.distortion
    radii = np.linspace(0, _WIDEST, _STEPS)
    squared = radii**2
    bent = radii * (1 + squared * (k1 + squared * (k2 + squared * k3)))
    slope = 1 + squared * (3 * k1 + squared * (5 * k2 + squared * 7 * k3))
    turns = int(np.argmax(slope <= 0)) if (slope <= 0).any() else _STEPS
    needed = np.sqrt((distorted**2).sum(-1)).max() * _SPARE
    reaches = bent[:turns] - 3 * np.hypot(p1, p2) * squared[:turns] >= needed
    if not reaches.any():
        raise UserError(
            f"camera '{camera.name}': its distortion {np.round(camera.distortion, 4).tolist()} turns back inside the picture; "
            "calibrate it again or correct the coefficients (k1, k2, p1, p2, k3)"
        )
    return Lens(camera, float(radii[int(np.argmax(reaches))]))


@compiled
def land(course: Float, numbers: Float, start: float, readout: float, height: int) -> tuple[Float, Float, Float]:
    """Where moving points are when the row on which they land is exposed.

    Args:
        course: (K, V, 3) places as polynomials in s, the constant first; see `edge.simulation.picture.course`.
        numbers: (23,) `Lens.numbers`.
        start: s of the picture's middle row.
        readout: s from the first row to the last.
        height: rows of the picture.

    Returns:
        (V, 2) pixels, (V,) depths along the camera's axis in metres, and (V,) the s of the rows; NaN pixels for what is nearer than
        `NEAR_M`.
    """
    degree, count = course.shape[0], course.shape[1]
    pixels = np.empty((count, 2))
    depths = np.empty(count)
    times = np.empty(count)
    local = np.empty(3)
    for vertex in range(count):
        s = start
        for _ in range(_ITERATIONS):
            for axis in range(3):
                local[axis] = numbers[9 + axis]
            for axis in range(3):
                value = course[degree - 1, vertex, axis]
                for term in range(degree - 2, -1, -1):
                    value = value * s + course[term, vertex, axis]
                for row in range(3):
                    local[row] += numbers[3 * row + axis] * value
            depths[vertex] = local[2]
            times[vertex] = s
            if not local[2] >= NEAR_M:
                pixels[vertex, 0] = np.nan
                pixels[vertex, 1] = np.nan
                break
            x, y = local[0] / local[2], local[1] / local[2]
            radius = np.sqrt(x * x + y * y)
            limit = numbers[22]
            beyond = 0.0
            k1, k2, p1, p2, k3 = numbers[17], numbers[18], numbers[19], numbers[20], numbers[21]
            if radius > limit:
                r2 = limit * limit
                beyond = (radius - limit) / limit * (1 + r2 * (3 * k1 + r2 * (5 * k2 + r2 * 7 * k3)))
                x *= limit / radius
                y *= limit / radius
            r2 = x * x + y * y
            radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3)) + beyond
            bent_x = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
            bent_y = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
            pixels[vertex, 0] = numbers[12] * bent_x + numbers[13] * bent_y + numbers[14]
            pixels[vertex, 1] = numbers[15] * bent_y + numbers[16]
            row_at = min(max(pixels[vertex, 1], -0.1 * height), 1.1 * height)
            following = start + readout * (row_at / (height - 1) - 0.5)
            if abs(following - s) <= _CLOSE_ROWS * abs(readout) / height:
                break
            s = following
    return pixels, depths, times
