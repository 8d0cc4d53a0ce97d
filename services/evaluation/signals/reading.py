"""Reads signals off a track: values, and by first-order propagation how sure they are."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.motions.motion import Handed
from services.evaluation.signals.mass import masses_of
from services.evaluation.signals.posture import BodySide, Posture, SideAsked
from services.evaluation.signals.series import LASTINGS, NOISES, Series
from services.evaluation.signals.signal import Signal
from services.evaluation.stature import Stature, stature_of
from services.evaluation.track import Track
from services.evaluation.uncertainty import NETWORK, Uncertainty, roots

_STEP: Final = 0.005
"""Metres (per second, per second squared) over which a formula's slope is taken: as far as joints are off. A derivative at the
point itself would be none where a straight knee bends either way."""
_UNSEEN_PART: Final = 0.08
"""Of the sum of squared slopes."""


@dataclass(frozen=True, eq=False)
class Reading:
    """A track and what must be known of the pupil to measure it. Signals are computed once each.

    Attributes:
        track: what is read.
        lead: the side that leads.
        model: of the joints' errors.
        told: the pupil's stature, if it is known better than this track tells.
        masses: (17,) shares of the points in the centre of mass; None for segment masses by the stature.
    """

    track: Track
    lead: Handed
    model: Uncertainty = NETWORK
    told: Stature | None = None
    masses: Float | None = None
    _done: dict[tuple[str, str], Series] = field(default_factory=dict, repr=False)

    @cached_property
    def stature(self) -> Stature:
        """Of the pupil."""
        return stature_of(self.track, self.model) if self.told is None else self.told

    def of(self, signal: Signal, side: SideAsked) -> Series:
        """A signal of one side, or the mean of both; of a signal without sides, `side` tells which is positive."""
        if side == "both" and not signal.sided:
            side = "lead"
        key = (signal.name, side)
        if key not in self._done:
            if side == "both":
                left, right = (self.of(signal, one) for one in ("left", "right"))
                self._done[key] = left.plus(right, 0.5, 0.5)
            else:
                self._done[key] = self._compute(signal, self._body_side(side))
        return self._done[key]

    def _body_side(self, side: SideAsked) -> BodySide:
        if side == "left" or side == "right":  # noqa: PLR1714 (the type is narrowed by this)
            return side
        if side == "lead":
            return self.lead
        return "left" if self.lead == "right" else "right"

    @cached_property
    def _roots_m(self) -> Float:
        """(T, 17, 3, 3) of the joints' covariance, with what lies along their way."""
        late_m = self.model.timing_s * np.nan_to_num(self._derivatives[1])
        scale = np.array(self.model.noise_scale)[:, None, None]
        return roots(scale**2 * self.track.covariance_m2 + late_m[..., :, None] * late_m[..., None, :])

    @cached_property
    def _derivatives(self) -> tuple[Float, Float, Float]:
        joints = self.track.joints_m
        return joints, rate(joints, self.track.frame_s), rate_of_rate(joints, self.track.frame_s)

    @cached_property
    def _masses(self) -> Float:
        return masses_of(self.stature.metres) if self.masses is None else self.masses

    def _compute(self, signal: Signal, side: BodySide) -> Series:
        points = self._derivatives[signal.order]
        used: list[int] = []
        stature_m = self.stature.metres if signal.unit == "pct" else 1.0

        def noted(joint: int) -> Float:
            if joint not in used:
                used.append(joint)
            return points[:, joint]

        value = signal.formula(Posture(noted, side, stature_m, self._masses))
        slopes = _slopes(
            lambda moved: signal.formula(Posture(moved, side, stature_m, self._masses)), points, used, value, signal.turns
        )
        if signal.turns:
            value = unwrapped(value)
        if signal.name == "heading":
            value = value - first_known(value)
        return self._series(signal, value, slopes, used)

    def _series(self, signal: Signal, value: Float, slopes: Float, used: list[int]) -> Series:
        count = len(self.track)
        model = self.model
        order = signal.order
        noise = _rate_share(model.noise_s, order) * (slopes[..., None, :] @ self._roots_m[:, used])[..., 0, :]
        lasting = _rate_share(model.landmark_s, order) * slopes * np.array(model.landmark_m)[used, None]
        noise, lasting = (model.mixed[used].T @ factors for factors in (noise, lasting))
        lastings = np.zeros((count, LASTINGS))
        lastings[:, :NOISES] = lasting.reshape(count, NOISES)
        if signal.unit == "pct":
            lastings[:, NOISES] = -value * self.stature.sigma_m / self.stature.metres
        seen = _seen(slopes, self.track.seen[:, used]) & np.isfinite(value)
        series = Series(signal.unit, self.track.t_s, value, noise.reshape(count, NOISES), lastings, seen, model)
        return self._rate(series, signal) if signal.rate_of else series

    def _rate(self, series: Series, signal: Signal) -> Series:
        """How fast an angle gets smaller: positive is straightening."""
        model = self.model
        grows = [rate(factors, series.frame_s) for factors in (series.value, series.noise, series.lasting)]
        noise, lasting = (
            np.hypot(slope, _rate_share(time_s, 1) * factors)
            for slope, time_s, factors in zip(
                grows[1:], (model.noise_s, model.landmark_s), (series.noise, series.lasting), strict=True
            )
        )
        return Series(signal.unit, series.t_s, -grows[0], noise, lasting, series.seen & np.isfinite(grows[0]), model)


