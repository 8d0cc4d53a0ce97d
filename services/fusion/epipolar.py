"""How well persons in the pictures of two cameras fit the cameras' epipolar geometry (Hartley and Zisserman, chapter 9)."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations, product

import numpy as np

from models.arrays import Bool, Float
from services.fusion.views import Sighting, Views

_MIN_JOINTS = 6


@dataclass(frozen=True, eq=False)
class Couples:
    """Pairs of persons of whom both cameras show some joints, each in the pixels of its picture.

    Attributes:
        points_px: (n, 2, J, 2) of the first and the second camera.
        usable: (n, J) in both pictures.
        extent_px: (n, 2) diagonals of the boxes around the usable, positive.
    """

    points_px: Float
    usable: Bool
    extent_px: Float

    @classmethod
    def of(cls, first: Sequence[Sighting], second: Sequence[Sighting]) -> "Couples | None":
        """Each person of one picture with each of the other, as far as they can be compared; None if nobody can."""
        points, usables, extents = [], [], []
        for one, two in product(first, second):
            usable = one.usable & two.usable
            if usable.sum() < _MIN_JOINTS:
                continue
            both = np.stack((one.points_px, two.points_px))
            extent = np.hypot(*np.ptp(both[:, usable], axis=1).T)
            if extent.all():
                points.append(both)
                usables.append(usable)
                extents.append(extent)
        return cls(np.stack(points), np.stack(usables), np.stack(extents)) if points else None

    def one(self, index: int) -> "Couples":
        """A couple by itself."""
        only = slice(index, index + 1)
        return Couples(self.points_px[only], self.usable[only], self.extent_px[only])

    def and_then(self, newer: "Couples", most: int) -> "Couples":
        """These and others, of which the last `most`."""
        return Couples(
            np.concatenate((self.points_px, newer.points_px))[-most:],
            np.concatenate((self.usable, newer.usable))[-most:],
            np.concatenate((self.extent_px, newer.extent_px))[-most:],
        )

    def distances(self, fundamental: Float) -> Float:
        """(n,) medians over joints of the larger distance from an epipolar line, as a share of the body's extent in its picture."""
        homogeneous = np.concatenate((self.points_px, np.ones((*self.points_px.shape[:-1], 1))), axis=-1)
        first, second = homogeneous[:, 0], homogeneous[:, 1]
        in_second, in_first = first @ fundamental.T, second @ fundamental
        error = np.abs(np.einsum("nji,nji->nj", second, in_second))
        with np.errstate(divide="ignore", invalid="ignore"):  # an epipole has no line: 0 / 0 counts as far
            shares = [
                error / np.hypot(lines[..., 0], lines[..., 1]) / self.extent_px[:, camera, None]
                for camera, lines in ((1, in_second), (0, in_first))
            ]
        larger = np.maximum(*shares)
        ordered = np.sort(np.where(self.usable & np.isfinite(larger), larger, np.inf), axis=1)
        count, row = self.usable.sum(axis=1), np.arange(len(self.usable))
        medians: Float = 0.5 * (ordered[row, (count - 1) // 2] + ordered[row, count // 2])
        return medians


def fundamentals(views: Views) -> dict[tuple[int, int], Float]:
    """(3, 3) of every two cameras: joints x of the first lie on the line F x of the second (Hartley and Zisserman, 9.2.2)."""
    found = {}
    for first, second in permutations(range(len(views)), 2):
        to_second = views.projections[second]
        ex, ey, ez = to_second @ np.append(views.centres_m[first], 1.0)
        cross = np.array(((0.0, -ez, ey), (ez, 0.0, -ex), (-ey, ex, 0.0)))
        found[first, second] = cross @ to_second @ np.linalg.pinv(views.projections[first])
    return found
