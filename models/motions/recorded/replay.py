"""A fitted recording as a motion."""

from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.body.pose import Pose
from models.motions import rotations
from models.motions.motion import CONTACTS, RATE_HZ, Motion
from models.motions.recorded.fit import MarkerFit
from models.motions.splines import hermite
from models.skeleton import coco_feet, smpl

STILL_M_PER_S: Final = 0.25
BEARS_S: Final = 0.1
"""A heel or ball of a foot that is still for so long bears, on the floor, a box or a mat; at the top of a flight nothing is."""


def motion_of(fit: MarkerFit) -> Motion:
    """The recording at `RATE_HZ`, where it was made: neither placed at the origin nor begun in `stand`. It has no attempts.

    Between frames each quaternion and the pelvis' place follow piecewise cubics (fourth order, with continuous velocity), so that
    peaks of speed are neither cut nor raised.
    """
    frames = np.arange(len(fit.poses)) / fit.rate_hz
    times = np.arange(int(frames[-1] * RATE_HZ + 1e-6) + 1) / RATE_HZ
    turned = rotations.quaternions(rotations.matrices(fit.poses[:, 3:].reshape(-1, smpl.COUNT, 3)))
    steps = np.sum(turned[1:] * turned[:-1], axis=-1)
    turned[1:] *= np.cumprod(np.where(steps < 0, -1.0, 1.0), axis=0)[..., None]  # q and -q turn alike; neighbours shall be near
    between = rotations.unit(_resampled(frames, turned, times))
    sine = np.linalg.norm(between[..., 1:], axis=-1, keepdims=True)
    sign = np.where(between[..., :1] < 0, -1.0, 1.0)
    half = np.arctan2(sine, np.abs(between[..., :1]))
    vectors = 2 * sign * between[..., 1:] * np.where(sine > 1e-12, half / np.maximum(sine, 1e-12), 1.0)
    places = _resampled(frames, fit.poses[:, :3], times)
    return Motion(places, vectors, _contacts(fit, places, vectors))


def _resampled(frames_s: Float, values: Float, times_s: Float) -> Float:
    slopes = np.gradient(values, frames_s, axis=0)
    if len(values) > 4:
        wide = (values[:-4] - 8 * values[1:-3] + 8 * values[3:-1] - values[4:]) / 12
        slopes[2:-2] = wide / (frames_s[1] - frames_s[0])
    return hermite(frames_s, values, slopes, times_s)


def _contacts(fit: MarkerFit, places: Float, vectors: Float) -> Bool:
    points = np.array([fit.body.coco_m(Pose(*pose)) for pose in zip(places, vectors, strict=True)])
    out = np.zeros((len(points), len(CONTACTS)), np.bool_)
    for column, side in enumerate(("left", "right")):
        ends = points[:, [coco_feet.INDEX[f"{side}_heel"], coco_feet.INDEX[f"{side}_big_toe"]]]
        speeds = np.linalg.norm(np.gradient(ends, 1 / RATE_HZ, axis=0), axis=-1)
        out[:, column] = _lasting(speeds.min(axis=1) < STILL_M_PER_S, int(BEARS_S * RATE_HZ))
    return out


def _lasting(still: Bool, shortest: int) -> Bool:
    """Runs of true values that are no shorter than told, or that begin before the recording or end after it."""
    edges = np.flatnonzero(np.diff(np.concatenate(((False,), still, (False,))).astype(np.int8)))
    out = np.zeros(len(still), np.bool_)
    for first, end in zip(edges[::2], edges[1::2], strict=True):
        out[first:end] = end - first >= shortest or first == 0 or end == len(still)
    return out
