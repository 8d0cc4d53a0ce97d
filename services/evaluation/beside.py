"""The standard beside the pupil: at each of his frames, where he is, turned as he is, and of his size."""

import numpy as np

from models.arrays import Float
from models.interpolation import between
from models.motions.motion import Handed
from services.evaluation.alignment import AlignedTrack
from services.evaluation.normalise import mirrored, root_m
from services.evaluation.track import Track


def standard_beside(aligned: AlignedTrack, track: Track, handed: Handed) -> Float:
    """How it should look, in the world.

    Args:
        aligned: the track's attempt along its standard.
        track: that leads with the right (`normalise.lead_right`).
        handed: the side that led before that.

    Returns:
        (T, 17, 3) the standard at the moment that each frame of the track is compared with, the middle of its hips above or below
        the pupil's; between two frames where his are not known. NaN where the standard is not known, or he nowhere.
    """
    standard = between(aligned.standard_m, aligned.frames)
    placed = standard @ np.linalg.inv(aligned.placing.matrix).T
    placed[..., :2] += _centres(track)[:, None]
    return mirrored(placed) if handed == "left" else placed


def _centres(track: Track) -> Float:
    """(T, 2) of the middle of the hips on the floor."""
    centres = root_m(track.joints_m)[:, :2]
    known = np.isfinite(centres).all(axis=1)
    if not known.any():
        return np.full_like(centres, np.nan)
    frames = np.arange(len(centres))
    return np.stack([np.interp(frames, frames[known], centres[known, axis]) for axis in range(2)], axis=1)
