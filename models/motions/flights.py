"""Where a thing is over time: in a hand, bouncing, falling slowly."""

import numpy as np

from models.arrays import Float
from models.motions import rotations
from models.motions.ballistics import GRAVITY_M_S2, thrown
from models.motions.figure import Placed
from models.motions.things import SHUTTLECOCK_LENGTH_M

_BOUNCE_UP, _BOUNCE_ON = 0.68, 0.85
"""What a ball keeps of its vertical and its level velocity when it bounces on a gym's floor."""
_OUT_OF_SIGHT_M = 9.0
_SHUTTLE_FALL_M_S = 6.7
"""Speed at which a feathered shuttlecock falls in the end."""


def held(placed: Placed, joint: int, offset_m: Float) -> Float:
    """(T, 3) of a point that is fixed to a joint's segment; `offset_m` (3,) in its frame."""
    return np.asarray(placed.joints_m[:, joint] + rotations.through(placed.turns[:, joint], offset_m))


def bouncing(place_m: Float, velocity_m_s: Float, radius_m: float, after_s: Float) -> Float:
    """(T, 3) of a ball that leaves (3,) with (3,) m/s and bounces on the floor, (T,) ascending seconds after that; NaN when it is
    out of sight."""
    out = np.empty((len(after_s), 3))
    place, velocity, since = place_m.astype(np.float64), velocity_m_s.astype(np.float64), 0.0
    first = 0
    while first < len(after_s):
        up = velocity[2]
        lands = since + (up + np.sqrt(up**2 + 2 * GRAVITY_M_S2 * max(place[2] - radius_m, 0.0))) / GRAVITY_M_S2
        rolling = lands - since < 0.05
        last = len(after_s) if rolling else int(np.searchsorted(after_s, lands, side="right"))
        out[first:last] = thrown(place, velocity, after_s[first:last] - since)
        if rolling:
            out[first:last, 2] = radius_m
            break
        place = thrown(place, velocity, np.array([lands - since]))[0]
        velocity = np.array(
            (_BOUNCE_ON * velocity[0], _BOUNCE_ON * velocity[1], _BOUNCE_UP * (GRAVITY_M_S2 * (lands - since) - up))
        )
        since, first = lands, last
    out[np.linalg.norm(out[:, :2] - place_m[:2], axis=1) > _OUT_OF_SIGHT_M] = np.nan
    return out


def spinning(start: Float, axis: Float, turns_per_s: float, after_s: Float) -> Float:
    """(T, 3) rotation vectors of a thing that spins from (3, 3) about a (3,) axis of the world."""
    angle = 2 * np.pi * turns_per_s * after_s
    return rotations.vectors(rotations.matrices(angle[:, None] * rotations.unit(axis)) @ start)


def shuttlecock(place_m: Float, velocity_m_s: Float, after_s: Float) -> tuple[Float, Float]:
    """Places (T, 3) and rotation vectors (T, 3) of a shuttlecock at (3,) with (3,) m/s at time zero, (T,) seconds later or before.

    Drag in proportion to velocity, so that it falls at most at `_SHUTTLE_FALL_M_S`; before time zero it comes on a straight line.
    The cork goes ahead.
    """
    last = _SHUTTLE_FALL_M_S / GRAVITY_M_S2
    fall = np.array((0.0, 0.0, -_SHUTTLE_FALL_M_S))
    flown = np.maximum(after_s, 0.0)[:, None]
    slowed = np.exp(-flown / last)
    place = place_m + (velocity_m_s - fall) * last * (1 - slowed) + fall * flown + np.minimum(after_s, 0.0)[:, None] * velocity_m_s
    place[:, 2] = np.maximum(place[:, 2], SHUTTLECOCK_LENGTH_M / 2)
    feathers = -(fall + (velocity_m_s - fall) * slowed)
    # A frame's first two columns are what it was made of; here they are the shuttlecock's z and x.
    axes = rotations.frame(feathers, np.array((0.01, 1.0, 0.1)))
    return place, rotations.vectors(axes[..., [1, 2, 0]])
