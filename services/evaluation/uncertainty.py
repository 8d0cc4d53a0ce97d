"""How wrong the joints of a smooth motion are: what every sigma in this folder is made of.

The error of a joint has two parts. The *noise* is what fusion's covariance tells of; the smoother makes it the same from one frame
to the next and forgets it within some frames. The *landmark* part is where the pose network puts a joint on the body, against where
the joint is: fusion cannot know of it, all cameras share it, and it changes only as the pose and the views do, over a second or so.
Both are taken as normal, with a correlation over time that falls as exp(-(dt / time)^2 / 2): so that a difference over few frames,
a speed or a range is not charged with what both its ends share.

The numbers were found on development pupils, `make bench-measures ARGS=--calibrate`: 68 % of errors within one sigma.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float
from models.skeleton import coco


@dataclass(frozen=True)
class Uncertainty:
    """A model of the joints' errors.

    Attributes:
        landmark_m: (17) standard deviation, along each axis, of where each joint is taken to be on the body.
        landmark_s: time after which a landmark's error has mostly become another one.
        noise_scale: by which fusion's standard deviations are multiplied.
        noise_s: the same time for the noise.
        moment_s: standard deviation of a keyframe's instant.
    """

    landmark_m: tuple[float, ...]
    landmark_s: float
    noise_scale: float
    noise_s: float
    moment_s: float

    def __post_init__(self) -> None:
        if len(self.landmark_m) != coco.COUNT:
            raise ValueError(f"there are {coco.COUNT} joints, not {len(self.landmark_m)}")

    def alike(self, t_s: Float) -> tuple[Float, Float]:
        """(T, T) correlations of noise and of landmark errors between instants."""
        apart = t_s[:, None] - t_s[None, :]
        noise, landmark = (np.exp(-((apart / time_s) ** 2) / 2) for time_s in (self.noise_s, self.landmark_s))
        return noise, landmark


_MM: Final = {"nose": 3, "eye": 3, "ear": 5, "shoulder": 9.5, "elbow": 5, "wrist": 6, "hip": 12, "knee": 12, "ankle": 8}
NETWORK: Final = Uncertainty(tuple(_MM[name.split("_")[-1]] / 1000 for name in coco.NAMES), 0.5, 1.0, 0.08, 0.02)
"""Of what the box reconstructs."""
EXACT: Final = Uncertainty((0.0,) * coco.COUNT, 1.0, 1.0, 0.08, 0.0)
"""Of truth, and of standards: joints are where they are said to be, within the track's own covariance."""


def roots(covariance: Float) -> Float:
    """Lower triangular roots L of (..., 3, 3) covariances, C = L L'; also of those that are singular; NaN stays NaN."""
    out = np.zeros(covariance.shape)
    for row in range(3):
        for column in range(row + 1):
            rest = covariance[..., row, column] - (out[..., row, :column] * out[..., column, :column]).sum(axis=-1)
            if row == column:
                out[..., row, row] = np.sqrt(np.maximum(rest, 0.0))
            else:
                pivot = out[..., column, column]
                out[..., row, column] = np.where(pivot > 0, rest / np.where(pivot > 0, pivot, 1.0), 0.0 * rest)
    return out
