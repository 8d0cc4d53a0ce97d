"""How long the pupil's limbs are, learnt while they move (for eq. 16)."""

from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.skeleton import coco
from services.fusion.compiled import Counts
from services.fusion.config import SmoothingConfig

ENDS: Final[Counts] = np.array(list(coco.LIMBS.values()), np.int64)
"""(8, 2) proximal and distal joint of each limb."""

_MIN_SAMPLES = 10
_MAX_SIGMA_M = 0.05


class LimbLengths:
    """A running median over the last instants at which both ends were seen."""

    def __init__(self, config: SmoothingConfig) -> None:
        self._config = config
        self._samples: Float = np.full((len(ENDS), config.limb_samples), np.nan)
        self._next = 0
        self._lengths: Float = np.zeros(len(ENDS))
        self._sigmas: Float = np.ones(len(ENDS))

    def current(self) -> tuple[Float, Float]:
        """(8,) lengths and (8,) sigmas in metres, not to be changed; a length of 0 is not known yet."""
        return self._lengths, self._sigmas

    def learn(self, points_m: Float, covariance_m2: Float, seen: Bool) -> None:
        """Take in joints (17, 3) with covariance (17, 3, 3) of which `seen` (17,) can be measured at."""
        a, b = ENDS[:, 0], ENDS[:, 1]
        apart = points_m[a] - points_m[b]
        distance = np.linalg.norm(apart, axis=1)
        spread = covariance_m2[a] + covariance_m2[b]
        total = np.einsum("lii->l", spread)
        sure = seen[a] & seen[b] & (total < 2 * _MAX_SIGMA_M**2) & (distance > 0.05)
        direction = apart / np.maximum(distance, 1e-6)[:, None]
        across = total - np.einsum("li,lij,lj->l", direction, spread, direction)
        # Noise across a limb always lengthens it: E|d + n| is |d| + variance across / 2 |d|.
        unbiased = distance - across / (2 * np.maximum(distance, 0.05))
        self._samples[:, self._next] = np.where(sure, unbiased, np.nan)
        self._next = (self._next + 1) % self._samples.shape[1]
        if np.isfinite(self._config.limb_sigma):
            self._measure()

    def _measure(self) -> None:
        ordered = np.sort(self._samples, axis=1)
        count = np.isfinite(ordered).sum(axis=1)
        middle = ordered[np.arange(len(ENDS)), np.maximum(count - 1, 0) // 2]
        self._lengths = np.where(count >= _MIN_SAMPLES, middle, 0.0)
        self._sigmas = np.where(count >= _MIN_SAMPLES, self._config.limb_sigma * middle, 1.0)
