"""Reads signals off a track: values, and by first-order propagation how sure they are."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Final, Literal, TypeVar

import numpy as np

from models.arrays import Bool, Float
from models.motions.motion import Handed
from services.evaluation.signals.mass import masses_of
from services.evaluation.signals.posture import BodySide, Posture, SideAsked
from services.evaluation.signals.series import ERRORS, SURE_DEG, Series
from services.evaluation.signals.signal import Signal
from services.evaluation.stature import Stature, stature_of
from services.evaluation.track import Track
from services.evaluation.uncertainty import NETWORK, Uncertainty, roots

Frames = TypeVar("Frames", Float, Bool)

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
        whose = "both" if side == "both" and signal.sided else self._body_side("lead" if side == "both" else side)
        key = (signal.name, whose)
        if key not in self._done:
            if whose == "both":
                left, right = (self.of(signal, one) for one in ("left", "right"))
                self._done[key] = replace(left.plus(right, 0.5, 0.5), apart=right.value - left.value)
            else:
                self._done[key] = self._compute(signal, whose)
        return self._done[key]

    def _body_side(self, side: Literal["lead", "other", "left", "right"]) -> BodySide:
        if side == "left" or side == "right":  # noqa: PLR1714 (the type is narrowed by this)
            return side
        if side == "lead":
            return self.lead
        return "left" if self.lead == "right" else "right"

    @cached_property
    def _roots_m(self) -> Float:
        """(T, 17, 3, 3) of the joints' covariance, with what lies along their way."""
        late_m = self.model.timing_s * np.nan_to_num(rate_to_the_edge(self.track.joints_m, self.track.frame_s))
        scale = (self._grown * np.array(self.model.noise_scale))[..., None, None]
        return roots(scale**2 * self.track.covariance_m2 + late_m[..., :, None] * late_m[..., None, :])

    @cached_property
    def _grown(self) -> Float:
        """(T, 17) by how much errors are larger than of somebody upright."""
        return self.model.grown(self.track.joints_m)

    @cached_property
    def _moving_roots_m(self) -> Float:
        """(T, 17, 3, 3) the largest of those that a joint's velocity is made of."""
        return _largest(self._roots_m, self._known, (2, 3))

    @cached_property
    def _moving_seen(self) -> Bool:
        """(T, 17) whether all places that a joint's velocity is made of were seen."""
        return _all_seen(self.track.seen, self._known)

    @cached_property
    def _known(self) -> Bool:
        return np.asarray(np.isfinite(self.track.joints_m).all(axis=2))

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
        series = self._series(signal, value, slopes, used)
        if signal.rate_of:
            return self._rate(series, signal)
        if signal.from_start:
            # A track does not know when the attempt in it starts: until that is told, values are against the first known frame.
            whole = unwrapped(value, seen=series.seen)
            return replace(series, value=whole - first_known(whole), from_start=True)
        if signal.turns:
            return replace(series, value=unwrapped(value, series.sigma <= SURE_DEG, series.seen), turns=True)
        return series

    def _series(self, signal: Signal, value: Float, slopes: Float, used: list[int]) -> Series:
        count = len(self.track)
        model = self.model
        order = signal.order
        roots_m, joints_seen = (self._moving_roots_m, self._moving_seen) if order else (self._roots_m, self.track.seen)
        noise = _rate_share(model.noise_s, order) * (slopes[..., None, :] @ roots_m[:, used])[..., 0, :]
        lasting = _rate_share(model.landmark_s, order) * slopes * (self._grown * model.landmark_m)[:, used, None]
        noise, lasting = ((model.mixed[used].T @ factors).reshape(count, ERRORS) for factors in (noise, lasting))
        shares = self.stature.sigma_m / self.stature.metres if signal.unit == "pct" else 0.0
        seen = _seen(slopes, joints_seen[:, used]) & np.isfinite(value)
        return Series(signal.unit, self.track.t_s, value, noise, lasting, -value * shares, seen, model)

    def _rate(self, series: Series, signal: Signal) -> Series:
        """How fast an angle gets smaller: positive is straightening."""
        model = self.model
        known = np.isfinite(series.value)
        value = -rate(series.value, series.frame_s)
        noise, lasting = (
            np.hypot(rate(factors, series.frame_s), _rate_share(time_s, 1) * _largest(factors, known, (1,)))
            for time_s, factors in ((model.noise_s, series.noise), (model.landmark_s, series.lasting))
        )
        seen = _all_seen(series.seen, known) & np.isfinite(value)
        return Series(signal.unit, series.t_s, value, noise, lasting, np.zeros(len(series)), seen, model)


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


