"""Volleyball: an approach of three steps, a jump from both feet, and a spike near its top."""

from typing import Final

import numpy as np

from models.errors import UserError
from models.motions.actions.action import Action, Fault
from models.motions.ballistics import GRAVITY_M_S2, airborne_s, push_off_s, take_off_m_s, thrown
from models.motions.figure import Placed
from models.motions.flights import bouncing, held, spinning
from models.motions.motion import RATE_HZ, Attempt, Motion, Thing
from models.motions.natural import Natural
from models.motions.performance import Performance
from models.motions.ranges import beyond_deg
from models.motions.subject import Subject
from models.motions.things import VOLLEYBALL_RADIUS_M
from models.motions.timeline import Timeline, snapped
from models.motions.vocabulary import Arm, Body, Leg, Side
from models.skeleton import smpl

FAULTS: Final = (
    Fault(
        "arm_not_back",
        "the hitting arm is not drawn back: its elbow stays in front of the shoulder, which does not turn back either",
    ),
    Fault("hit_behind", "the ball is hit behind the head instead of a forearm's length in front of it"),
    Fault("late_hit", "the ball is hit 0.1 s after the top of the jump, on the way down"),
    Fault("one_foot_landing", "the landing is on one foot; the other one follows 0.16 s later"),
)
_SETTER_M: Final = np.array((1.3, 1.6, 0.0))
"""From below the hit to where the set comes from, along and across."""
_SET_S: Final = 0.95
_SPIKED_M_S: Final = np.array((13.0, 0.6, -4.0))
_AIRBORNE_S: Final = 0.43
"""For which the arms' times are said; who is in the air for less is as much quicker."""
_LANDING: Final = 1.62
"""Where the feet land, in leg lengths from the start."""
_DIP: Final = 0.82
_TIPTOE: Final = 1.08
_LOWER: Final = 0.035
"""Heights of the pelvis: in the crouch, at the take-off, and by how much it lands lower than that."""
BEYOND_DEG: Final = 1.5
"""What is let pass of a shoulder beyond its range."""
_FURTHEST_BACK: Final = 1.05
"""Of the severity of `hit_behind`, what an arm shows of it."""
_ROUNDS: Final = 12
_LESS_BACK_A_DEG: Final = 0.08
_LESS_UP_A_DEG: Final = 0.04
"""Of the severity with which the hitting arm is back, and of the other arm's height, for each degree that a shoulder lacks."""


def perform(performance: Performance, subject: Subject) -> Motion:
    """See `models.motions.perform.perform`. Nobody's arms go further back or up than his shoulders turn.

    So of `hit_behind` the arm shows as much as its shoulder lets it, and from `_FURTHEST_BACK` on no more; only the trunk goes on
    leaning. The attempt is called by the severity that was asked for, as all attempts are.

    Raises:
        UserError: no such performance was found.
    """
    hitting = performance.handed
    other: Side = "left" if hitting == "right" else "right"
    behind = min(performance.severity("hit_behind"), _FURTHEST_BACK)
    less_back = less_up = back = up = 0.0
    for _ in range(_ROUNDS):
        motion = _spike(performance, subject, less_back, less_up)
        back, up = (beyond_deg(motion, subject, "shoulder", 1, sides=(side,)) for side in (hitting, other))
        if (back < BEYOND_DEG or less_back >= behind) and up < BEYOND_DEG:
            return motion
        less_back, less_up = less_back + _LESS_BACK_A_DEG * back, less_up + _LESS_UP_A_DEG * up
    raise UserError(
        f"volleyball_spike: the shoulders of somebody of {subject.age_years:.0f} would turn {max(back, up):.1f} degrees too far; "
        "ask for less of hit_behind, or a smaller amplitude"
    )


def _spike(performance: Performance, subject: Subject, less_back: float, less_up: float) -> Motion:
    natural = Natural(performance)
    line = Timeline(subject, performance.handed, natural)
    forward, behind, late, single = (performance.severity(fault.name) for fault in FAULTS)
    amplitude = performance.amplitude
    airborne = airborne_s(0.28 * line.leg_m * amplitude, _LOWER * line.leg_m)
    rise = (_TIPTOE - _DIP) * line.leg_m
    push = push_off_s(rise, take_off_m_s(airborne, -_LOWER * line.leg_m))

    start = 0.2
    first = start + natural.seconds(0.4)
    second = first + natural.seconds(0.34)
    third = second + natural.seconds(0.22)
    bottom = third + 0.03
    off = snapped(bottom + push)
    on = snapped(off + airborne)
    top = off + airborne / 2
    hit = snapped(top + 0.01 + 0.24 * airborne * late)
    settled = on + natural.seconds(0.26)
    end = settled + natural.seconds(0.9)

    _approach(line, (start, first, second, third, bottom, off, on, settled, end), single)
    _flight(line, (off, top, on), single)
    _trunk(line, (first, second, bottom, off, hit, on, settled), forward, behind)
    _arms(line, (first, second, bottom, off, hit, on, settled), (forward, behind), less_back, less_up)
    line.stand(end, (_LANDING, 0.0))
    poses = line.poses(end + 0.15)
    placed = line.figure.place_local(poses.pelvis_m, poses.local)
    attempt = Attempt("volleyball_spike", performance.handed, start, bottom, hit, end, tuple(performance.faults.items()))
    return line.wrapped(poses, (attempt,), (_ball(line, placed, hit),))


