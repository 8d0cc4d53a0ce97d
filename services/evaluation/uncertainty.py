"""How wrong the joints of a smooth motion are: what every sigma in this folder is made of.

The error of a joint has two parts. The *noise* is what fusion's covariance tells of; the smoother makes it the same from one frame
to the next and forgets it within some frames. The *landmark* part is where the pose network puts a joint on the body, against where
the joint is: fusion cannot know of it, all cameras share it, and it changes only as the pose and the views do, over a second or so.
Both are taken as normal, with a correlation over time that falls as exp(-(dt / time)^2 / 2): so that a difference over few frames,
a speed or a range is not charged with what both its ends share. Of what moves fast the noise is larger along its way: shutters
and the smoother put it some milliseconds beside its time (what the cameras missed between two looks is in fusion's covariance).

Neighbours on the body are wrong in the same way, the more the nearer they are: hips are shifted together, an elbow takes its wrist
along. So errors of joints are alike by exp(-distance / length) of where they are in the T-pose; that makes a trunk less sure, and
an angle surer, than independent joints would.

Pose networks have learned from people who stand. Of somebody upside down they are wrong by more than they say: both parts grow as
the trunk goes from upright to that.

The numbers were found on development pupils through the twin and fusion, from medians: so that 68 % of errors lie within one
sigma, whatever the rest does. `make bench-measures` counts.
"""

import math
from dataclasses import dataclass
from functools import cached_property
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
        noise_scale: (17) by which fusion's standard deviations are multiplied.
        noise_s: the same time for the noise.
        timing_s: by how much time a joint that moves is ahead of or behind its place, along its way: shutters, and the smoother.
        moment_s: standard deviation of a keyframe's instant.
        upside_down: (17) by which the errors of each joint are multiplied of somebody whose trunk points down.
    """

    landmark_m: tuple[float, ...]
    landmark_s: float
    noise_scale: tuple[float, ...]
    noise_s: float
    timing_s: float
    moment_s: float
    upside_down: tuple[float, ...] = (1.0,) * coco.COUNT

    def __post_init__(self) -> None:
        lengths = [len(values) for values in (self.landmark_m, self.noise_scale, self.upside_down)]
        if set(lengths) != {coco.COUNT}:
            raise ValueError(f"there are {coco.COUNT} joints, not {', '.join(map(str, lengths))}")

    def alike(self, t_s: Float) -> tuple[Float, Float]:
        """(T, T) correlations of noise and of landmark errors between instants."""
        apart = t_s[:, None] - t_s[None, :]
        noise, landmark = (np.exp(-((apart / time_s) ** 2) / 2) for time_s in (self.noise_s, self.landmark_s))
        return noise, landmark

    def grown(self, joints_m: Float) -> Float:
        """(T, 17) by how much the errors are larger than of somebody upright, of joints (T, 17, 3) with the z axis upwards.

        Where the trunk is not known it is taken to go on as it does before and after; where it never is, to be upside down.
        """
        share = ((_UPRIGHT - _upwards(joints_m)) / (_UPRIGHT - _DOWN)).clip(0.0, 1.0)
        return np.asarray(1.0 + share[:, None] * (np.array(self.upside_down) - 1.0))

    def independent(self, count: int, frame_s: float) -> float:
        """How many values of the noise so many frames are worth that follow one another: its correlation over time, summed up."""
        return max(count * frame_s / (math.sqrt(2 * math.pi) * self.noise_s), 1.0)

    @cached_property
    def mixed(self) -> Float:
        """(17, 17) what each joint has of each of 17 independent errors of size 1."""
        places = np.array([_T_POSE[name] for name in coco.NAMES])
        apart = np.linalg.norm(places[:, None] - places[None, :], axis=2)
        return np.linalg.cholesky(np.exp(-apart / _ALIKE))


_UPRIGHT: Final = 0.5
_DOWN: Final = -0.4
"""Height of the trunk over its length from which on errors are as of somebody upright, and down to which they grow."""
_SHOULDERS, _HIPS = ([coco.INDEX[f"{side}_{part}"] for side in ("left", "right")] for part in ("shoulder", "hip"))
_ALIKE: Final = 0.17
"""Of the stature: joints so far apart share a third of their errors."""
_SIDED: Final = {
    "eye": (0.02, 0.93),
    "ear": (0.045, 0.92),
    "shoulder": (0.11, 0.81),
    "elbow": (0.28, 0.81),
    "wrist": (0.43, 0.81),
    "hip": (0.07, 0.52),
    "knee": (0.12, 0.28),
    "ankle": (0.15, 0.05),
}
_T_POSE: Final = {"nose": (0.0, 0.90)} | {
    f"{side}_{part}": (sign * aside, high) for part, (aside, high) in _SIDED.items() for side, sign in (("left", 1), ("right", -1))
}
"""To the left and up, of the stature; legs a little apart."""

_MM_AND_SCALES: Final = {
    "nose": (7.0, 0.9, 3.0),
    "eye": (7.0, 0.9, 3.0),
    "ear": (8.5, 1.0, 2.5),
    "shoulder": (6.0, 1.35, 2.0),
    "elbow": (6.3, 1.5, 2.4),
    "wrist": (4.5, 0.9, 1.9),
    "hip": (10.5, 1.8, 1.3),
    "knee": (6.5, 1.4, 1.9),
    "ankle": (6.5, 0.85, 2.5),
}
"""Of each joint: landmark error, millimetres; noise over what fusion says of it; and by how much both grow of who is upside down.
The last is of forward rolls of development pupils in rendered pictures; of cartwheels, networks err by as much."""
_OF_JOINTS: Final = [_MM_AND_SCALES[name.split("_")[-1]] for name in coco.NAMES]
NETWORK: Final = Uncertainty(
    landmark_m=tuple(mm / 1000 for mm, _, _ in _OF_JOINTS),
    landmark_s=0.8,
    noise_scale=tuple(scale for _, scale, _ in _OF_JOINTS),
    noise_s=0.06,
    timing_s=0.005,
    moment_s=0.02,
    upside_down=tuple(grown for _, _, grown in _OF_JOINTS),
)
"""Of what the box reconstructs."""
EXACT: Final = Uncertainty((0.0,) * coco.COUNT, 1.0, (1.0,) * coco.COUNT, 0.06, 0.0, 0.0)
"""Of truth, and of standards: joints are where they are said to be, within the track's own covariance."""


def _upwards(joints_m: Float) -> Float:
    """(T,) height of the shoulders over the hips, over the trunk's length: 1 upright, -1 upside down."""
    trunk = joints_m[:, _SHOULDERS].mean(axis=1) - joints_m[:, _HIPS].mean(axis=1)
    lengths = np.linalg.norm(trunk, axis=1)
    known = np.flatnonzero(lengths > 0)
    if not len(known):
        return np.full(len(joints_m), -1.0)
    return np.asarray(np.interp(np.arange(len(joints_m)), known, trunk[known, 2] / lengths[known]))


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
