"""A quantity over the frames of a track, with all that is needed to tell how sure any sum of its values is."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.compiled import Counts
from models.skeleton import coco
from services.evaluation.uncertainty import Uncertainty

SEEN_SHARE: Final = 0.7
"""Of the frames of a stretch so many must have been seen for what is made of it to be known."""
ERRORS: Final = 3 * coco.COUNT
"""Columns of `Series.noise` and `Series.lasting`: as many independent errors as joints have axes (`Uncertainty.mixed`)."""
SURE_DEG: Final = 60.0
"""An angle with a larger standard deviation says nothing of whether it went round."""


@dataclass(frozen=True, eq=False)
class Series:
    """A signal.

    Attributes:
        unit: of the values.
        t_s: (T,) instants.
        value: (T,); NaN where unknown.
        noise: (T, 51) what each value gains by one standard deviation of each independent part of the joints' noise.
        lasting: (T, 51) the same for the landmarks' errors.
        stature: (T,) the same for the error of the pupil's stature, which is one for the whole attempt.
        seen: (T,) whether two views or more agreed on all joints that the value is made of.
        model: how errors at different instants are alike.
        turns: whether values that are whole turns apart are the same.
        from_start: whether the value at the start of the attempt is yet to be taken off; here it is against any other frame, and
            that one's error is in no sigma.
        apart: (T,) of the mean of both sides, how much more the right side has; None of any other series.
    """

    unit: str
    t_s: Float
    value: Float
    noise: Float
    lasting: Float
    stature: Float
    seen: Bool
    model: Uncertainty
    turns: bool = False
    from_start: bool = False
    apart: Float | None = None

    def __len__(self) -> int:
        return len(self.t_s)

    @cached_property
    def sigma(self) -> Float:
        """(T,) standard deviation of each value; NaN where unknown."""
        return np.asarray(np.sqrt((self.noise**2).sum(axis=1) + (self.lasting**2).sum(axis=1) + self.stature**2))

    @property
    def frame_s(self) -> float:
        """From one frame to the next; 0 for fewer than two."""
        return float(self.t_s[1] - self.t_s[0]) if len(self) > 1 else 0.0

    def enough_seen(self, frames: Bool | Counts) -> bool:
        """Whether there are such frames, and most of them were seen."""
        chosen = self.seen[frames]
        return len(chosen) > 0 and float(np.mean(chosen)) >= SEEN_SHARE

    def covariance(self, frames: Counts) -> Float:
        """(F, F) of the values in such frames."""
        noise_alike, lasting_alike = self.model.alike(self.t_s[frames])
        noise, lasting, stature = self.noise[frames], self.lasting[frames], self.stature[frames]
        return np.asarray(noise @ noise.T * noise_alike + lasting @ lasting.T * lasting_alike + np.outer(stature, stature))

    def variance(self, weights: Float) -> float:
        """Of the sum of the values, each times its weight (T,); NaN if one with a weight is unknown."""
        used = np.flatnonzero(weights)
        if len(used) == 0:
            return 0.0
        total = float(weights[used] @ self.covariance(used) @ weights[used])
        return max(total, 0.0) if np.isfinite(total) else float("nan")

    def about(self, from_s: float, to_s: float) -> "Series":
        """The same angles, less the whole turns that the middle of a stretch is away from nought.

        An arm that circled before the attempt, or that hung, where its direction is but noise, has turns that are none of the
        stretch's. Nor are those that lie between both arms: their mean is half way between them the shorter way.
        """
        if not self.turns:
            return self
        inside = np.isfinite(self.value) & (self.t_s >= from_s - self.frame_s) & (self.t_s <= to_s + self.frame_s)
        sure = inside & (self.sigma <= SURE_DEG)
        if not inside.any():
            return self
        chosen = sure if sure.any() else inside
        halves = 0.0 if self.apart is None else np.rint(np.median(self.apart[chosen]) / 360)
        turns = np.rint(np.median(self.value[chosen] - 180 * halves) / 360)
        return replace(self, value=self.value - 180 * halves - 360 * turns) if turns or halves else self

    def plus(self, other: "Series", share: float = 1.0, own_share: float = 1.0) -> "Series":
        """This times a share, plus another one of the same track times a share."""
        return replace(
            self,
            value=own_share * self.value + share * other.value,
            noise=own_share * self.noise + share * other.noise,
            lasting=own_share * self.lasting + share * other.lasting,
            stature=own_share * self.stature + share * other.stature,
            seen=self.seen & other.seen,
        )