def rate_to_the_edge(values: Float, frame_s: float) -> Float:
    """As `rate`; at ends and beside gaps from the one frame next to it. NaN where a frame is alone."""
    out = rate(values, frame_s)
    steps = np.diff(values, axis=0) / frame_s
    for frames in (out[:-1], out[1:]):
        np.copyto(frames, steps, where=~np.isfinite(frames))
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


def unwrapped(degrees: Float, sure: Bool | None = None, seen: Bool | None = None) -> Float:
    """Angles without jumps of a whole turn; across what is unknown or was not seen, too.

    Args:
        degrees: (T,) within half a turn of nought; NaN is unknown.
        sure: (T,) of which frames it is known at all where they point; None for all. Through others no turn is followed: after them
            angles are within half a turn of nought again.
        seen: (T,) which frames were; None for all. The others are but guesses, each within half a turn of what was seen last, or
            first: a guess that lies behind is no turn of the body. Where nothing was seen, guesses are followed.
    """
    out = degrees.copy()
    known = np.flatnonzero(np.isfinite(degrees))
    if not len(known):
        return out
    followed = known if seen is None or not seen[known].any() else known[seen[known]]
    follows = np.ones(len(followed) - 1, np.bool_) if sure is None else sure[followed][1:] & sure[followed][:-1]
    turns = np.concatenate(([0.0], np.cumsum(-np.rint(np.diff(degrees[followed]) / 360))))
    begins = np.maximum.accumulate(np.where(np.concatenate(([False], follows)), 0, np.arange(len(followed))))
    out[followed] += 360 * (turns - turns[begins])
    guessed = np.setdiff1d(known, followed)
    beside = out[followed[np.maximum(np.searchsorted(followed, guessed) - 1, 0)]]
    out[guessed] -= 360 * np.rint((out[guessed] - beside) / 360)
    return out


def first_known(values: Float) -> float:
    """The first value that is a number; NaN if there is none."""
    known = values[np.isfinite(values)]
    return float(known[0]) if len(known) else float("nan")


def _around(values: Frames) -> Frames:
    """(5, T, ...) of (T, ...): the frames from two before to two after each; at the ends those that there are."""
    frames = np.arange(len(values)) + np.arange(-2, 3)[:, None]
    return np.asarray(values[np.clip(frames, 0, len(values) - 1)])


def _used(known: Bool) -> Bool:
    """(5, T, ...) which of the frames around it, (T, ...), the rate in a frame is made of (`rate`); it itself counts as well."""
    wide = np.asarray(_around(known).all(axis=0))
    return np.stack([wide, np.ones_like(wide), np.ones_like(wide), np.ones_like(wide), wide])


def _all_seen(seen: Bool, known: Bool) -> Bool:
    """(T, ...) whether all that the rate in a frame is made of was seen, as (T, ...) in each frame."""
    return np.asarray((_around(seen) | ~_used(known)).all(axis=0))


def _largest(factors: Float, known: Bool, axes: tuple[int, ...]) -> Float:
    """(T, ..., one or more axes) the largest factors of an error of all that the rate in a frame is made of."""
    around = _around(factors)
    sizes = np.where(_used(known), np.nan_to_num((around**2).sum(axis=tuple(axis + 1 for axis in axes))), -1.0)
    picked = np.expand_dims(sizes.argmax(axis=0), (0, *(axis + 1 for axis in axes)))
    return np.asarray(np.take_along_axis(around, picked, axis=0)[0])
