"""Run: from standing to a quick run over some steps, and to a stand again. Trunk, arms and swinging legs go as a runner's did.

What the limbs do is a recording's (`models.motions.actions.run_cycle`); where the feet are put, and how the body flies between, is
computed for each pupil.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float
from models.motions import rotations, splines
from models.motions.actions.action import Action, Fault
from models.motions.actions.run_cycle import HARMONICS
from models.motions.motion import RATE_HZ, Attempt, Motion
from models.motions.natural import Natural
from models.motions.performance import Performance
from models.motions.standing import TOES_OUT_DEG
from models.motions.subject import Subject
from models.motions.timeline import Side, Timeline, snapped
from models.motions.vocabulary import Arm, Body, Leg

FAULTS: Final = (
    Fault("no_arm_drive", "the arms swing a quarter as far, with elbows less bent by a quarter"),
    Fault("no_knee_lift", "the thighs come forward a third as far, in low steps"),
    Fault("overstride", "the feet land on the heel, a sixth of a leg further in front of the body"),
    Fault("leans_back", "the trunk is held 16 degrees further back"),
)
_STILL_S: Final = 0.3
_LEG_M: Final = 0.64
"""Of whom the durations are; others' go by the root of the leg's length."""
_STEPS: Final = np.array(
    # time  stance ahead  tip
    (
        (0.36, 0.84, 0.34, 14),
        (0.32, 0.70, 0.38, 17),
        (0.30, 0.60, 0.41, 15),
        (0.29, 0.55, 0.43, 12),
        (0.29, 0.55, 0.43, 11),
        (0.29, 0.55, 0.43, 11),
        (0.29, 0.56, 0.46, 9),
        (0.30, 0.66, 0.56, 5),
        (0.34, 0.84, 0.66, 4),
        (0.38, 1.15, 0.72, 1),
        (0.42, 1.15, 1.00, 0),
    ),
)  # fmt: skip
"""Of each step: its duration in seconds, which share of the next step's duration its foot stands, which share of its way over the
foot the pelvis still has before it when the foot lands, and how far the pelvis is tipped to the front, degrees."""
_SPEED_LEGS_S: Final = 4.8
"""At full speed: 3.1 m/s for a leg of 0.64 m."""
_BRAKES: Final = 0.5
"""Steps that have more of their way before them slow him down."""
_FULL: Final = 3
"""The first step at full speed."""
_FASTEST: Final = 4
"""The step whose flight is the run's peak."""
_KNEE_LIFT: Final = 1.4
"""How much further the thighs come forward than the recorded runner's, who jogs; so do his arms hang, whose elbows a sprinter bends
by this much, and lets swing by this share of his:"""
_ELBOW_DEG, _RECORDED_ELBOW_DEG, _ELBOW_SHARE = 92.0, 78.0, 0.4
_HIP_BACK_RAD: Final = np.radians(34.0)
"""No hip lets its thigh go further behind the pelvis: in who leans back, the leg that pushed off rises less behind him."""
_FIST_DEG: Final = 62.0
_ON, _OFF = 0.48, 0.76
"""Phases of the cycle at which the left foot lands and leaves."""
_RECORDED_TIP_DEG: Final = 26.0
_SINKS: Final = 0.025
"""How much lower the pelvis is when an overstriding foot lands: a leg that reaches further to the front reaches less far down."""
_REACH, _LONGEST_STANCE = 0.44, 0.88
"""How far in front of the pelvis a foot can land, and how far the pelvis can go over a foot that stands, legs."""
_HEIGHTS: Final = (0.945, 0.955)
"""Of the pelvis, in its height when standing: as a foot lands and as it leaves."""


@dataclass(frozen=True, eq=False)
class _Footfalls:
    """When and where the feet are.

    Attributes:
        sides: of each footfall.
        on_s, off_s: it lands and leaves.
        places: along x from where that foot stood, legs.
        behind, before: of the pelvis, where it is as the foot lands and leaves, legs.
    """

    sides: tuple[Side, ...]
    on_s: Float
    off_s: Float
    places: Float
    behind: Float
    before: Float