def _approach(line: Timeline, times: tuple[float, ...], single: float) -> None:
    start, first, second, third, bottom, off, on, settled, end = times
    line.step("left", start + 0.08, first, (0.5, 0.0), yaw=4, height=0.09, pitch=-12, heel=20)
    line.step("right", first + 0.05, second, (1.16, -0.04), yaw=14, height=0.1, pitch=-14, heel=44)
    line.step("left", second + 0.01, third, (1.27, 0.06), yaw=-14, height=0.07, pitch=6, flat_s=0.08, heel=46)
    line.stand(start - 0.05)
    line.key(first, Body(at=(0.36, 0.02), height=0.96, gaze=(8, -16)))
    line.key(second, Body(at=(0.82, 0.0), height=0.88, gaze=(6, -26)))
    line.key(bottom, Body(at=(1.13, 0.0), height=_DIP))
    line.key(off, Body(at=(1.3, 0.0), height=_TIPTOE))
    line.key(on, Body(at=(1.6, 0.06 * min(single, 1.5)), height=_TIPTOE - _LOWER))
    line.key(settled, Body(at=(1.63, 0.05 * min(single, 1.5)), height=0.85))
    line.key(end - 0.35, Body(gaze=(0, -5)))


def _flight(line: Timeline, times: tuple[float, ...], single: float) -> None:
    off, top, on = times
    line.flight(off, on)
    line.swing("left", off, on, (_LANDING, 0.0), yaw=7, pitch=26)
    line.swing("right", off, on + 0.16 * single, (_LANDING, 0.0), yaw=7, pitch=26)
    line.legs(off, Leg((0.0, 0.05, -1.0), 8, 5, 45))
    line.key(top - 0.02, left_leg=Leg((-0.2, 0.08, -1.0), 50, 5, 35), right_leg=Leg((-0.2, 0.08, -1.0), 62, 5, 35))
    line.legs(on - 0.1, Leg((0.36, 0.06, -1.0), 26, 5, 34))
    line.key(on, left_leg=Leg((0.4, 0.06, -1.0), 24, 5, 30))
    line.key(on, right_leg=Leg((0.4 + 0.3 * single, 0.06, -1.0), 24 + 40 * single, 5, 30 - 12 * single))


def _trunk(line: Timeline, times: tuple[float, ...], forward: float, behind: float) -> None:
    first, second, bottom, off, hit, on, settled = times
    quick = (on - off) / _AIRBORNE_S
    # Who leaves the elbow in front does not turn the shoulder back either.
    drawn = max(1.0 - 0.8 * forward, 0.0)
    line.key(first, Body(tip=8, lean=4, facing=0, twist=0))
    line.key(second, Body(tip=12, lean=8, facing=-12, twist=-4))
    line.key(bottom, Body(tip=20, lean=14, facing=-18, twist=-4))
    line.key(off, Body(tip=0, lean=-6 * drawn, facing=-18 * drawn, twist=-10 * drawn, bow=2))
    line.key(hit - 0.09 * quick, Body(tip=-4, lean=-13 * drawn, facing=-16 * drawn, twist=-24 * drawn, bow=4, gaze=(0, -34)))
    line.key(hit, Body(tip=2, lean=-3 - 12 * behind, facing=-2, twist=8, bow=-8, gaze=(0, -34 - 8 * behind)))
    line.key(hit + 0.12 * quick, Body(tip=12, lean=16 - 14 * behind, facing=8, twist=18, bow=-2, gaze=(0, -4)))
    line.key(on, Body(tip=8, lean=14 - 6 * behind, facing=8, twist=12, bow=0))
    line.key(settled, Body(tip=18, lean=12, facing=2, twist=4, gaze=(0, 0)))


