"""Standing long jump: crouch with the arms back, arms and legs swing up and forwards, heels far in front, knees give way."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.body.pose import t_pose
from models.motions import palms
from models.motions.actions.action import Action, Fault
from models.motions.motion import Attempt, Motion
from models.motions.natural import Natural
from models.motions.performance import Performance
from models.motions.ranges import beyond_deg
from models.motions.standing import TOES_OUT_DEG
from models.motions.subject import Subject
from models.motions.timeline import Side, Timeline, snapped
from models.motions.vocabulary import Arm, Body, Direction, Leg
from models.skeleton import coco_feet

FAULTS: Final = (
    Fault("no_arm_swing", "the arms do half of their swing; the jump is 10 % shorter"),
    Fault("stiff_landing", "lands on nearly straight legs, the feet 10 % of a leg nearer; the knees give way half as far"),
    Fault("no_crouch", "crouches a quarter of the standing height less deep before the push-off; the jump is 11 % shorter"),
    Fault("upright_takeoff", "takes off 13 degrees more upright and steeper; the jump is 15 % shorter"),
)
DISTANCE_OF_STATURE: Final = 0.98
"""Take-off line to heels: 1.33 m at a stature of 1.36 m, what pupils of 9 years jump."""
_STILL_S: Final = 0.3
_AIR_S, _AIR_FOR_M = 0.42, 1.33
"""Time in the air, for a jump of this distance."""
_LEG_M: Final = 0.64
"""Of whom the durations of push-off and landing are; others' go by the root of the leg's length."""
_SIDES: Final[tuple[Side, Side]] = ("left", "right")
_HANGING: Final = (0.02, 0.17, -1.0)
_BEYOND_DEG: Final = 1.5
"""What is let pass of hips that bend beyond their range."""
_ROUNDS: Final = 4


@dataclass(frozen=True)
class _Times:
    """Moments, seconds: arms up, lowest crouch, take-off, landing, the legs have given way, stands."""

    raised: float
    low: float
    off: float
    on: float
    deep: float
    end: float


def perform(performance: Performance, subject: Subject) -> Motion:
    """See `models.motions.perform.perform`. Nobody's trunk comes nearer to the thighs in landing than the hips bend."""
    upright_deg = 0.0
    for _ in range(_ROUNDS):
        motion = _jump(performance, subject, upright_deg)
        beyond = beyond_deg(motion, subject, "hip", 1)
        if beyond < _BEYOND_DEG:
            break
        upright_deg += 1.2 * beyond
    return motion


def _jump(performance: Performance, subject: Subject, upright_deg: float) -> Motion:
    """With the pelvis so much more upright after the landing."""
    natural, severity = Natural(performance), performance.severity
    no_swing, stiff, no_crouch, upright = (
        severity(name) for name in ("no_arm_swing", "stiff_landing", "no_crouch", "upright_takeoff")
    )
    line = Timeline(subject, performance.handed, natural)
    stature_m, size = subject.body.stature_m, float(np.sqrt(line.leg_m / _LEG_M))
    worse = (1 - 0.10 * no_swing) * (1 - 0.11 * no_crouch) * (1 - 0.15 * upright) * (1 - 0.02 * stiff)
    best_m = DISTANCE_OF_STATURE * stature_m * performance.amplitude * natural.times(0.05)
    far = (best_m * worse + _foot_m(subject)) / line.leg_m
    air = _AIR_S * float(np.sqrt(best_m / _AIR_FOR_M)) * (1 + 0.06 * upright - 0.04 * no_crouch)

    raised = snapped(_STILL_S + natural.seconds(0.45))
    low = snapped(raised + natural.seconds(0.62))
    off = snapped(low + 0.30 * size * (1 - 0.12 * no_crouch))
    on = snapped(off + air)
    deep = snapped(on + 0.35 * size)
    times = _Times(raised, low, off, on, deep, snapped(deep + natural.seconds(0.85)))

    line.stand(_STILL_S)
    crouch = 1 - 0.35 * no_crouch
    line.key(raised, Body(at=(0.05, 0.0), height=1.0, tip=-1, lean=-3, gaze=(0, 3)))
    line.key(low, Body(at=(0.03, 0.0), height=0.67 + 0.12 * no_crouch, tip=43 * crouch, lean=22 * crouch, gaze=(0, 12)))
    line.key(
        off,
        Body(
            at=(0.43 - 0.13 * upright, 0.0), height=0.92 + 0.045 * upright, tip=27 - 13 * upright, lean=4 - 3 * upright, gaze=(0, 5)
        ),
    )
    line.key(
        on,
        Body(
            at=(far - 0.80 + 0.10 * stiff, 0.0),
            height=0.61 + 0.07 * stiff,
            tip=4,
            lean=46 - 14 * stiff,
            gaze=(0, 15),
        ),
    )
    line.flight(off, on)
    line.key(on + 0.4 * (deep - on), Body(tip=-6 - upright_deg, lean=57 - 16 * stiff))
    line.key(
        deep,
        Body(
            at=(far - 0.04, 0.0), height=0.59 + 0.13 * stiff, tip=40 - 11 * stiff - upright_deg, lean=22 - 7 * stiff, gaze=(0, 15)
        ),
    )
    _swing_arms(line, times, max(0.0, 1 - 0.5 * no_swing))
    for side in _SIDES:
        _leap(line, side, times, far, 18 - 8 * stiff)
    line.stand(times.end, (far, 0.0))
    poses = line.poses(times.end + _STILL_S)
    for side in _SIDES:
        palms.settle(line.figure, side, 0.0, np.zeros(len(poses.times_s), bool), poses.pelvis_m, poses.local)
    heights = line.figure.centres_of_mass_m(line.figure.place_local(poses.pelvis_m, poses.local))[:, 2]
    top = float(poses.times_s[np.argmax(np.where((poses.times_s > off) & (poses.times_s < on), heights, -np.inf))])
    attempt = Attempt("long_jump", performance.handed, _STILL_S, low, top, times.end, tuple(performance.faults.items()))
    return line.wrapped(poses, (attempt,))


