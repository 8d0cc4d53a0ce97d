"""A track at another rate: standards, and all that looks for attempts, have 30 frames a second; other programs have any number."""

from typing import Final

import numpy as np
from scipy.interpolate import CubicSpline

from models.arrays import Float
from models.messages.motion import JointState
from services.evaluation.track import Track

_SAME: Final = 1e-6
_FEWEST: Final = 4
"""Frames in which a joint must be known for a curve through them."""


def resampled(track: Track, frame_s: float) -> Track:
    """The same motion from the same first instant on, as far as the track goes.

    A cubic curve goes through the places of each joint: at film's 25 frames a second a hand that hits is bent off its line by 6 cm
    between two frames. Where one of the frames on either side does not know a joint, it is unknown; where one of them only guessed
    it, it is guessed. Covariances are those of the nearest frame.

    Args:
        track: at least two frames.
        frame_s: from one frame to the next.
    """
    if abs(track.frame_s / frame_s - 1) < _SAME:
        return track
    begin_s, step_s = float(track.t_s[0]), track.frame_s
    last = len(track) - 1
    places = np.minimum(np.arange(int(last * step_s / frame_s + _SAME) + 1) * frame_s / step_s, last)
    nearest = np.rint(places).astype(np.int64)
    # On a frame, give or take what rounding leaves, it alone counts.
    off = np.abs(places - nearest) > _SAME
    below, above = (np.where(off, side(places).astype(np.int64), nearest) for side in (np.floor, np.ceil))
    joints = np.stack([_curve(track.joints_m[:, joint], places) for joint in range(track.joints_m.shape[1])], axis=1)
    states = np.minimum(track.states[below], track.states[above])  # from unknown to guessed to seen
    known = (states != JointState.UNKNOWN) & np.isfinite(joints).all(axis=2)
    return Track(
        begin_s + np.arange(len(places), dtype=np.float64) * frame_s,
        np.where(known[..., None], joints, np.nan),
        np.where(known[..., None, None], track.covariance_m2[nearest], np.nan),
        np.where(known, states, JointState.UNKNOWN).astype(np.uint8),
    )


def _curve(joint_m: Float, places: Float) -> Float:
    """(P, 3) of one joint, (T, 3), at places between its frames; of no use where its neighbours are unknown."""
    known = np.flatnonzero(np.isfinite(joint_m).all(axis=1))
    if len(known) < _FEWEST:
        return np.full((len(places), 3), np.nan)
    return np.asarray(CubicSpline(known, joint_m[known])(places))
