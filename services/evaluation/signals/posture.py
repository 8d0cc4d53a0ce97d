"""Where the joints are, as the formulas of signals ask for them: by name, seen from one side of the body."""

from collections.abc import Callable
from typing import Literal

import numpy as np

from models.arrays import Float
from models.motions.motion import Handed
from models.skeleton import coco

BodySide = Handed
UP = np.array((0.0, 0.0, 1.0))
Formula = Callable[["Posture"], Float]


class Posture:
    """Joints of some frames: places, velocities or accelerations, whichever the formula is of.

    Args:
        joint_m: gives (..., 3) of a COCO point by its index.
        side: the side that a formula's own joints are on.
        stature_m: of the pupil.
        masses: (17,) share of each point in the centre of mass; they sum to 1.
    """

    def __init__(self, joint_m: Callable[[int], Float], side: BodySide, stature_m: float, masses: Float) -> None:
        self._joint_m, self._side, self.stature_m, self._masses = joint_m, side, stature_m, masses

    def joint(self, name: str) -> Float:
        """(..., 3) by its whole name."""
        return self._joint_m(coco.INDEX[name])

    def own(self, part: str) -> Float:
        """(..., 3) of the side that is asked for: "knee", "wrist"."""
        return self.joint(f"{self._side}_{part}")

    def other(self, part: str) -> Float:
        """(..., 3) of the other side."""
        return self.joint(f"{'left' if self._side == 'right' else 'right'}_{part}")

    def middle(self, part: str) -> Float:
        """(..., 3) between left and right."""
        return (self.joint(f"left_{part}") + self.joint(f"right_{part}")) / 2

    def line(self, part: str) -> Float:
        """(..., 3) from the other side's to this side's."""
        return self.own(part) - self.other(part)

    def centre_of_mass(self) -> Float:
        """(..., 3) from the points' shares; a point without a share may be unknown."""
        parts = [share * self._joint_m(index) for index, share in enumerate(self._masses) if share]
        return np.asarray(sum(parts[1:], start=parts[0]))

    def trunk_axes(self) -> tuple[Float, Float, Float]:
        """Unit vectors of the trunk: front, to this side, up along it."""
        up = unit(self.middle("shoulder") - self.middle("hip"))
        across = self.line("shoulder") + self.line("hip")
        out = unit(across - dot(across, up)[..., None] * up)
        return self.front_of(out, up), out, up

    def level_axes(self) -> tuple[Float, Float]:
        """Unit vectors on the level: where hips and shoulders face, and to this side."""
        across = self.line("shoulder") + self.line("hip")
        out = unit(across * (1.0, 1.0, 0.0))
        return self.front_of(out, UP), out

    @property
    def backwards(self) -> float:
        """Sign of a turn, positive to the left seen from above, that takes this side backwards."""
        return 1.0 if self._side == "left" else -1.0

    def front_of(self, out: Float, up: Float) -> Float:
        """(..., 3) where a body faces whose own side is `out` and whose head is `up`."""
        return np.cross(out, up) if self._side == "left" else np.cross(up, out)


def unit(vector: Float) -> Float:
    """Of length 1; NaN for a vector of none."""
    length = np.sqrt(dot(vector, vector))[..., None]
    return np.asarray(vector / np.where(length > 0, length, np.nan))


def dot(first: Float, second: Float) -> Float:
    """Inner product of the last axis."""
    return np.asarray((first * second).sum(axis=-1))


def norm(vector: Float) -> Float:
    """Length of the last axis."""
    return np.asarray(np.sqrt(dot(vector, vector)))


def between_deg(first: Float, second: Float) -> Float:
    """Angle between two vectors, 0 to 180 degrees.

    The angle of equation 18. arccos of the clipped cosine loses half its digits at 0 and 180 degrees, where straight knees and
    elbows are; the arc tangent of sine and cosine loses none and needs no clip (Kahan, "How Futile are Mindless Assessments of
    Roundoff", 2006, section 12).
    """
    return np.asarray(np.degrees(np.arctan2(norm(np.cross(first, second)), dot(first, second))))


def turned_deg(sine: Float, cosine: Float) -> Float:
    """Signed angle within +-180 degrees."""
    return np.asarray(np.degrees(np.arctan2(sine, cosine)))


SideAsked = Literal["lead", "other", "both", "left", "right"]
