"""How high, how long and how far somebody jumps."""

import math
from collections.abc import Callable
from typing import Final

import numpy as np

from models.compiled import Counts
from models.motions.ballistics import GRAVITY_M_S2
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures import keyframe
from services.evaluation.measures.flight import ANKLE_CM, Flight, flight_of
from services.evaluation.measures.measured import HIDDEN, Estimate, Function, unknown
from services.evaluation.signals.posture import SideAsked
from services.evaluation.signals.reading import Reading
from services.evaluation.signals.series import Series

FOOT_OF_STATURE: Final = 0.152
"""Length of a foot: Drillis and Contini, "Body Segment Parameters", New York University 1966."""
_FOOT_SIGMA: Final = 0.008
"""Of the stature: what feet differ in."""
_FEET_UNSEEN: Final = "the cameras' network sees no heels and toes"
_FAMILY: Final = "Jumps"
_STANDS_S: Final = (0.13, 0.35)
"""After a landing the feet are flat and still from when to when."""
_FLAT_ABOVE_CM: Final = 0.5
"""An ankle that has risen further goes to the front with it: the foot turns about its ball, or, landing, about its heel."""
_LAST: Final = 3
"""So many frames of a foot that stands are averaged."""
_SURELY_APART: Final = 2.0
"""Standard deviations."""
_TOP_SIGMA_S: Final = 0.006
_SIDES: Final[tuple[SideAsked, SideAsked]] = ("left", "right")

_Of = Callable[[Flight], tuple[float, float]]


def _of_flight(measure: _Of) -> Callable[[Reading, FoundAttempt], Estimate]:
    def call(reading: Reading, attempt: FoundAttempt) -> Estimate:
        flight = flight_of(reading, attempt)
        if isinstance(flight, str):
            return unknown(flight)
        value, sigma = measure(flight)
        return Estimate(value, sigma, flight.seen)

    return call


def _height(flight: Flight) -> tuple[float, float]:
    return flight.rise_cm, flight.up_cm_s * flight.off_sigma_s


def _time(flight: Flight) -> tuple[float, float]:
    return flight.on_s - flight.off_s, math.hypot(flight.off_sigma_s, flight.on_sigma_s)


def _height_by_time(flight: Flight) -> tuple[float, float]:
    seconds, sigma_s = _time(flight)
    return 100 * GRAVITY_M_S2 * seconds**2 / 8, 100 * GRAVITY_M_S2 * seconds / 4 * sigma_s


def _angle(flight: Flight) -> tuple[float, float]:
    along, up = float(np.hypot(*flight.speed_cm_s)), flight.up_cm_s
    fast = along**2 + up**2
    return math.degrees(math.atan2(up, along)), math.degrees(
        along / fast * 100 * GRAVITY_M_S2 * flight.off_sigma_s
    ) if fast else math.nan


def _feet_apart(flight: Flight) -> tuple[float, float]:
    left_s, right_s = flight.feet_on_s
    return abs(right_s - left_s), flight.on_sigma_s


def _peak_after_top(reading: Reading, attempt: FoundAttempt) -> Estimate:
    flight = flight_of(reading, attempt)
    if isinstance(flight, str):
        return unknown(flight)
    sigma_s = math.hypot(keyframe.sigma_s(reading, attempt, "peak"), _TOP_SIGMA_S)
    return Estimate(attempt.moment_s("peak") - flight.top_s, sigma_s, flight.seen)


def _travel(reading: Reading, attempt: FoundAttempt) -> Estimate:
    flight = flight_of(reading, attempt)
    if isinstance(flight, str):
        return unknown(flight)
    fast = float(np.hypot(*flight.speed_cm_s))
    along = flight.speed_cm_s / fast if fast > 0 else np.zeros(2)
    before, after, seen = [], [], flight.seen
    for place, side in enumerate(_SIDES):
        x, y, z = (reading.of(signal, side) for signal in ANKLE_CM)
        path = x.plus(y, float(along[1]), float(along[0]))
        limit_cm = flight.flat_cm[place] + _FLAT_ABOVE_CM
        stood = _frames(path, z, -math.inf, flight.feet_off_s[place], limit_cm)
        landed_s = flight.feet_on_s[place]
        lands = _frames(path, z, landed_s + _STANDS_S[0], landed_s + _STANDS_S[1], limit_cm)
        if len(stood) == 0 or len(lands) == 0:
            return unknown(HIDDEN)
        before.append((path, stood[-_LAST:]))
        after.append((path, lands[:_LAST]))
        seen &= bool(path.seen[[*stood[-_LAST:], *lands[:_LAST]]].all())
    (first, first_variance), (last, last_variance) = _outermost(before, 1.0), _outermost(after, -1.0)
    return Estimate(last - first, math.sqrt(first_variance + last_variance), seen)


