"""Where a pupil stands and to where he looks, and a motion moved there."""

from dataclasses import dataclass, replace

import numpy as np

from models.arrays import Float
from models.body.pose import Pose
from models.motions import rotations
from models.motions.motion import Motion, Thing


@dataclass(frozen=True)
class Standpoint:
    """A place on the floor and a direction: a frame of reference whose x axis goes where the pupil looks.

    Attributes:
        x_m: and
        y_m: of the pelvis.
        heading_rad: from the world's x axis to the left.
    """

    x_m: float = 0.0
    y_m: float = 0.0
    heading_rad: float = 0.0

    @property
    def turn(self) -> Float:
        """(3, 3) from this frame into the world."""
        return rotations.about(2, np.array(self.heading_rad))

    @property
    def place_m(self) -> Float:
        """(3,) on the floor."""
        return np.array((self.x_m, self.y_m, 0.0))

    def of(self, inner: "Standpoint") -> "Standpoint":
        """In the world, what `inner` is in this frame."""
        x, y, _ = self.place_m + self.turn @ inner.place_m
        return Standpoint(float(x), float(y), self.heading_rad + inner.heading_rad)

    def within(self, outer: "Standpoint") -> "Standpoint":
        """In the frame of `outer`, what this is in the world; headings from half a turn right to half a turn left."""
        x, y, _ = outer.turn.T @ (self.place_m - outer.place_m)
        heading = (self.heading_rad - outer.heading_rad + np.pi) % (2 * np.pi) - np.pi
        return Standpoint(float(x), float(y), float(heading))

    def pose(self, pose: Pose) -> Pose:
        """A pose moved here."""
        turned = pose.rotations_rad.copy()
        turned[0] = rotations.vectors(self.turn @ rotations.matrices(turned[0]))
        return Pose(self.place_m + self.turn @ pose.translation_m, turned)

    def motion(self, motion: Motion) -> Motion:
        """A motion moved here, with what is used in it."""
        turned = motion.rotations_rad.copy()
        turned[:, 0] = rotations.vectors(self.turn @ rotations.matrices(turned[:, 0]))
        return replace(
            motion,
            translations_m=self.place_m + motion.translations_m @ self.turn.T,
            rotations_rad=turned,
            things=tuple(self.thing(thing) for thing in motion.things),
        )

    def thing(self, thing: Thing) -> Thing:
        """A thing moved here."""
        turned = rotations.vectors(self.turn @ rotations.matrices(np.nan_to_num(thing.rotations_rad)))
        there = np.isfinite(thing.translations_m).all(axis=1, keepdims=True)
        return replace(
            thing,
            translations_m=self.place_m + thing.translations_m @ self.turn.T,
            rotations_rad=np.where(there, turned, np.nan),
        )


def standpoint_of(pose: Pose) -> Standpoint:
    """Of somebody upright: below his pelvis, looking where it points."""
    forward = rotations.matrices(pose.rotations_rad[0])[:, 0]
    return Standpoint(float(pose.translation_m[0]), float(pose.translation_m[1]), float(np.arctan2(forward[1], forward[0])))
