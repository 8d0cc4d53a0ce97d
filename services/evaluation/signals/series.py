"""A quantity over the frames of a track, with all that is needed to tell how sure any sum of its values is."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from models.arrays import Bool, Float
from models.compiled import Counts
from models.skeleton import coco
from services.evaluation.uncertainty import Uncertainty

SEEN_SHARE = 0.7
"""Of the frames of a stretch so many must have been seen for what is made of it to be known."""
NOISES = 3 * coco.COUNT
"""Columns of `Series.noise`: as many independent errors as joints have axes (`Uncertainty.mixed`)."""
LASTINGS = NOISES + 1
"""Columns of `Series.lasting`: the same for the landmarks' errors, and the error of the pupil's stature."""


@dataclass(frozen=True, eq=False)
class Series:
    """A signal.

    Attributes:
        unit: of the values.
        t_s: (T,) instants.
        value: (T,); NaN where unknown.
        noise: (T, 51) what each value gains by one standard deviation of each independent part of the joints' noise.
        lasting: (T, 52) the same for the landmarks' errors, and for the stature's.
        seen: (T,) whether two views or more agreed on all joints that the value is made of.
        model: how errors at different instants are alike.
    """

    unit: str
    t_s: Float
    value: Float
    noise: Float
    lasting: Float
    seen: Bool
    model: Uncertainty

    def __len__(self) -> int:
        return len(self.t_s)

    @cached_property
    def sigma(self) -> Float:
        """(T,) standard deviation of each value; NaN where unknown."""
        return np.asarray(np.sqrt((self.noise**2).sum(axis=1) + (self.lasting**2).sum(axis=1)))

    @property
    def frame_s(self) -> float:
        """From one frame to the next; 0 for fewer than two."""
        return float(self.t_s[1] - self.t_s[0]) if len(self) > 1 else 0.0

    def enough_seen(self, frames: Bool | Counts) -> bool:
        """Whether there are such frames, and most of them were seen."""
        chosen = self.seen[frames]
        return len(chosen) > 0 and float(np.mean(chosen)) >= SEEN_SHARE

    def variance(self, weights: Float) -> float:
        """Of the sum of the values, each times its weight (T,); NaN if one with a weight is unknown."""
        used = np.flatnonzero(weights)
        if len(used) == 0:
            return 0.0
        noise_alike, lasting_alike = self.model.alike(self.t_s[used])
        total = 0.0
        for factors, alike in ((self.noise[used], noise_alike), (self.lasting[used], lasting_alike)):
            weighted = weights[used, None] * factors
            total += float((weighted @ weighted.T * alike).sum())
        return max(total, 0.0) if np.isfinite(total) else float("nan")

    def plus(self, other: "Series", share: float = 1.0, own_share: float = 1.0) -> "Series":
        """This times a share, plus another one of the same track times a share."""
        return replace(
            self,
            value=own_share * self.value + share * other.value,
            noise=own_share * self.noise + share * other.noise,
            lasting=own_share * self.lasting + share * other.lasting,
            seen=self.seen & other.seen,
        )
