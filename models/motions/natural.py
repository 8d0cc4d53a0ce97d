"""How one performance differs from the next without being wrong: a few degrees, some hundredths of a second."""

from typing import Final

import numpy as np

from models.arrays import Float
from models.motions.performance import Performance

_DIRECTION: Final = {"upper": 0.05, "fore": 0.06, "thigh": 0.025}
_DEGREES: Final = {
    **dict.fromkeys(("bend", "turn", "wrist", "toes", "gaze"), 4.5),
    **dict.fromkeys(("cock", "curl", "facing", "twist"), 3.5),
    **dict.fromkeys(("tip", "side", "lean", "bow"), 2.0),
}
"""Standard deviation at skill 0, the first in shares of the direction's length."""
_PACE: Final = 0.06
_MOST: Final = 1.8
"""No deviation is larger than so many standard deviations: it would look like a fault."""


class Natural:
    """Draws the deviations of one performance; the same performance draws the same."""

    def __init__(self, performance: Performance) -> None:
        self._generator = np.random.default_rng(performance.seed)
        self._size = 1.0 - performance.skill
        self._tempo = performance.tempo

    def __call__(self, word: str, value: Float) -> Float:
        """A word of the vocabulary, deviating."""
        sigma = _DIRECTION[word] * float(np.linalg.norm(value)) if word in _DIRECTION else _DEGREES[word]
        return np.asarray(value + self._size * sigma * self._normal(value.shape))

    def seconds(self, standard_s: float) -> float:
        """A duration, by tempo and deviating. Not for what gravity decides."""
        return standard_s / self._tempo * (1.0 + self._size * _PACE * float(self._normal(())))

    def times(self, deviation: float) -> float:
        """A factor around 1, its deviation at skill 0 as told: of a depth, a height, a distance."""
        return 1.0 + self._size * deviation * float(self._normal(()))

    def _normal(self, shape: tuple[int, ...]) -> Float:
        return np.clip(self._generator.standard_normal(shape), -_MOST, _MOST)
