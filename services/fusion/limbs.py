"""How long the pupil's limbs are, learnt while they move (for eq. 16)."""

from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.compiled import Counts, compiled
from models.skeleton import coco
from services.fusion.config import SmoothingConfig

ENDS: Final[Counts] = np.array(list(coco.LIMBS.values()), np.int64)
"""(8, 2) proximal and distal joint of each limb."""

_MIN_SAMPLES = 10
_MAX_SIGMA_M = 0.05
_MIN_LENGTH_M = 0.05


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
        measure_limbs(points_m, covariance_m2, seen, ENDS, self._samples[:, self._next])
        self._next = (self._next + 1) % self._samples.shape[1]
        if np.isfinite(self._config.limb_sigma):
            self._lengths, self._sigmas = median_lengths(self._samples, self._config.limb_sigma)


@compiled
def measure_limbs(points: Float, covariance: Float, seen: Bool, ends: Counts, out: Float) -> None:
    """(L,) lengths of limbs at one instant, NaN where an end is not seen or not sure: the kernel of `LimbLengths.learn`."""
    direction = np.empty(3)
    for limb in range(ends.shape[0]):
        a, b = ends[limb]
        out[limb] = np.nan
        distance2 = total = 0.0
        for k in range(3):
            direction[k] = points[a, k] - points[b, k]
            distance2 += direction[k] ** 2
            total += covariance[a, k, k] + covariance[b, k, k]
        if not (seen[a] and seen[b] and total < 2 * _MAX_SIGMA_M**2 and distance2 > _MIN_LENGTH_M**2):
            continue
        across = total
        for k in range(3):
            for m in range(3):
                across -= direction[k] * (covariance[a, k, m] + covariance[b, k, m]) * direction[m] / distance2
        # Noise across a limb always lengthens it: E|d + n| is |d| + variance across / 2 |d|.
        distance = np.sqrt(distance2)
        out[limb] = distance - across / (2 * distance)


@compiled
def median_lengths(samples: Float, relative_sigma: float) -> tuple[Float, Float]:
    """(L,) medians of the samples (L, n) that are not NaN, 0 if they are few, and their sigmas."""
    lengths, sigmas = np.zeros(samples.shape[0]), np.ones(samples.shape[0])
    for limb in range(samples.shape[0]):
        measured = np.sort(samples[limb][~np.isnan(samples[limb])])
        if measured.shape[0] >= _MIN_SAMPLES:
            lengths[limb] = measured[(measured.shape[0] - 1) // 2]
            sigmas[limb] = relative_sigma * lengths[limb]
    return lengths, sigmas
