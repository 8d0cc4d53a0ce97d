"""What the cameras did not see because they looked elsewhere in time.

The window's covariance tells what the noise of the pictures leaves open. What a joint did between two looks is interpolated, which
no noise tells of: a joint that moves is beside its place, along its way, by some share of the way from one look to the next,
whichever cameras these are of. On rendered pictures of upright actions that share was a half, from 5 to 15 looks a camera and
second: then 68 % of the errors of what moves at 1 to 4 m/s lie within one sigma (`docs/accuracy.md`).
"""

import numpy as np

from models.arrays import Float
from services.fusion.timing import Tracks


def gaps_s(tracks: Tracks, since_s: float, until_s: float) -> Float:
    """(17,) mean time from one usable look at a joint to the next, of all cameras together; the whole span where there is none,
    and 0 before the first look of all.
    """
    filled = np.arange(tracks.times_s.shape[1]) < tracks.counts[:, None]
    within = filled & (tracks.times_s >= since_s) & (tracks.times_s <= until_s)
    looks = (within[..., None] & tracks.usable).sum(axis=(0, 1))
    gaps: Float = max(until_s - since_s, 0.0) / np.maximum(looks, 1)
    return gaps


def unsure_m2(velocity_m_s: Float, beside_s: Float) -> Float:
    """(..., 17, 3, 3) covariance of joints at these (..., 17, 3) velocities that are so much (17,) beside their time."""
    way_m = velocity_m_s * beside_s[:, None]
    return np.asarray(way_m[..., :, None] * way_m[..., None, :])
