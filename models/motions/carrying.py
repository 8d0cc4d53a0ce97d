"""What carries the body, one support after the other: feet, hands, the back. What carries stays where it is on the ground.

If a support carried alone, the pelvis' way would follow from the pose and the support's place. Where several share the weight, the
pelvis' velocity along the ground is the mean of theirs, weighted by their shares, and so is its height.
"""

import numpy as np

from models.arrays import Float
from models.motions import splines
from models.motions.figure import Figure, Placed
from models.motions.motion import RATE_HZ
from models.skeleton import smpl


def shares(times_s: Float, changes_s: tuple[tuple[float, float], ...]) -> Float:
    """(K + 1, T) shares of K + 1 supports in the weight, which goes from each to the next in K spans (from, to) of time."""
    gone = np.stack([splines.minimum_jerk((times_s - start) / (end - start)) for start, end in changes_s])
    whole = np.concatenate((np.ones((1, len(times_s))), gone))
    return np.asarray(whole - np.concatenate((gone, np.zeros((1, len(times_s))))))


def carried(weights: Float, ways_m: Float) -> Float:
    """(T, 3) way of the pelvis, beginning where the first support has it.

    Args:
        weights: (K, T) share of each support; they sum to 1.
        ways_m: (K, T, 3) of the pelvis at `RATE_HZ`, if that support carried alone; along the ground up to a constant.
    """
    speeds = np.einsum("kt,kta->ta", weights, np.gradient(ways_m, axis=1))
    steps = (speeds[1:, :2] + speeds[:-1, :2]) / 2
    ground = ways_m[0, 0, :2] + np.concatenate((np.zeros((1, 2)), np.cumsum(steps, axis=0)))
    return np.column_stack((ground, np.einsum("kt,kt->t", weights, ways_m[..., 2])))


def over_foot(figure: Figure, side: str, placed: Placed, yaw_rad: Float, pitch_rad: Float, ground_m: float = 0.0) -> Float:
    """(T, 3) way of the pelvis over a foot whose footprint is at the origin.

    Args:
        figure: of the subject.
        side: of the foot.
        placed: the poses with the pelvis at the origin.
        yaw_rad: (T,) to where the toes point.
        pitch_rad: (T,) of the foot.
        ground_m: height of what it stands on.
    """
    print_m = np.zeros((len(pitch_rad), 3))
    print_m[:, 2] = ground_m
    ankle = figure.soles[side].ankles_at(print_m, yaw_rad, pitch_rad)
    return np.asarray(ankle - placed.joints_m[:, smpl.INDEX[f"{side}_ankle"]])


def smooth(way_m: Float, sigma_s: float) -> Float:
    """A way with its corners rounded."""
    return splines.softened(way_m, sigma_s * RATE_HZ)
