"""The words in which a coach describes a posture; an action is a list of them with times (`models.motions.timeline`).

A word that is left out (None) stays what the other key poses make of it. Directions are (front, out, up): out is away from the
body's middle, so that the same words serve both sides. Their length does not matter. Angles are degrees.
"""

from dataclasses import dataclass
from typing import Literal

Side = Literal["left", "right"]
Direction = tuple[float, float, float]


@dataclass(frozen=True)
class Arm:
    """An arm against the chest.

    Attributes:
        upper: direction of the upper arm; (0, 0, -1) hangs, (1, 0, 0) points to the front, (0, 0, 1) straight up.
        fore: to which side the forearm leaves the upper arm when the elbow bends; must not lie along `upper`.
        bend: of the elbow; 0 is straight.
        turn: pronation; at 0 the thumb is on the side to which the elbow bends, as one holds a hammer. With the upper arm hanging
            and the forearm to the front the palm looks down at 90, up at -90.
        wrist: flexion, towards the palm; extension is negative.
        cock: deviation towards the thumb.
        curl: of the fingers.
    """

    upper: Direction | None = None
    fore: Direction | None = None
    bend: float | None = None
    turn: float | None = None
    wrist: float | None = None
    cock: float | None = None
    curl: float | None = None


@dataclass(frozen=True)
class Leg:
    """A leg that is off the floor, against the pelvis.

    Attributes:
        thigh: its direction; (0, 0, -1) is straight down, (1, 0, 0) to the front.
        bend: of the knee; 0 is straight.
        turn: of the whole leg about the thigh, knee and toes outwards.
        toes: pointing them (plantar flexion).
    """

    thigh: Direction | None = None
    bend: float | None = None
    turn: float | None = None
    toes: float | None = None


@dataclass(frozen=True)
class Body:
    """Where the pelvis is, how the trunk is held, where the eyes look.

    Attributes:
        at: (front, left) of the pelvis from where the action began, in leg lengths (hip to ankle).
        height: of the pelvis, in its height when standing.
        facing: of the pelvis, turned to the left.
        tip: of the pelvis to the front.
        side: of the pelvis, down to the right.
        lean: of the trunk against the pelvis, to the front.
        bow: of the trunk against the pelvis, down to the right.
        twist: of the trunk against the pelvis, to the left.
        gaze: (yaw, pitch) in the world: to the left, down.
    """

    at: tuple[float, float] | None = None
    height: float | None = None
    facing: float | None = None
    tip: float | None = None
    side: float | None = None
    lean: float | None = None
    bow: float | None = None
    twist: float | None = None
    gaze: tuple[float, float] | None = None
