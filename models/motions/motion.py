"""A motion: the poses of one body over time, with what is known about it by construction."""

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from models.arrays import Bool, Float
from models.body.pose import Pose
from models.motions import rotations
from models.skeleton import smpl

RATE_HZ: Final = 240.0
"""Poses a second. Between them a turn is the shortest one: at this rate that is within half a millimetre also in a throw."""

Handed = Literal["right", "left"]

CONTACTS: Final = ("left_foot", "right_foot", "left_hand", "right_hand", "trunk")
"""What can bear on the floor or a mat, in the order of `Motion.contacts`."""

ThingKind = Literal["basketball", "volleyball", "football", "shuttlecock", "racket"]


@dataclass(frozen=True)
class Attempt:
    """One try at an action. Times are seconds from the motion's beginning.

    Attributes:
        action: name of the action.
        handed: the side that leads.
        start_s: the first movement that belongs to it.
        exertion_s: the main effort begins (shot: legs and arm begin to extend; jump: the push-off).
        peak_s: the decisive moment (shot: release; jump: highest point; roll: the back on the mat; kick, spike, clear: the hit).
        end_s: stands again, or has landed and is still.
        faults: names and severities (1: as a teacher would call it) of what is done wrong.
    """

    action: str
    handed: Handed
    start_s: float
    exertion_s: float
    peak_s: float
    end_s: float
    faults: tuple[tuple[str, float], ...] = ()

    def __post_init__(self) -> None:
        if not 0 <= self.start_s < self.exertion_s < self.peak_s < self.end_s:
            raise ValueError(f"the moments of a {self.action} must follow one another: {self}")


@dataclass(frozen=True, eq=False)
class Thing:
    """Something that moves with the pupil or from him: a ball, a racket.

    Attributes:
        kind: what it is; sizes and frames stand in `models.motions.things`.
        translations_m: (T, 3) of its origin in the world, at the motion's poses; NaN while it is not there.
        rotations_rad: (T, 3) rotation vectors from its frame into the world.
    """

    kind: ThingKind
    translations_m: Float
    rotations_rad: Float


@dataclass(frozen=True, eq=False)
class Motion:
    """Poses at `RATE_HZ`, the first at time zero.

    Attributes:
        translations_m: (T, 3) of the pelvis in the world.
        rotations_rad: (T, 24, 3) rotation vectors as in `models.body.pose.Pose`.
        contacts: (T, 5) what bears, in the order of `CONTACTS`.
        attempts: in their order in time, none overlapping.
        things: what is used.
    """

    translations_m: Float
    rotations_rad: Float
    contacts: Bool
    attempts: tuple[Attempt, ...] = ()
    things: tuple[Thing, ...] = ()

    def __post_init__(self) -> None:
        count = len(self.translations_m)
        shapes = {"translations_m": (count, 3), "rotations_rad": (count, smpl.COUNT, 3), "contacts": (count, len(CONTACTS))}
        for name, shape in shapes.items():
            if getattr(self, name).shape != shape:
                raise ValueError(f"{name} of a motion with {count} poses has the shape {shape}, not {getattr(self, name).shape}")
        if count < 2 or not (np.isfinite(self.translations_m).all() and np.isfinite(self.rotations_rad).all()):
            raise ValueError("a motion has at least two poses, and all of them are finite")

    @property
    def duration_s(self) -> float:
        """From the first pose to the last."""
        return (len(self.translations_m) - 1) / RATE_HZ

    @property
    def times_s(self) -> Float:
        """(T,) of the poses."""
        return np.arange(len(self.translations_m)) / RATE_HZ

    def pose_at(self, t_s: float) -> Pose:
        """The pose at any time from 0 to `duration_s`: cubic places, shortest turns between samples.

        Raises:
            ValueError: the time is outside.
        """
        if not 0 <= t_s <= self.duration_s:
            raise ValueError(f"the motion has poses from 0 to {self.duration_s:g} s, none at {t_s:g} s")
        first = min(int(t_s * RATE_HZ), len(self.translations_m) - 2)
        share = t_s * RATE_HZ - first
        start, end = rotations.matrices(self.rotations_rad[first]), rotations.matrices(self.rotations_rad[first + 1])
        turned = rotations.vectors(rotations.between(start, end, np.full(smpl.COUNT, share)))
        return Pose(_cubic(self.translations_m, first, share), turned)

    def pose(self, number: int) -> Pose:
        """Pose `number`, as it is stored."""
        return Pose(self.translations_m[number], self.rotations_rad[number])


def _cubic(places_m: Float, first: int, share: float) -> Float:
    """Catmull and Rom's curve between sample `first` and the next; straight on beyond the ends."""
    before = places_m[first - 1] if first > 0 else 2 * places_m[0] - places_m[1]
    after = places_m[first + 2] if first + 2 < len(places_m) else 2 * places_m[-1] - places_m[-2]
    start, end = places_m[first], places_m[first + 1]
    leaving, arriving = (end - before) / 2, (after - start) / 2
    square, cube = share**2, share**3
    return np.asarray(
        (2 * cube - 3 * square + 1) * start
        + (cube - 2 * square + share) * leaving
        + (3 * square - 2 * cube) * end
        + (cube - square) * arriving
    )