def perform(performance: Performance, subject: Subject) -> Motion:
    """See `models.motions.perform.perform`."""
    natural = Natural(performance)
    line = Timeline(subject, performance.handed, natural)
    falls = _footfalls(performance, natural, line.leg_m)
    count = len(falls.on_s)
    end = snapped(falls.on_s[-1] + natural.seconds(0.75))

    line.stand(_STILL_S)
    over = _overstride(performance)
    _put_feet(line, falls, over)
    for number in range(count):
        for at_s, x, height in (
            (falls.on_s[number], falls.behind[number], _HEIGHTS[0] - _SINKS * over * (1 <= number < count - 2)),
            (falls.off_s[number], falls.before[number], _HEIGHTS[1]),
        ):
            if number < count - 2 or at_s == falls.on_s[number]:
                line.key(at_s, Body(at=(float(x), 0.0), height=height))
        if number + 1 < count and falls.off_s[number] < falls.on_s[number + 1]:
            line.flight(float(falls.off_s[number]), float(falls.on_s[number + 1]))
    _swing_limbs(line, falls, performance)
    line.stand(end, (float(falls.places[-1]), 0.0))
    middle = (falls.off_s[_FASTEST] + falls.on_s[_FASTEST + 1]) / 2
    attempt = Attempt(
        "run", performance.handed, _STILL_S, float(falls.on_s[_FULL]), snapped(float(middle)), end,
        tuple(performance.faults.items()),
    )  # fmt: skip
    return line.motion(end + _STILL_S, (attempt,))


def _overstride(performance: Performance) -> float:
    """Severity, up to where a leg can reach no further."""
    return min(performance.severity("overstride"), 1.1)


def _footfalls(performance: Performance, natural: Natural, leg_m: float) -> _Footfalls:
    times, stance, ahead, _ = _STEPS.T
    times = times * np.sqrt(leg_m / _LEG_M) * natural.seconds(1.0)
    snap = np.vectorize(snapped)
    on = snap(_STILL_S + np.cumsum(times))
    off = snap(on + stance * np.append(times[1:], times[-1]))
    speed = _SPEED_LEGS_S * np.sqrt(_LEG_M / leg_m) * performance.amplitude**0.35 * performance.tempo * natural.times(0.04)
    at_s = np.arange(_STILL_S, on[-1] + 0.5 * times[-1], 1 / RATE_HZ)
    first, last = on[0] - 0.6 * times[0], at_s[-1]
    faster = splines.minimum_jerk((at_s - first) / (on[_FULL] + 0.3 * times[_FULL] - first))
    slows = on[_FASTEST + 1] + 0.6 * times[_FASTEST]
    slower = splines.minimum_jerk((at_s - slows) / (last - slows))
    run = np.cumsum(speed * (faster - slower)) / RATE_HZ
    behind = np.interp(on, at_s, run)
    off = np.minimum(off, snap(np.interp(behind + _LONGEST_STANCE, run, at_s)))
    before = np.interp(off, at_s, run)
    ahead = ahead + 0.18 * _overstride(performance) * (ahead < _BRAKES)
    places = behind + np.minimum(ahead * (before - behind), _REACH)
    places[-2:] = run[-1]
    sides: tuple[Side, ...] = tuple("right" if number % 2 == 0 else "left" for number in range(len(on)))
    return _Footfalls(sides, on, off, places, np.asarray(behind), np.asarray(before))


def _put_feet(line: Timeline, falls: _Footfalls, over: float) -> None:
    """Both feet from the first lift to where they stand side by side in the end."""
    count = len(falls.on_s)
    lifts: dict[Side, float] = {"right": _STILL_S + 0.06, "left": float(falls.on_s[0]) + 0.03}
    line.pitch(_STILL_S, "left", 0.0)
    line.pitch(lifts["left"] - 0.16, "left", 0.0)
    for number in range(count):
        side = falls.sides[number]
        lift, land = lifts[side], float(falls.on_s[number])
        yaw = TOES_OUT_DEG if number >= count - 2 else 4.0
        heel = -12.0 * over if 1 <= number < count - 2 else 0.0
        if number in {0, count - 1}:
            line.step(
                side,
                lift,
                land,
                (float(falls.places[number]), 0.0),
                yaw=TOES_OUT_DEG,
                height=0.12,
                pitch=heel,
                heel=30.0 * (number > 0),
            )
        else:
            line.swing(side, lift, land, (float(falls.places[number]), 0.0), yaw=yaw, pitch=heel, flat_s=0.05)
            line.pitch(lift, side, 50.0)
        if number < count - 2:
            off = float(falls.off_s[number])
            line.pitch(land + 0.45 * (off - land), side, 4.0)
            lifts[side] = off


def _phase(falls: _Footfalls, at_s: Float) -> Float:
    """(T,) phase of the left side, in cycles: even from each landing to that foot's leaving, and on to the next landing."""
    knots: dict[float, float] = {}
    for number in range(len(falls.sides)):
        cycle = (number - 1) / 2
        knots[float(falls.on_s[number])] = cycle + _ON
        if number + 1 == len(falls.sides) or falls.off_s[number] < falls.on_s[number + 1]:
            knots[float(falls.off_s[number])] = cycle + _OFF
    times = np.array(sorted(knots))
    values = np.array([knots[at] for at in times])
    return np.asarray(np.interp(at_s, times, values))


