"""A pose of the body: where the pelvis is, and how each joint is turned."""

from dataclasses import dataclass

import numpy as np

from models.arrays import Float
from models.skeleton import smpl

PARAMETERS = 3 + 3 * smpl.COUNT
"""Numbers of a pose as a vector: translation, then a rotation vector for each joint."""


@dataclass(frozen=True, eq=False)
class Pose:
    """A pose.

    Attributes:
        translation_m: (3,) position of the pelvis in the world.
        rotations_rad: (24, 3) rotation vector (axis times angle) of each joint against its parent, in the axes of the T-pose (x to
            the front, y to the left, z up); the pelvis' own is against the world.
    """

    translation_m: Float
    rotations_rad: Float

    def __post_init__(self) -> None:
        if self.translation_m.shape != (3,) or self.rotations_rad.shape != (smpl.COUNT, 3):
            raise ValueError(
                f"a pose has translation_m of shape (3,) and rotations_rad of shape ({smpl.COUNT}, 3), "
                f"not {self.translation_m.shape} and {self.rotations_rad.shape}"
            )
        if not (np.isfinite(self.translation_m).all() and np.isfinite(self.rotations_rad).all()):
            raise ValueError("a pose must be finite")

    @property
    def vector(self) -> Float:
        """(75,) translation_m, then rotations_rad row by row: the order of the Jacobians' columns."""
        return np.concatenate((self.translation_m, self.rotations_rad.ravel()))


def t_pose(translation_m: Float | None = None) -> Pose:
    """Upright, arms to the sides, looking along x; the pelvis at the origin or where told."""
    return Pose(np.zeros(3) if translation_m is None else translation_m, np.zeros((smpl.COUNT, 3)))


def from_vector(vector: Float) -> Pose:
    """The pose of a vector as `Pose.vector` gives it."""
    return Pose(vector[:3], vector[3:].reshape(smpl.COUNT, 3))


def mirrored(pose: Pose) -> Pose:
    """The same pose seen in a mirror that stands in the plane y = 0: left does what right did."""
    place, turn = np.array((1.0, -1.0, 1.0)), np.array((-1.0, 1.0, -1.0))
    return Pose(pose.translation_m * place, pose.rotations_rad[list(smpl.MIRROR)] * turn)
