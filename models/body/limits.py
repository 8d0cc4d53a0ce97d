"""How far each joint turns: bounds on its rotation vector, component by component.

Axes are those of the T-pose (x to the front, y to the left, z up), so that on the left side:
- arm: turning about x lowers (-) and raises (+) it, about z brings it forwards (-), about y twists it;
- elbow: about z, bending is negative; leg: hip about y, flexion (thigh forwards) is negative; knee about y, bending is positive;
- elbow about x: nothing alone, but a bent elbow whose forearm is turned (the palm under a ball) turns about x, too;
- ankle about y: dorsiflexion (toes up) is negative; wrist: about x ulnar/radial deviation turns into z, flexion about x.
The right side is its mirror image.

Sources: Soucie et al., "Range of motion measurements: reference values and a database for comparison studies", Haemophilia 17,
2011 (hip, knee, ankle, elbow, shoulder flexion; ages 2-69): no bound is narrower than its mean for any age and sex; AAOS
handbook, "Joint Motion: Method of Measuring and Recording", 1965 (shoulder rotation and abduction, hip abduction and rotation,
wrist, neck, trunk). The trunk's and neck's ranges are shared among their joints, the shoulder's between collar and shoulder.
A box is wider than what an anatomist would allow: it refuses the impossible, not the unusual.
"""

from typing import Final

import numpy as np

from models.arrays import Float
from models.skeleton import smpl

_FREE: Final = (-180.0, 180.0)
_LEFT_DEGREES: Final = {
    #                 about x          about y          about z
    "pelvis": (_FREE, _FREE, _FREE),
    "spine1": ((-15, 15), (-15, 35), (-15, 15)),
    "spine2": ((-15, 15), (-15, 30), (-20, 20)),
    "spine3": ((-15, 15), (-15, 25), (-20, 20)),
    "neck": ((-25, 25), (-30, 30), (-40, 40)),
    "head": ((-25, 25), (-35, 35), (-45, 45)),
    "left_collar": ((-15, 40), (-20, 20), (-30, 30)),
    "left_shoulder": ((-105, 100), (-100, 100), (-140, 60)),
    "left_elbow": ((-95, 95), (-100, 100), (-155, 10)),
    "left_wrist": ((-85, 85), (-20, 20), (-35, 35)),
    "left_hand": ((-100, 30), (-10, 10), (-20, 20)),
    "left_hip": ((-45, 60), (-140, 35), (-50, 50)),
    "left_knee": ((-8, 8), (-8, 155), (-25, 25)),
    "left_ankle": ((-30, 30), (-30, 65), (-25, 25)),
    "left_foot": ((-10, 10), (-60, 35), (-10, 10)),
}
CHILD_WIDER_DEGREES: Final = 12.0
"""Children's joints turn further, by this much at 6 years; nothing at 20."""
_CHILD_YEARS, _GROWN_UP_YEARS = 6.0, 20.0


def limits_rad(age_years: float) -> Float:
    """(24, 3, 2) lowest and highest component of each joint's rotation vector. The pelvis turns freely."""
    degrees = np.zeros((smpl.COUNT, 3, 2))
    for joint, name in enumerate(smpl.NAMES):
        of_left = np.array(_LEFT_DEGREES[name.replace("right_", "left_")], np.float64)
        degrees[joint] = of_left if not name.startswith("right_") else _mirrored(of_left)
    child = np.interp(age_years, (_CHILD_YEARS, _GROWN_UP_YEARS), (1.0, 0.0))
    degrees[1:] += CHILD_WIDER_DEGREES * child * np.array((-1.0, 1.0))
    return np.asarray(np.radians(degrees))


def excess_rad(rotations_rad: Float, limits: Float) -> Float:
    """(24, 3) how far each component is beyond its bound, 0 within; negative below the lower one."""
    below = np.minimum(rotations_rad - limits[:, :, 0], 0.0)
    above = np.maximum(rotations_rad - limits[:, :, 1], 0.0)
    return np.asarray(below + above)


def _mirrored(left: Float) -> Float:
    """In a mirror between the sides a turn about y stays and turns about x and z go the other way."""
    return np.stack((-left[0, ::-1], left[1], -left[2, ::-1]))