def _arms(line: Timeline, times: tuple[float, ...], faults: tuple[float, float], less_back: float, less_up: float) -> None:
    first, second, bottom, off, hit, on, settled = times
    forward, behind = faults[0], max(min(faults[1], _FURTHEST_BACK) - less_back, 0.0)
    quick = (on - off) / _AIRBORNE_S
    line.arms(first, Arm((0.35, 0.15, -1.0), (1.0, -0.3, 0.3), 35, 15, 0, 0, 15))
    line.arms(second - 0.06, Arm((-0.75, 0.28, -0.65), (1.0, -0.2, -0.2), 14, 20, 0, 0, 12))
    line.arms(second, Arm((-0.7, 0.28, -0.7), (1.0, -0.2, -0.2), 14, 20, 0, 0, 12))
    line.arms(bottom, Arm((0.05, 0.2, -1.0), (1.0, -0.3, 0.2), 38, 15, 0, 0, 12))
    line.key(off + 0.06 * quick, left_arm=Arm((0.75, 0.5, 0.55 - less_up), (0.1, -0.1, 1.0), 26, 10, 0, 0, 8))
    line.key(
        off + 0.06 * quick,
        right_arm=Arm((-0.1 + 0.9 * forward, 0.8 - 0.35 * forward, 0.1 - 0.2 * forward), (0.2, -0.2, 1.0), 88, 5, -10, 0, 8),
    )
    line.key(hit - 0.11 * quick, left_arm=Arm((0.75, 0.35, 0.85 - less_up), (0.1, -0.2, 1.0), 14, 15, 0, 0, 6))
    line.key(hit + 0.02 * quick, left_arm=Arm((0.6, 0.3, -0.5), (0.8, -0.4, 0.6), 80, 10, 0, 0, 20))
    line.key(hit + 0.2 * quick, left_arm=Arm((0.1, 0.35, -0.95), (1.0, -0.4, 0.2), 60, 10, 0, 0, 20))
    cocked = (-0.42 + 1.4 * forward, 0.85 - 0.5 * forward, 0.3 - 0.2 * forward)
    line.key(hit - 0.115 * quick, right_arm=Arm(cocked, (0.0, -0.15, 1.0), 98, -5, -18, 0, 8))
    line.key(
        hit - 0.062 * quick,
        right_arm=Arm((0.1 + 0.7 * forward, 0.92 - 0.35 * forward, 0.5), (0.0, -0.62, 0.78), 122, -20, -28, 0, 8),
    )
    at_hit = (0.4 - 0.58 * behind, 0.3, 1.0)
    line.key(hit, right_arm=Arm(at_hit, (-0.2, -0.9, 0.35), 24, 4, -4, 0, 4))
    line.key(hit + 0.024 * quick, right_arm=Arm((0.72 - 0.5 * behind, 0.2, 0.9), (-0.15, -0.9, 0.4), 9, 14, 20, 0, 6))
    line.key(hit + 0.085 * quick, right_arm=Arm((0.95, 0.02, 0.25), (-0.05, -0.9, 0.7), 14, 30, 26, 0, 12))
    line.key(hit + 0.2 * quick, right_arm=Arm((0.55, -0.05, -0.8), (0.5, -0.6, 0.5), 30, 25, 8, 0, 18))
    landing = Arm((0.3, 0.4, -0.85), (1.0, -0.3, 0.2), 45, 15, 0, 0, 18)
    line.key(on + 0.08, left_arm=landing)
    # Who hits late ends the swing after he has landed. An arm that were lowered before would have to come up again, through the
    # shoulder, within a few hundredths of a second.
    line.key(max(on + 0.08, hit + 0.2 * quick), right_arm=landing)
    line.arms(settled, Arm((0.35, 0.35, -0.9), (1.0, -0.3, 0.2), 50, 15, 0, 0, 18))


def _ball(line: Timeline, placed: Placed, hit: float) -> Thing:
    wrist, hand = (smpl.INDEX[f"{line.side('right')}_{name}"] for name in ("wrist", "hand"))
    centre = 0.9 * line.figure.bones_m[hand] + np.array((0.0, 0.0, -(VOLLEYBALL_RADIUS_M + 0.012)))
    number = round(hit * RATE_HZ)
    place = held(placed, wrist, centre)[number]
    after = (np.arange(len(placed.joints_m)) - number) / RATE_HZ
    setter = (
        place * np.array((1.0, 1.0, 0.0))
        + _SETTER_M * line.across
        + np.array((0.0, 0.0, 1.25 * line.figure.subject.body.stature_m))
    )
    arriving = (place - setter) / _SET_S - np.array((0.0, 0.0, GRAVITY_M_S2 * _SET_S / 2))
    path = np.empty((len(after), 3))
    path[:number] = thrown(place, arriving, after[:number])
    path[: max(number - round(_SET_S * RATE_HZ), 0)] = np.nan
    path[number:] = bouncing(place, _SPIKED_M_S * line.across, VOLLEYBALL_RADIUS_M, after[number:])
    turns = spinning(np.eye(3), np.array((0.0, 1.0, 0.0)), 1.0, np.minimum(after, 0.0) + 5.0 * np.maximum(after, 0.0))
    return Thing("volleyball", path, turns)


ACTION: Final = Action("volleyball_spike", "Volleyball spike", FAULTS, perform)