def _slopes(formula: Callable[[Callable[[int], Float]], Float], points: Float, used: list[int], value: Float, turns: bool) -> Float:
    """(T, J, 3) by how much the value grows a metre of each axis of each joint that is used.

    Root mean square of what a step forwards and one backwards change: at a bend, where they cancel, either still counts.
    """
    steps = _STEP * np.concatenate((np.eye(3), -np.eye(3)))[:, None, :]
    change = np.empty((len(used), 6, len(value)))
    for place, moved in enumerate(used):
        change[place] = formula(partial(_moved, points, moved, points[:, moved] + steps)) - value
    if turns:
        change = (change + 180) % 360 - 180
    forwards, backwards = change.reshape(len(used), 2, 3, len(value)).transpose(1, 3, 0, 2) / _STEP
    return np.asarray(np.copysign(np.sqrt((forwards**2 + backwards**2) / 2), forwards - backwards))


def _moved(points: Float, moved: int, places: Float, joint: int) -> Float:
    """A joint's places, (T, 3), or of the one that is moved those that it is moved to, (6, T, 3)."""
    return places if joint == moved else points[:, joint]


def _seen(slopes: Float, seen: Bool) -> Bool:
    """(T,) whether what was not seen has hardly a part in the value; a wrist in the centre of mass, never a joint of an angle."""
    parts = (slopes**2).sum(axis=2)
    return np.asarray((parts * ~seen).sum(axis=1) <= _UNSEEN_PART * parts.sum(axis=1))


def _rate_share(time_s: float, order: int) -> float:
    """Standard deviation of an error's time derivative over the error's, if it is forgotten as `Uncertainty.alike` says."""
    return (1.0, 1 / time_s, np.sqrt(3) / time_s**2)[order]


def rate(values: Float, frame_s: float) -> Float:
    """Change a second along the first axis: five-point central differences, three-point ones beside gaps, NaN at ends."""
    out = np.full(values.shape, np.nan)
    if len(values) >= 3:
        out[1:-1] = (values[2:] - values[:-2]) / (2 * frame_s)
    if len(values) >= 5:
        wide = (values[:-4] - 8 * values[1:-3] + 8 * values[3:-1] - values[4:]) / (12 * frame_s)
        out[2:-2] = np.where(np.isfinite(wide), wide, out[2:-2])
    return out


def rate_of_rate(values: Float, frame_s: float) -> Float:
    """Second time derivative along the first axis, as `rate`."""
    out = np.full(values.shape, np.nan)
    if len(values) >= 3:
        out[1:-1] = (values[2:] - 2 * values[1:-1] + values[:-2]) / frame_s**2
    if len(values) >= 5:
        wide = (-values[:-4] + 16 * values[1:-3] - 30 * values[2:-2] + 16 * values[3:-1] - values[4:]) / (12 * frame_s**2)
        out[2:-2] = np.where(np.isfinite(wide), wide, out[2:-2])
    return out


def unwrapped(degrees: Float) -> Float:
    """Angles without jumps of a whole turn; across what is unknown, too."""
    out = degrees.copy()
    known = np.isfinite(degrees)
    out[known] = np.unwrap(degrees[known], period=360)
    return out


def first_known(values: Float) -> float:
    """The first value that is a number; NaN if there is none."""
    known = values[np.isfinite(values)]
    return float(known[0]) if len(known) else float("nan")
