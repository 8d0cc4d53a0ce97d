"""Natural variation: what differs from one try to the next and from one pupil to another, and is no fault.

Each number is drawn for a name of its own, so that two performances of one seed that differ in a fault or a tempo vary alike.
"""

import zlib

import numpy as np

from models.motions.performance import Performance

_MOST = 2.0
"""No number is further off than so many deviations."""


class Variation:
    """Draws of one performance: the same seed and name give the same number, which is 0 at skill 1."""

    def __init__(self, performance: Performance) -> None:
        self._seed = performance.seed
        self._action = performance.action
        self._scale = 1.0 - performance.skill

    def of(self, name: str, deviation: float) -> float:
        """A number to add: normal, its deviation at skill 0 as told, cut off at twice that."""
        drawn = np.random.default_rng((self._seed % 2**32, zlib.crc32(f"{self._action}.{name}".encode()))).standard_normal()
        return float(deviation * self._scale * np.clip(drawn, -_MOST, _MOST))

    def times(self, name: str, deviation: float) -> float:
        """A number to multiply with: around 1, its deviation at skill 0 as told."""
        return float(np.exp(self.of(name, deviation)))
