"""When a jump leaves the floor, when it lands, and how the centre of mass flies between.

The pose network sees no feet, so nothing says directly when toes leave the floor. What does is how far the ankles have risen above
where they are when the foot is flat: at take-off the foot is stretched, and with it the ankle is up by nearly the same share of the
stature in everybody (measured on drop jumps over a force plate: 4.9 to 7.2 %, two thirds within 0.7 %; a landing on the balls of
the feet 3.0 to 5.7 %); a landing on the heels, with the feet far in front, comes with the ankles as low as they were. In the air
the centre of mass moves as all that falls does, which gives its highest point from many frames.
"""

import math
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.motions.ballistics import GRAVITY_M_S2
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.measured import HIDDEN
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.mass import COM_SOURCE
from services.evaluation.signals.posture import Posture, SideAsked
from services.evaluation.signals.reading import Reading
from services.evaluation.signals.series import Series
from services.evaluation.signals.signal import Signal
from services.evaluation.signals.stretch import sample

NO_FLIGHT: Final = "both feet did not leave the floor"
_OFF_PCT: Final = 5.7
_ON_PCT: Final = 4.5
_HEELS_ON_PCT: Final = 1.0
"""Of the stature, by which the ankles have risen when the toes leave the floor; when the balls of the feet, or the heels, land."""
_HEELS_FROM_PCT, _HEELS_AT_PCT = 8.0, 20.0
"""Ankles so far in front of the hips begin to mean, and mean, that the heels land first."""
MOMENT_SIGMA_S: Final = 0.013
"""Of take-off and of landing: what people differ in, 0.7 % of the stature, at the speed of a take-off, and the smoother."""
_SHORTEST_S: Final = 0.12
_FLAT_QUANTILE: Final = 0.1
_MARGIN_S: Final = 0.25
_FALLS: Final = 0.6
"""Whoever falls with less than so much of gravity is borne by something: hands, or a foot."""
_BENDS_FROM: Final = 5
_HALVES: Final = 8
"""Of a frame: a tenth of a millisecond."""
_INSIDE: Final = 0.15
"""Share of a flight, at each of its ends, in which smoothing has rounded its parabola."""
_SIDES: Final[tuple[SideAsked, SideAsked]] = ("left", "right")


def _com(axis: int, body: Posture) -> Float:
    return 100 * body.centre_of_mass()[..., axis]


def _ankle(axis: int, body: Posture) -> Float:
    return 100 * body.own("ankle")[..., axis]


COM_CM: Final = tuple(
    Signal(f"com_{axis}", "cm", "Centre of mass in the room.", partial(_com, number), COM_SOURCE)
    for number, axis in enumerate("xyz")
)
ANKLE_CM: Final = tuple(
    Signal(f"ankle_{axis}", "cm", "Ankle in the room.", partial(_ankle, number), sided=True) for number, axis in enumerate("xyz")
)


@dataclass(frozen=True, eq=False)
class Flight:
    """A jump.

    Attributes:
        off_s, on_s: the last foot leaves the floor, the first one lands.
        feet_on_s: left and right foot land; NaN if one does not.
        feet_off_s: left and right foot leave the floor for the last time before the top.
        top_s, top_cm: highest point of the centre of mass, from the parabola.
        speed_cm_s: (2,) of the centre of mass along the floor.
        flat_cm: height of the left and the right ankle while the foot is flat.
        off_sigma_s, on_sigma_s: of the moments at which feet leave the floor and land, of the less sure foot; NaN where an ankle,
            whose height tells them, was not seen then.
        seen: whether the joints were while the body was in the air.
    """

    off_s: float
    on_s: float
    feet_on_s: tuple[float, float]
    feet_off_s: tuple[float, float]
    top_s: float
    top_cm: float
    speed_cm_s: Float
    flat_cm: tuple[float, float]
    off_sigma_s: float
    on_sigma_s: float
    seen: bool

    @property
    def rise_cm(self) -> float:
        """Of the centre of mass from take-off to the top."""
        return 100 * GRAVITY_M_S2 * (self.top_s - self.off_s) ** 2 / 2

    @property
    def up_cm_s(self) -> float:
        """Speed at take-off, upwards."""
        return 100 * GRAVITY_M_S2 * (self.top_s - self.off_s)


def flight_of(reading: Reading, attempt: FoundAttempt) -> Flight | str:
    """The flight of an attempt, or why there is none."""
    start_s, _, _, end_s = attempt.moments_s
    ankles = [reading.of(ANKLE_CM[2], side) for side in _SIDES]
    ahead = reading.of(CATALOGUE["ankle_forward"], "both")
    within = _inside(ahead, start_s, end_s)
    both_cm = np.where(within, np.minimum(ankles[0].value, ankles[1].value), np.nan)
    if not np.isfinite(both_cm).any():
        return HIDDEN
    top_s = float(ahead.t_s[int(np.nanargmax(both_cm))])
    stature_cm = 100 * reading.stature.metres
    flats, offs, ons = [], [], []
    for ankle in ankles:
        flat_cm = _flat_cm(ankle, start_s, end_s)
        flats.append(flat_cm)
        offs.append(_crossing(ankle, top_s, -1, flat_cm + _OFF_PCT * stature_cm / 100, start_s - _MARGIN_S))
        ons.append(_landing(ankle, ahead, top_s, flat_cm, stature_cm, end_s + _MARGIN_S))
    if not np.isfinite([*offs, *ons]).all():
        return NO_FLIGHT if np.isfinite(both_cm[within]).all() else HIDDEN
    off_s, on_s = max(offs), min(ons)
    if on_s - off_s < _SHORTEST_S:
        return NO_FLIGHT
    return _fitted(reading, (off_s, on_s), (ons[0], ons[1]), (offs[0], offs[1]), (flats[0], flats[1]))