def _swing_arms(line: Timeline, times: _Times, share: float) -> None:
    """Up, back in the crouch, forwards and up with the push-off, to the front for the landing; or a share of that."""

    def arms(at_s: float, upper: Direction, bend: float, turn: float, fore: Direction) -> None:
        side = tuple(share * value + (1 - share) * hanging for value, hanging in zip(fore, (1.0, -0.15, 0.0), strict=True))
        line.arms(at_s, Arm(_on_the_way(upper, share), (side[0], side[1], side[2]), 14 + (bend - 14) * share, turn))

    arms(times.raised, (0.75, 0.2, 0.9), 14, 30, (1, -0.2, 0))
    arms((times.raised + times.low) / 2, (0.1, 0.3, -1), 14, 20, (1, -0.15, -0.3))
    arms(times.low - 0.02, (-0.75, 0.25, -0.6), 14, 20, (0.3, 0, -1))
    arms(times.low + 0.36 * (times.off - times.low), (0.1, 0.3, -1), 18, 25, (1, -0.15, 0))
    arms(times.off + 0.04, (0.55, 0.2, 1), 12, 30, (1, -0.2, 0))
    arms(times.on - 0.02, (1, 0.2, 0.05), 15, 40, (0, -0.3, 1))
    arms(times.deep, (1, 0.25, 0.05), 15, 40, (0, -0.3, 1))


def _on_the_way(upper: Direction, share: float) -> Direction:
    """A share of the arc from a hanging arm to this direction."""
    home, away = (np.array(direction) / np.linalg.norm(direction) for direction in (_HANGING, upper))
    angle = np.arccos(np.clip(home @ away, -1, 1))
    x, y, z = (np.sin((1 - share) * angle) * home + np.sin(share * angle) * away) / np.sin(angle)
    return float(x), float(y), float(z)


def _leap(line: Timeline, side: Side, times: _Times, far: float, heel_deg: float) -> None:
    """One leg: the foot unrolls, the knee is drawn up, the heel reaches to the front, the knee gives way."""
    low, off, on, air = times.low, times.off, times.on, times.on - times.off
    line.swing(side, off, on, (far, 0.0), yaw=TOES_OUT_DEG, pitch=-heel_deg, flat_s=0.07)
    for at_s, degrees in ((low, 0.0), (off - 0.45 * (off - low), 6.0), (off, 54.0)):
        line.pitch(at_s, side, degrees)
    for at_s, words in (
        (off + 0.08 * air, Leg(thigh=(-0.35, 0.05, -1), bend=22, toes=35)),
        (off + 0.45 * air, Leg(thigh=(1, 0.08, -0.25), bend=104, toes=0)),
        (off + 0.72 * air, Leg(thigh=(1, 0.08, 0.12), bend=62, toes=-8)),
        (on, Leg(thigh=(1, 0.08, -0.2), bend=26, toes=-5)),
    ):
        if side == "left":
            line.key(at_s, left_leg=words)
        else:
            line.key(at_s, right_leg=words)
    line.knee(times.deep, side, 6)
    line.knee(times.end, side, 0.0)


def _foot_m(subject: Subject) -> float:
    """From the heel to the big toe."""
    points = subject.body.coco_m(t_pose())
    return float(points[coco_feet.INDEX["left_big_toe"], 0] - points[coco_feet.INDEX["left_heel"], 0])


ACTION: Final = Action("long_jump", "Standing long jump", FAULTS, perform)
