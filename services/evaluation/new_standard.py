"""Makes the standard of an action from one performance: a pupil's in a lesson, or one from another program. Pure.

One performance says how it looks when it is done so. It does not say how far good performances differ from one another, nor how an
attempt looks that is slower, or by somebody of another build. For both it leans on the standard that KineBox brings for the action
(`base`), whatever counted in between, so that nothing of a recording that was a mistake stays:

- **Exemplars** are the base's performance and its exemplars. By them attempts are found and timed as before, by pupils of all ages;
  the new performance is one more of which both learn.
- **Spread** is the base's, carried over by the keyframes, at the new size: pupils' natural variation at the same moment of the same
  action. How far the new performance itself is from the base is not put into it: that is what the teacher wants to be different,
  and a limit that is as wide would colour nobody who does it the old way. Where the base does not know it, it is unknown, and the
  action's tolerances alone count.
"""

from dataclasses import replace
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.interpolation import between
from models.messages.motion import JointState
from models.teaching.showing import PerformanceError, require_floor, require_movement, require_seen
from models.teaching.standard import AFTER_S, BEFORE_S, FRAME_S, LONGEST_S, Exemplar, Moments, Standard, same_instants
from services.evaluation.attempt import AROUND_S, FoundAttempt
from services.evaluation.normalise import PlacingError, lead_right, placing_of, root_m, size_m
from services.evaluation.search import attempts_in
from services.evaluation.stature import stature_of
from services.evaluation.track import Track, known_track

SURE_M: Final = 0.05
"""Standard deviation along an axis beyond which a joint's place is no model for anybody: it is unknown."""
MOST_EXEMPLARS: Final = 7
_ROUNDED: Final = 1e-6


def standard_of(track: Track, attempt: FoundAttempt, base: Standard, origin: str) -> Standard:
    """Make a performance the standard.

    Args:
        track: that holds the attempt, at `FRAME_S`, in a world with the floor at 0.
        attempt: on the track's clock. If its left side leads, the standard is its mirror image.
        base: of the same action; what one performance does not say is taken from it.
        origin: see `Standard`.

    Returns:
        In the canonical frame, of version 1: whoever keeps it counts. Its own attempt is found by it.

    Raises:
        PerformanceError: too much of it is unknown, it does not stand on the floor, is too long or goes too far, or nothing moves.
    """
    joints_m, moments_s = _cut(lead_right(track, attempt.handed), attempt.moments_s)
    require_seen(joints_m, moments_s, attempt.handed)
    canonical_m = _canonical(joints_m)
    try:
        performance = Exemplar(canonical_m, moments_s)
    except ValueError as error:
        raise PerformanceError(f"can be no standard: {error}") from error
    stature_m = _stature_m(track, attempt.moments_s, base)
    require_floor(performance, stature_m)
    require_movement(performance, stature_m)
    exemplars = (base.performance, *base.exemplars)[:MOST_EXEMPLARS]
    try:
        standard = Standard(attempt.action, 1, origin, performance, _spread_m(performance, stature_m, base), stature_m, exemplars)
    except ValueError as error:
        raise PerformanceError(f"can be no standard: {error}") from error
    require_found(standard)
    return standard


def require_found(standard: Standard) -> None:
    """PerformanceError unless who performs just like a standard is found by it."""
    if not _finds_itself(standard):
        raise PerformanceError("is not like an attempt at anything: none would be found by it")


def _cut(track: Track, moments_s: Moments) -> tuple[Float, Moments]:
    """(T, 17, 3) joints that are known well, from shortly before the start to shortly after the end; keyframes from the first."""
    if moments_s[-1] - moments_s[0] > LONGEST_S - BEFORE_S - AFTER_S - 2 * FRAME_S:
        raise PerformanceError(f"takes longer than the {LONGEST_S:.0f} s that a movement takes at most")
    part = _around(track, moments_s[0] - BEFORE_S, moments_s[-1] + AFTER_S)
    begin_s = float(part.t_s[0])
    start, exertion, peak, end = (max(moment_s - begin_s, 0.0) for moment_s in moments_s)
    return np.where(_sure(part)[..., None], part.joints_m, np.nan), (start, exertion, peak, end)


def _around(track: Track, first_s: float, last_s: float) -> Track:
    """From the last frame until `first_s` to the first one from `last_s` on, as far as they are there."""
    first = max(int(np.floor(track.frame_at(first_s) + _ROUNDED)), 0)
    last = min(int(np.ceil(track.frame_at(last_s) - _ROUNDED)), len(track) - 1)
    return track.part(first, last + 1)


def _canonical(joints_m: Float) -> Float:
    """Turned and moved, not scaled."""
    try:
        placing = placing_of(joints_m, FRAME_S, 1.0)
    except PlacingError as error:
        raise PerformanceError(str(error)) from error
    roots = root_m(joints_m)
    origin = roots[np.isfinite(roots).all(axis=1)][0] * (1.0, 1.0, 0.0)
    return np.asarray((joints_m - origin) @ replace(placing, scale=1.0).matrix.T)


def _sure(track: Track) -> Bool:
    """(T, 17) where a joint was seen, and is known well. What was guessed may be sure of itself and wrong."""
    variance_m2 = np.trace(track.covariance_m2, axis1=2, axis2=3) / 3
    with np.errstate(invalid="ignore"):
        return np.asarray((track.states == JointState.SEEN) & (variance_m2 <= SURE_M**2))


def _stature_m(track: Track, moments_s: Moments, base: Standard) -> float:
    """By all lengths of the body, or, where the head is not known, by trunk and legs alone.

    Also by the frames around the attempt, in which the pupil stands straight as a rule: who rolls shows a short neck and trunk.
    """
    part = _around(track, moments_s[0] - AROUND_S, moments_s[-1] + AROUND_S)
    joints_m = np.where(_sure(part)[..., None], part.joints_m, np.nan)
    told = stature_of(known_track(joints_m, FRAME_S)).metres
    return told if np.isfinite(told) else base.stature_m * size_m(joints_m) / size_m(base.joints_m)


def _finds_itself(standard: Standard) -> bool:
    try:
        return bool(attempts_in(known_track(standard.joints_m, FRAME_S), replace(standard, exemplars=())))
    except ValueError:
        return False  # What the finder looks at is known in no frame.


def _spread_m(performance: Exemplar, stature_m: float, base: Standard) -> Float:
    """(S, 17) the base's at the same instants, of a body of this size."""
    times_s = np.arange(len(performance.joints_m), dtype=np.float64) * FRAME_S
    frames = same_instants(times_s, performance.moments_s, base.moments_s) / FRAME_S
    return np.asarray(between(base.spread_m, frames) * stature_m / base.stature_m)
