"""Turns about z, then the new x, then the new y: the order that OpenSim's joints have and BVH files often."""

import numpy as np

from models.arrays import Float

_LOCKED = 1e-9
"""Cosine of the second angle below which only the sum of the other two is known; the third is then put to zero."""


def zxy_deg(turns: Float) -> Float:
    """(T, 3) angles of (T, 3, 3) rotations, degrees: about z, x, y. They go on over half a turn rather than jump by a whole one."""
    cosine = np.hypot(turns[:, 0, 1], turns[:, 1, 1])
    locked = cosine < _LOCKED
    first = np.where(locked, np.arctan2(turns[:, 1, 0], turns[:, 0, 0]), np.arctan2(-turns[:, 0, 1], turns[:, 1, 1]))
    second = np.arctan2(turns[:, 2, 1], cosine)
    third = np.where(locked, 0.0, np.arctan2(-turns[:, 2, 0], turns[:, 2, 2]))
    return np.asarray(np.unwrap(np.rad2deg(np.stack((first, second, third), axis=1)), period=360.0, axis=0))