def _swing_limbs(line: Timeline, falls: _Footfalls, performance: Performance) -> None:
    """Trunk and arms all the time, legs while they are in the air."""
    start, stop = float(falls.on_s[0]), float(falls.on_s[-2])
    at_s = np.arange(start, stop, (falls.on_s[_FULL + 2] - falls.on_s[_FULL]) / 12)
    phases = _phase(falls, at_s)
    back = performance.severity("leans_back")
    tips = np.interp(at_s, falls.on_s, _STEPS[:, 3]) - 4 * back
    drive = max(0.0, 1 - 0.75 * performance.severity("no_arm_drive"))
    for number, when in enumerate(at_s):
        left, right = float(phases[number]), float(phases[number]) + 0.5
        fade = float(np.clip(min(when - start, stop - when) / 0.35, 0.0, 1.0))
        turn = np.degrees(_wave("pelvis", 2, left)) * fade
        side = np.degrees(_wave("pelvis", 0, left)) * fade
        body = Body(
            tip=float(tips[number]),
            lean=6.0 - 12 * back,
            facing=turn,
            side=0.6 * side,
            bow=-0.6 * side,
            twist=-1.6 * turn,
            gaze=(0.0, 6.0),
        )
        line.key(
            float(when),
            body,
            left_arm=_arm(left, drive * (0.4 + 0.6 * fade), drive),
            right_arm=_arm(right, drive * (0.4 + 0.6 * fade), drive),
            left_leg=_leg(left, float(tips[number]), performance),
            right_leg=_leg(right, float(tips[number]), performance),
        )


def _wave(joint: str, component: int, phase: float) -> float:
    """A component of a rotation vector at a phase of the recorded cycle."""
    mean, *waves = HARMONICS[joint][component]
    angles = 2 * np.pi * phase * np.arange(1, len(waves) // 2 + 1)
    return float(mean + np.cos(angles) @ waves[::2] + np.sin(angles) @ waves[1::2])


def _turn(joint: str, phase: float) -> Float:
    return rotations.matrices(np.array([_wave(f"left_{joint}", component, phase) for component in range(3)]))


def _arm(phase: float, share: float, bent: float) -> Arm:
    """The recorded left arm; `share` of its swing about its mean."""
    away = np.array((0.0, 1.0, 0.0))
    upper = _turn("shoulder", phase) @ away
    mean = np.mean([_turn("shoulder", at) @ away for at in np.arange(8) / 8], axis=0)
    elbow = _turn("elbow", phase)
    fore = _turn("shoulder", phase) @ elbow @ away
    recorded = np.degrees(np.arccos(np.clip(upper @ fore, -1.0, 1.0)))
    bend = _ELBOW_DEG + _ELBOW_SHARE * (recorded - _RECORDED_ELBOW_DEG)
    aside = fore - (upper @ fore) * upper
    x, y, z = mean + share * (upper - mean)
    return Arm(
        (float(x), float(y), float(z)),
        (float(aside[0]), float(aside[1]), float(aside[2])),
        float(bend * (0.66 + 0.34 * bent)),
        turn=10.0,
        wrist=0.0,
        cock=0.0,
        curl=20.0 + (_FIST_DEG - 20.0) * bent,
    )


def _leg(phase: float, tip_deg: float, performance: Performance) -> Leg:
    """The recorded left leg under a pelvis that is tipped less than the recorded one."""
    more = np.radians(_RECORDED_TIP_DEG - tip_deg)
    thigh = rotations.about(1, np.asarray(more)) @ _turn("hip", phase) @ np.array((0.0, 0.0, -1.0))
    lifts = max(1 - 0.68 * performance.severity("no_knee_lift"), 0.0)
    angle = float(np.arctan2(thigh[0], -thigh[2]))
    angle *= _KNEE_LIFT * lifts if angle > 0 else 1.0
    angle = max(angle, -_HIP_BACK_RAD)
    return Leg(
        thigh=(float(np.sin(angle)), 0.04, -float(np.cos(angle))),
        bend=float(np.degrees(_wave("left_knee", 1, phase))) * (0.4 + 0.6 * lifts) + 5,
        toes=float(np.clip(np.degrees(_wave("left_ankle", 1, phase)), -12, 28)),
    )


ACTION: Final = Action("run", "Run", FAULTS, perform)
