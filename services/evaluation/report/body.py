"""A body of 17 points as parts that can be drawn: capsules for limbs, a trunk, a head. No feet and no hands: nobody saw them."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float, UInt8
from models.messages.feedback import Colour
from models.skeleton import coco

_HEAD: Final = range(5)
_HEAD_QUORUM: Final = 2
"""So many of its points show that a head is as it should be."""
_LEFT_SHOULDER, _RIGHT_SHOULDER, _LEFT_HIP, _RIGHT_HIP = coco.TRUNK
_WIDTHS: Final = {"thigh": 0.125, "shank": 0.095, "upper_arm": 0.085, "forearm": 0.068}
"""Of limbs, as shares of the length from shoulder to ankle."""
TRUNK_WIDTH: Final = 0.12
"""Of the brush that the trunk is painted with."""
HEAD_RADIUS: Final = 0.095


@dataclass(frozen=True, eq=False)
class Capsule:
    """A limb, or half of one.

    Attributes:
        ends_m: (2, 3) the joint, and how far from there the part goes.
        width: as a share of the body's length.
        colour: of the joint.
    """

    ends_m: Float
    width: float
    colour: Colour


@dataclass(frozen=True, eq=False)
class Limb:
    """Two halves that meet in the middle, each of the colour of its own joint."""

    halves: tuple[Capsule, Capsule]

    @property
    def middle_m(self) -> Float:
        """(3,) by which parts are sorted, the nearest last."""
        return np.asarray(self.halves[0].ends_m[1])


@dataclass(frozen=True, eq=False)
class Trunk:
    """Attributes:
    corners_m: (4, 3) left and right shoulder, right and left hip.
    colours: of each of them.
    """

    corners_m: Float
    colours: tuple[Colour, Colour, Colour, Colour]

    @property
    def middle_m(self) -> Float:
        """(3,) as of a limb."""
        return np.asarray(self.corners_m.mean(axis=0))


@dataclass(frozen=True, eq=False)
class Head:
    """Attributes:
    middle_m: (3,) of the head.
    nose_m: (3,) of the nose; NaN where it is not known.
    neck_m: (3,) the middle of the shoulders; NaN where it is not known.
    colour: of its points.
    """

    middle_m: Float
    nose_m: Float
    neck_m: Float
    colour: Colour


Part = Limb | Trunk | Head


def parts_of(joints_m: Float, colours: UInt8) -> Iterator[Part]:
    """Everything that can be drawn of (17, 3) joints, NaN where unknown, of the (17,) `Colour`."""
    known = np.asarray(np.isfinite(joints_m).all(axis=1))
    for name, (near, far) in coco.LIMBS.items():
        if known[near] and known[far]:
            width = _WIDTHS[name.split("_", 1)[1]]
            middle = (joints_m[near] + joints_m[far]) / 2
            first, second = (
                Capsule(np.stack((joints_m[joint], middle)), width, Colour(int(colours[joint]))) for joint in (near, far)
            )
            yield Limb((first, second))
    corners = [_LEFT_SHOULDER, _RIGHT_SHOULDER, _RIGHT_HIP, _LEFT_HIP]
    if known[corners].all():
        left, right, right_hip, left_hip = (Colour(int(colour)) for colour in colours[corners])
        yield Trunk(joints_m[corners], (left, right, right_hip, left_hip))
    face = [joint for joint in _HEAD if known[joint]]
    if face:
        ears = [joint for joint in face if coco.NAMES[joint].endswith("ear")]
        middle = joints_m[ears or face].mean(axis=0)
        neck = (joints_m[_LEFT_SHOULDER] + joints_m[_RIGHT_SHOULDER]) / 2
        yield Head(middle, joints_m[coco.INDEX["nose"]], neck, together(colours[list(_HEAD)]))


def together(colours: UInt8) -> Colour:
    """Of a head, by its points: the worst of them; none if it is good and too few were judged. The same on the tablet's page."""
    judged = colours[colours != Colour.GREY]
    worst = Colour(int(judged.max(initial=Colour.GREY)))
    return worst if worst > Colour.GREEN or len(judged) >= _HEAD_QUORUM else Colour.GREY