def _frames(path: Series, height: Series, from_s: float, to_s: float, below_cm: float) -> Counts:
    within = (path.t_s >= from_s) & (path.t_s <= to_s) & np.isfinite(path.value)
    flat = within & (height.value <= below_cm)
    return np.flatnonzero(flat if flat.any() else within)


def _outermost(feet: list[tuple[Series, Counts]], sign: float) -> tuple[float, float]:
    """Place of the foot that is furthest along the way (`sign` 1) or furthest back (-1), and its variance.

    Of two numbers that are the same but for their errors the larger one is too large on average. So feet that are not surely apart
    stand side by side, in the middle of both.
    """
    one, other = (_mean(foot) for foot in feet)
    variance = sum(_variance(*foot) for foot in feet)
    apart = abs(one - other)
    surely = apart > _SURELY_APART * math.sqrt(variance)
    return (one + other) / 2 + (sign * apart / 2 if surely else 0.0), variance / 2


def _mean(of: tuple[Series, Counts]) -> float:
    return float(np.mean(of[0].value[of[1]]))


def _variance(path: Series, frames: Counts) -> float:
    weights = np.zeros(len(path))
    weights[frames] = 1 / len(frames)
    return path.variance(weights)


def _distance(reading: Reading, attempt: FoundAttempt) -> Estimate:
    travel = _travel(reading, attempt)
    foot_cm = 100 * FOOT_OF_STATURE * reading.stature.metres
    sigma_cm = math.hypot(100 * _FOOT_SIGMA * reading.stature.metres, 100 * FOOT_OF_STATURE * reading.stature.sigma_m)
    return Estimate(travel.value - foot_cm, math.hypot(travel.sigma, sigma_cm), travel.seen, travel.why)


def _feet_unseen(_reading: Reading, _attempt: FoundAttempt) -> Estimate:
    return unknown(_FEET_UNSEEN)


FUNCTIONS = (
    Function(
        "jump_height",
        "cm",
        _FAMILY,
        "How far the centre of mass rises from take-off to its highest point: g (t_top - t_off)^2 / 2, with the top from the "
        "parabola of the frames in the air and the take-off from the rise of the ankles.",
        "Linthorne, American J. Physics 69, 2001 (take-off height to peak height)",
        _of_flight(_height),
    ),
    Function(
        "jump_height_by_time",
        "cm",
        _FAMILY,
        "g t^2 / 8 of the time in the air t: what force plates and contact mats call the height. "
        "Larger than `jump_height` by what the body is lower at landing than at take-off.",
        "Bosco et al., European J. Applied Physiology 50, 1983",
        _of_flight(_height_by_time),
    ),
    Function(
        "flight_time", "s", _FAMILY, "From when the last foot leaves the floor until the first one lands.", "", _of_flight(_time)
    ),
    Function(
        "jump_distance",
        "cm",
        _FAMILY,
        "From the toes at take-off to the nearer heel at landing, as by the tape: how far the ankles travel, less a foot's length. "
        f"Toes and heels are not seen; a foot is taken to be {100 * FOOT_OF_STATURE:.1f} % of the stature long.",
        "Drillis and Contini, 1966 (length of a foot)",
        _distance,
    ),
    Function(
        "ankle_travel",
        "cm",
        _FAMILY,
        "From the ankle that is further in front before take-off to the one that is further behind after landing, along the jump.",
        "",
        _travel,
    ),
    Function(
        "take_off_angle",
        "deg",
        _FAMILY,
        "Direction in which the centre of mass leaves the floor: 0 along it, 90 straight up.",
        "Wakai and Linthorne, Human Movement Science 24, 2005",
        _of_flight(_angle),
    ),
    Function(
        "landing_apart", "s", _FAMILY, "From when the first foot lands until the other one does.", "", _of_flight(_feet_apart)
    ),
    Function(
        "peak_after_top",
        "s",
        _FAMILY,
        "From the highest point of the centre of mass to the peak; negative if the peak comes before.",
        "",
        _peak_after_top,
    ),
    Function(
        "heel_rise",
        "cm",
        _FAMILY,
        "How far the heels leave the floor. Never known: the network that looks at the pictures gives no points of the feet.",
        "",
        _feet_unseen,
    ),
)
