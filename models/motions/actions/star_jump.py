"""Star jump: from a crouch into the air, arms and legs spread to a star at the highest point, landing with the feet together."""

from typing import Final

import numpy as np

from models.motions.actions.action import Action, Fault
from models.motions.ballistics import GRAVITY_M_S2, airborne_s, push_off_s, take_off_m_s
from models.motions.motion import Attempt, Motion
from models.motions.natural import Natural
from models.motions.performance import Performance
from models.motions.standing import TOES_OUT_DEG
from models.motions.subject import Subject
from models.motions.timeline import Side, Timeline, snapped
from models.motions.vocabulary import Arm, Body, Leg

FAULTS: Final = (
    Fault("arms_half", "the arms are raised 42 % less, to the level of the shoulders"),
    Fault("legs_together", "the legs spread 45 % less"),
    Fault("out_of_time", "the arms come 0.13 s after the legs"),
    Fault("stiff_landing", "lands on nearly straight legs: the hips give way 10 % of their height less"),
)
_STILL_S: Final = 0.3
_HEIGHT_OF_STATURE: Final = 0.165
"""How far the centre of mass flies up: 22 cm at 1.36 m, which is what pupils of 9 years reach from a crouch."""
_CROUCH, _TOES, _LAND, _DEEP = 0.70, 1.05, 0.95, 0.76
"""Height of the pelvis, in its height when standing: in the crouch, at take-off, as the toes land, when the legs gave way."""
_STANDING_LEGS: Final = 1.12
"""The pelvis' height when standing, in legs."""
_SIDES: Final[tuple[Side, Side]] = ("left", "right")


def perform(performance: Performance, subject: Subject) -> Motion:
    """See `models.motions.perform.perform`."""
    natural, severity = Natural(performance), performance.severity
    half, together, late, stiff = (severity(name) for name in ("arms_half", "legs_together", "out_of_time", "stiff_landing"))

    line = Timeline(subject, performance.handed, natural)
    standing_m = line.leg_m * _STANDING_LEGS
    height_m = _HEIGHT_OF_STATURE * subject.body.stature_m * performance.amplitude * natural.times(0.06)
    landing = _LAND + 0.012 * stiff
    drop_m = (_TOES - landing) * standing_m
    air = airborne_s(height_m, drop_m)
    push = 1.25 * push_off_s((_TOES - _CROUCH) * standing_m, take_off_m_s(air, -drop_m))

    begin = _STILL_S
    low = snapped(begin + natural.seconds(0.6))
    off = snapped(low + push)
    top = snapped(off + float(np.sqrt(2 * height_m / GRAVITY_M_S2)))
    on = snapped(off + air)
    deep = on + 0.24
    end = snapped(deep + natural.seconds(0.75))

    line.stand(begin)
    line.key(low, Body(at=(0.0, 0.0), height=_CROUCH, tip=34, lean=14, gaze=(0, 8)))
    line.key(off, Body(at=(0.02, 0.0), height=_TOES, tip=1, lean=-2, gaze=(0, 0)))
    line.key(on, Body(at=(0.0, 0.0), height=landing, tip=5, lean=4, gaze=(0, 8)))
    line.flight(off, on)
    line.key(deep, Body(at=(0.0, 0.0), height=_DEEP + 0.10 * stiff, tip=30 - 11 * stiff, lean=12 - 5 * stiff, gaze=(0, 8)))
    _spread_arms(line, (low, off, top, on, deep), 0.13 * late, 1 - 0.42 * half)
    for side in _SIDES:
        _spread_leg(line, side, (low, off, top, on), 34 * (1 - 0.45 * together) * performance.amplitude**0.5)
        line.knee(deep, side, 5)
        line.knee(end, side, 0.0)
    line.stand(end)
    attempt = Attempt("star_jump", performance.handed, begin, low, top, end, tuple(performance.faults.items()))
    return line.motion(end + _STILL_S, (attempt,))


def _spread_arms(line: Timeline, times_s: tuple[float, ...], late_s: float, share: float) -> None:
    """Swung up with the push, spread at the top, down again for the landing."""
    low, off, top, on, deep = times_s
    up = np.radians(4 + 134 * share)
    line.arms(low, Arm(upper=(-0.35, 0.15, -1), fore=(1, -0.15, 0.1), bend=35, turn=20))
    line.arms(off - 0.02 + late_s, Arm(upper=(0.45, 0.75, -0.35), fore=(0.8, 0, 0.6), bend=25, turn=30))
    line.arms(top + late_s, Arm(upper=(0.0, float(np.sin(up)), float(-np.cos(up))), fore=(0.6, -0.3, 0.6), bend=5, turn=45))
    line.arms(on + 0.04 + late_s, Arm(upper=(0.3, 0.55, -0.75), fore=(1, -0.15, 0.2), bend=25, turn=20))
    line.arms(deep + late_s, Arm(upper=(0.35, 0.35, -0.9), fore=(1, -0.15, 0.2), bend=30, turn=20))


def _spread_leg(line: Timeline, side: Side, times_s: tuple[float, ...], spread_deg: float) -> None:
    low, off, top, on = times_s
    out = np.radians(spread_deg)
    line.swing(side, off, on, (0.0, 0.0), yaw=TOES_OUT_DEG, pitch=40, flat_s=0.1)
    for at_s, degrees in ((low, 0.0), (off - 0.45 * (off - low), 4.0), (off, 52.0)):
        line.pitch(at_s, side, degrees)
    for at_s, words in (
        (off + 0.04, Leg(thigh=(0.0, 0.06, -1), bend=8, toes=40)),
        (top, Leg(thigh=(0.0, float(np.sin(out)), float(-np.cos(out))), bend=4, turn=12, toes=35)),
        (on - 0.03, Leg(thigh=(0.45, 0.03, -1), bend=52, turn=7, toes=18)),
    ):
        if side == "left":
            line.key(at_s, left_leg=words)
        else:
            line.key(at_s, right_leg=words)


ACTION: Final = Action("star_jump", "Star jump", FAULTS, perform)
