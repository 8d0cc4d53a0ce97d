"""Arms and legs whose ends are given: two bones and a hinge, solved in closed form for many poses at once.

The elbow and the knee are hinges: the elbow turns about z of the T-pose, the knee about y. The joint above (shoulder, hip) turns
freely, and takes what the hinge leaves: the direction from the limb's root to its end, and the side to which the hinge points.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float
from models.motions import rotations
from models.motions.figure import Figure
from models.skeleton import smpl

STRAIGHT_DEG: Final = (12.0, 4.0)
"""A limb that reaches for what is far begins to yield when it is bent by no more than the first, and ends at the second: a joint
that is pulled straight would otherwise turn infinitely fast."""


@dataclass(frozen=True, eq=False)
class Limb:
    """Two bones in the T-pose.

    Attributes:
        root, hinge: indices of the joints.
        upper_m, lower_m: (3,) root to hinge, hinge to end.
        axis: which axis the hinge turns about; 1 or 2.
        sense: 1 if bending is a positive turn, -1 if a negative one.
    """

    root: int
    hinge: int
    upper_m: Float
    lower_m: Float
    axis: int
    sense: int

    @property
    def hinge_axis(self) -> Float:
        """(3,) about which bending is a positive turn, in the T-pose."""
        return np.asarray(self.sense * np.eye(3)[self.axis])

    def span_m(self, bend_rad: Float) -> Float:
        """Distance of the end from the root."""
        end = self.upper_m + rotations.about(self.axis, self.sense * np.asarray(bend_rad)) @ self.lower_m
        return np.asarray(np.linalg.norm(end, axis=-1))

    def bend_rad(self, span_m: Float) -> Float:
        """The bend that gives this distance; of a distance that is out of reach, that of the nearest one."""
        along = self.axis
        flat = np.arange(3) != along
        upper, lower = self.upper_m[flat], self.lower_m[flat]
        fixed = self.upper_m @ self.upper_m + self.lower_m @ self.lower_m + 2 * self.upper_m[along] * self.lower_m[along]
        dot = upper @ lower
        # A turn about y carries z to x, one about z carries x to y.
        cross = float(np.cross(self.lower_m, self.upper_m)[along])
        size = np.hypot(dot, cross)
        cosine = np.clip((np.asarray(span_m) ** 2 - fixed) / (2 * size), -1.0, 1.0)
        return np.asarray(np.arccos(cosine) - self.sense * np.arctan2(-cross, dot))

    def soft_span_m(self, span_m: Float) -> Float:
        """What the limb makes of a wanted distance: the same up to nearly straight, from there on less and less more."""
        soft, longest = self.span_m(np.radians(np.array(STRAIGHT_DEG)))
        room = longest - soft
        over = np.maximum(span_m - soft, 0.0)
        return np.asarray(np.minimum(span_m, soft) + room * np.tanh(over / room))


def limb_of(figure: Figure, side: str, kind: str) -> Limb:
    """The `arm` or the `leg` of a side."""
    names = ("shoulder", "elbow", "wrist") if kind == "arm" else ("hip", "knee", "ankle")
    root, hinge, end = (smpl.INDEX[f"{side}_{name}"] for name in names)
    axis, sense = (1, 1) if kind == "leg" else (2, -1 if side == "left" else 1)
    return Limb(root, hinge, figure.bones_m[hinge], figure.bones_m[end], axis, sense)


def reach(limb: Limb, to_end_m: Float, hinge_axis: Float, soft: bool = True) -> tuple[Float, Float]:
    """Turn a limb so that its end is where it is wanted, or in that direction if it is out of reach.

    Args:
        limb: arm or leg.
        to_end_m: (T, 3) from the root to the wanted end, in the world.
        hinge_axis: (T, 3) about which the hinge turns when it bends, in the world; what of it lies along `to_end_m` is left out.
        soft: yield as `Limb.soft_span_m` does, rather than be pulled straight.

    Returns:
        (T, 3, 3) rotation of the root's segment in the world, (T,) bend of the hinge.
    """
    span = np.linalg.norm(to_end_m, axis=-1)
    bend = limb.bend_rad(limb.soft_span_m(span) if soft else span)
    local_end = limb.upper_m + rotations.through(rotations.about(limb.axis, limb.sense * bend), limb.lower_m)
    local = rotations.frame(local_end, np.broadcast_to(limb.hinge_axis, local_end.shape))
    world = rotations.frame(to_end_m, hinge_axis)
    return world @ local.swapaxes(-1, -2), bend


def hinge_axis_of(to_end_m: Float, pole: Float) -> Float:
    """(T, 3) the axis for `reach` by which the elbow or knee points to `pole` (T, 3)."""
    return np.asarray(np.cross(pole, to_end_m))


def aim(limb: Limb, upper: Float, hinge_axis: Float) -> Float:
    """(T, 3, 3) rotation of the root's segment that lays the first bone along `upper` (T, 3) and lets the hinge turn about what of
    `hinge_axis` (T, 3) is square to it; in the frame of these directions."""
    local = rotations.frame(limb.upper_m, limb.hinge_axis)
    return np.asarray(rotations.frame(upper, hinge_axis) @ local.T)
