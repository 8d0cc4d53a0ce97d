"""Whether a motion asks more of a joint than it gives: an action then asks again, for less (`models.body.limits`)."""

import numpy as np

from models.body.limits import excess_rad, limits_rad
from models.motions.motion import Motion
from models.motions.subject import Subject
from models.motions.vocabulary import Side
from models.skeleton import smpl


def beyond_deg(
    motion: Motion, subject: Subject, joint: str, axis: int, from_s: float = 0.0, sides: tuple[Side, ...] = ("left", "right")
) -> float:
    """Degrees by which a joint of these sides turns beyond its range about x (0), y (1) or z (2), at worst, from then on."""
    joints = [smpl.INDEX[f"{side}_{joint}"] for side in sides]
    over = excess_rad(motion.rotations_rad[motion.times_s >= from_s], limits_rad(subject.age_years))
    return float(np.degrees(np.abs(over[:, joints, axis]).max()))