def _fitted(
    reading: Reading, ends_s: tuple[float, float], ons: tuple[float, float], offs: tuple[float, float], flats: tuple[float, float]
) -> Flight | str:
    """The parabola of the frames that are in the air for certain."""
    off_s, on_s = ends_s
    series = [reading.of(signal, "lead") for signal in COM_CM]
    t_s = series[2].t_s
    margin_s = _INSIDE * (on_s - off_s)
    inside = (t_s >= off_s + margin_s) & (t_s <= on_s - margin_s) & np.isfinite(series[2].value)
    if np.count_nonzero(inside) < 3:
        return HIDDEN
    middle_s = (off_s + on_s) / 2
    since_s = t_s[inside] - middle_s
    fallen_cm = 100 * GRAVITY_M_S2 / 2 * since_s**2
    if np.count_nonzero(inside) >= _BENDS_FROM and np.polyfit(since_s, series[2].value[inside], 2)[0] > -_FALLS * 50 * GRAVITY_M_S2:
        return NO_FLIGHT
    up_cm_s, height_cm = np.polyfit(since_s, series[2].value[inside] + fallen_cm, 1)
    speeds = np.array([np.polyfit(since_s, one.value[inside], 1)[0] for one in series[:2]])
    later_s = float(up_cm_s) / (100 * GRAVITY_M_S2)
    fast_cm_s = max(abs(float(up_cm_s)) + 50 * GRAVITY_M_S2 * (on_s - off_s), 50.0)
    off_sigma_s, on_sigma_s = (math.hypot(MOMENT_SIGMA_S, _ankles_sigma_cm(reading, feet) / fast_cm_s) for feet in (offs, ons))
    top_cm = float(height_cm) + 50 * GRAVITY_M_S2 * later_s**2
    seen = series[2].enough_seen(inside)
    return Flight(off_s, on_s, ons, offs, middle_s + later_s, top_cm, speeds, flats, off_sigma_s, on_sigma_s, seen)


def _ankles_sigma_cm(reading: Reading, feet_s: tuple[float, float]) -> float:
    """Of the heights of the left and the right ankle at an instant each, the larger one; NaN where either was not seen."""
    sigmas = []
    for side, at_s in zip(_SIDES, feet_s, strict=True):
        ankle = reading.of(ANKLE_CM[2], side)
        weights = sample(ankle, at_s).weights
        sigmas.append(math.sqrt(ankle.variance(weights)) if ankle.seen[weights != 0].all() else math.nan)
    return float(np.max(sigmas))


def _landing(ankle: Series, ahead: Series, top_s: float, flat_cm: float, stature_cm: float, latest_s: float) -> float:
    """First on the balls of the feet; if the feet are far in front then, on the heels."""
    balls_s = _crossing(ankle, top_s, 1, flat_cm + _ON_PCT * stature_cm / 100, latest_s)
    if not math.isfinite(balls_s):
        return balls_s
    front_pct = sample(ahead, balls_s).value
    heels = min(max((front_pct - _HEELS_FROM_PCT) / (_HEELS_AT_PCT - _HEELS_FROM_PCT), 0.0), 1.0)
    on_pct = _ON_PCT + heels * (_HEELS_ON_PCT - _ON_PCT)
    return _crossing(ankle, top_s, 1, flat_cm + on_pct * stature_cm / 100, latest_s)


def _crossing(series: Series, from_s: float, way: int, level: float, limit_s: float) -> float:
    """The first instant, forwards or backwards in time, at which a series is not above a level any more; NaN if it stays above."""
    frame = (from_s - float(series.t_s[0])) / series.frame_s
    here = math.ceil(frame) if way > 0 else math.floor(frame)
    while 0 <= here - way < len(series) and 0 <= here < len(series) and (series.t_s[here] - limit_s) * way <= 0:
        value = float(series.value[here])
        if not math.isfinite(value):
            return math.nan
        if value <= level:
            return _between(series, float(series.t_s[here]), float(series.t_s[here - way]), level)
        here += way
    return math.nan


def _between(series: Series, below_s: float, above_s: float, level: float) -> float:
    """Where a series crosses a level between two neighbouring frames: by halves, on its cubic."""
    for _ in range(_HALVES):
        middle_s = (below_s + above_s) / 2
        if sample(series, middle_s).value <= level:
            below_s = middle_s
        else:
            above_s = middle_s
    return (below_s + above_s) / 2


def _flat_cm(ankle: Series, start_s: float, end_s: float) -> float:
    """Height of an ankle over a flat foot: what it is seldom below."""
    values = ankle.value[_inside(ankle, start_s - _MARGIN_S, end_s + _MARGIN_S)]
    known = values[np.isfinite(values)]
    return float(np.quantile(known, _FLAT_QUANTILE)) if len(known) else math.nan


def _inside(series: Series, from_s: float, to_s: float) -> Bool:
    return np.asarray((series.t_s >= from_s) & (series.t_s <= to_s))
