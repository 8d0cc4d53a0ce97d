"""True motion with errors as fusion's smooth motion has them: the same from one frame to the next, and a bias of each landmark."""

from typing import Final

import numpy as np
from scipy.ndimage import gaussian_filter1d

from models.arrays import Float
from models.skeleton import coco
from services.evaluation.track import Track, known_track
from services.evaluation.uncertainty import NETWORK

SIGMA_M: Final = 0.009
"""Along each axis: 15 mm in space, with what follows about what is measured on the twin."""


def as_fused(joints_m: Float, frame_s: float, random: np.random.Generator) -> Track:
    """(T, 17, 3) true joints with noise that is forgotten as `NETWORK` says, and landmarks as wrong as it says."""
    count = len(joints_m)
    noise = SIGMA_M * _smooth(random, count, NETWORK.noise_s / frame_s)
    bias = np.array(NETWORK.landmark_m)[:, None] * _smooth(random, count, NETWORK.landmark_s / frame_s)
    return known_track(joints_m + noise + bias, frame_s, SIGMA_M)


def _smooth(random: np.random.Generator, count: int, frames: float) -> Float:
    """(T, 17, 3) of standard deviation 1 and correlation exp(-(dt / frames)^2 / 2)."""
    width = frames / np.sqrt(2)
    margin = int(np.ceil(5 * width)) + 1
    white = random.standard_normal((count + 2 * margin, coco.COUNT, 3))
    smooth = gaussian_filter1d(white, width, axis=0)[margin:-margin]
    return np.asarray(smooth * np.sqrt(2 * np.sqrt(np.pi) * width))
