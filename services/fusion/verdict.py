"""What may be said of the joints at one instant: seen, guessed or unknown."""

from dataclasses import dataclass

import numpy as np

from models.arrays import Float, UInt8, UInt32
from models.compiled import Counts, compiled
from models.messages.motion import JointState

_UNKNOWN, _GUESSED, _SEEN = (int(state) for state in (JointState.UNKNOWN, JointState.GUESSED, JointState.SEEN))
_IMPOSSIBLE = 0.4
"""Share by which a limb may differ from its length before its far end is not believed."""


@dataclass(frozen=True, eq=False)
class Pose:
    """The joints at one instant: arrays as in `Motion`, in float64; what is unknown carries no numbers."""

    joints_m: Float
    covariance_m2: Float
    states: UInt8
    views: UInt32


@compiled
def _count_bits(bits: int) -> int:
    count = 0
    while bits:
        bits &= bits - 1
        count += 1
    return count


@compiled
def judge_joints(
    points: Float,
    covariance: Float,
    views: UInt32,
    agreed: Float,
    instant: float,
    guess: float,
    max_variance: float,
    ends: Counts,
    lengths: Float,
) -> tuple[Float, Float, UInt8, UInt32]:
    """The arrays of a `Pose`.

    Args:
        points, covariance, views: (J, 3), (J, 3, 3), (J,) as `Smoothed` has them of one instant.
        agreed: (J,) when two views last agreed on a joint, in seconds; kept up to date.
        instant: in seconds.
        guess: seconds for which a joint is carried with fewer than two views.
        max_variance: sum over the coordinates above which a joint is unknown.
        ends, lengths: (L, 2) proximal and distal joints and (L,) lengths of the limbs; 0 is not known.
    """
    joints = points.shape[0]
    out, spread = np.zeros((joints, 3)), np.zeros((joints, 3, 3))
    states, used = np.full(joints, _UNKNOWN, np.uint8), np.zeros(joints, np.uint32)
    for j in range(joints):
        seen = _count_bits(views[j]) >= 2
        if seen:
            agreed[j] = instant
        if instant - agreed[j] <= guess and covariance[j, 0, 0] + covariance[j, 1, 1] + covariance[j, 2, 2] <= max_variance:
            out[j], spread[j], used[j] = points[j], covariance[j], views[j]
            states[j] = _SEEN if seen else _GUESSED
    for limb in range(ends.shape[0]):
        near, far = points[ends[limb, 0]], points[ends[limb, 1]]
        apart = np.sqrt((near[0] - far[0]) ** 2 + (near[1] - far[1]) ** 2 + (near[2] - far[2]) ** 2)
        # Two views can agree on a wrong point; they cannot lengthen a forearm.
        if lengths[limb] > 0.0 and abs(apart - lengths[limb]) > _IMPOSSIBLE * lengths[limb]:
            states[ends[limb, 1]] = min(states[ends[limb, 1]], _GUESSED)
    return out, spread, states, used
