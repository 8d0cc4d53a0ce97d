"""Squat: down until the thighs are level, arms to the front, heels down, and up again."""

from typing import Final

import numpy as np

from models.motions.actions.action import Action, Fault
from models.motions.motion import Attempt, Motion
from models.motions.natural import Natural
from models.motions.performance import Performance
from models.motions.ranges import beyond_deg
from models.motions.subject import Subject
from models.motions.timeline import Side, Timeline, snapped
from models.motions.vocabulary import Arm, Body

FAULTS: Final = (
    Fault("knees_in", "the knees fall in: their planes turn 30 degrees inwards"),
    Fault("heels_up", "the heels leave the floor by 24 degrees of the foot"),
    Fault("back_rounded", "the back is rounded by 42 degrees"),
    Fault("trunk_forward", "the trunk tips 12 degrees further to the front"),
    Fault("too_shallow", "the hips sink 30 % less"),
)
_STILL_S: Final = 0.3
_SIDES: Final[tuple[Side, Side]] = ("left", "right")
_BEYOND_DEG: Final = 1.5
"""What is let pass of a joint beyond its range."""
_ROUNDS: Final = 6
_HIGHER_A_DEG: Final = 0.008
"""Of the depth that the hips do not give, for each degree."""
_DEPTH: Final = 0.41
"""How far the pelvis sinks, of its height when standing: a knee bent to 110 degrees, the weight over the feet."""


def perform(performance: Performance, subject: Subject) -> Motion:
    """See `models.motions.perform.perform`. Nobody sinks deeper than his hips bend, nor turns his knees in beyond his ankles."""
    higher, less_in_deg = 0.0, 0.0
    for _ in range(_ROUNDS):
        motion = _squat(performance, subject, higher, less_in_deg)
        hips, ankles = beyond_deg(motion, subject, "hip", 1), beyond_deg(motion, subject, "ankle", 2)
        if max(hips, ankles) < _BEYOND_DEG:
            break
        higher, less_in_deg = higher + _HIGHER_A_DEG * hips, less_in_deg + ankles
    return motion


def _squat(performance: Performance, subject: Subject, higher: float, less_in_deg: float) -> Motion:
    natural, severity = Natural(performance), performance.severity
    knees_in, heels_up = severity("knees_in"), severity("heels_up")
    rounded, forward, shallow = severity("back_rounded"), severity("trunk_forward"), severity("too_shallow")

    depth = _DEPTH * performance.amplitude * natural.times(0.04) * (1 - 0.3 * shallow) * (1 - higher)
    share = depth / _DEPTH
    tip = (44 + 12 * forward) * share**0.7 - 14 * rounded
    lean = 42 * rounded
    begin = _STILL_S
    bottom = snapped(begin + natural.seconds(1.0))
    rise = bottom + natural.seconds(0.12)
    end = snapped(rise + natural.seconds(0.9))

    line = Timeline(subject, performance.handed, natural)
    line.stand(begin)
    back = -0.27 * share + 0.02 * forward + 0.06 * heels_up
    low = Body(at=(back, 0.0), height=1 - depth, tip=tip, lean=lean, bow=0, gaze=(0, 8 + 25 * rounded))
    for at_s in (bottom, rise):
        line.key(at_s, low)
        for side in _SIDES:
            line.knee(at_s, side, 10 - max(0.0, 30 * knees_in - less_in_deg))
            line.pitch(at_s, side, 24 * heels_up)
    for at_s in (begin, end):
        for side in _SIDES:
            line.knee(at_s, side, 0.0)
            line.pitch(at_s, side, 0.0)
    reach = _in_front(tip + lean)
    line.arms(begin + 0.75 * (bottom - begin), reach)
    line.arms(rise + 0.3 * (end - rise), reach)
    line.stand(end)
    starts_down = snapped(begin + 0.3 * (bottom - begin))
    attempt = Attempt("squat", performance.handed, begin, starts_down, bottom, end, tuple(performance.faults.items()))
    return line.motion(end + _STILL_S, (attempt,))


def _in_front(trunk_deg: float) -> Arm:
    """Level before the shoulders, whatever the trunk leans."""
    up = np.radians(min(trunk_deg, 80.0))
    return Arm(upper=(float(np.cos(up)), 0.05, float(np.sin(up))), fore=(0.0, -0.6, 0.8), bend=6, turn=60)


ACTION: Final = Action("squat", "Squat", FAULTS, perform)
