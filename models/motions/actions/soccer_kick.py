"""Football: an instep kick of a resting ball after a run-up of three steps."""

from typing import Final

import numpy as np

from models.motions.actions.action import Action, Fault
from models.motions.figure import Placed
from models.motions.flights import bouncing, spinning
from models.motions.motion import RATE_HZ, Attempt, Motion, Thing
from models.motions.natural import Natural
from models.motions.performance import Performance
from models.motions.subject import Subject
from models.motions.things import FOOTBALL_RADIUS_M
from models.motions.timeline import Timeline, snapped
from models.motions.vocabulary import Arm, Body, Leg
from models.skeleton import smpl

FAULTS: Final = (
    Fault("support_foot_behind", "the support foot is put down a foot's length behind the ball instead of beside it"),
    Fault("no_backswing", "the kicking leg is not swung back: its knee bends by 45 degrees instead of 100 before the kick"),
    Fault("lean_back", "the trunk leans back by 18 degrees at the hit instead of bending over the ball"),
    Fault("no_follow_through", "the leg stops behind the ball, the foot stays below the knee"),
)
_SHOT_M_S: Final = np.array((13.0, 0.0, 3.6))
_SUPPORT: Final = 1.52
_END: Final = 1.95
"""Where the support foot is put down and where he comes to stand, in leg lengths from the start."""
_LEAP_S: Final = 0.12
_BEHIND: Final = 0.26
"""How far behind its place the support foot is put at severity 1, in leg lengths."""


def perform(performance: Performance, subject: Subject) -> Motion:
    """See `models.motions.perform.perform`."""
    natural = Natural(performance)
    line = Timeline(subject, performance.handed, natural)
    start = 0.2
    first = start + natural.seconds(0.36)
    second = first + natural.seconds(0.31)
    planted = snapped(second + natural.seconds(0.31))
    hit = snapped(planted + natural.seconds(0.185))
    high = hit + natural.seconds(0.18 * performance.amplitude)
    landed = high + natural.seconds(0.3)
    end = landed + natural.seconds(0.85)
    times = (start, first, second, planted, hit, high, landed, end)

    _run_up(line, times, performance)
    _kicking_leg(line, times, performance)
    _trunk(line, times, performance)
    _arms(line, times)
    line.stand(end, (_END, 0.0))
    poses = line.poses(end + 0.15)
    placed = line.figure.place_local(poses.pelvis_m, poses.local)
    attempt = Attempt("soccer_kick", performance.handed, start, planted, hit, end, tuple(performance.faults.items()))
    return line.wrapped(poses, (attempt,), (_ball(line, placed, hit),))


def _run_up(line: Timeline, times: tuple[float, ...], performance: Performance) -> None:
    start, first, second, planted, hit, high, landed, end = times
    behind = _BEHIND * performance.severity("support_foot_behind")
    off = planted - _LEAP_S
    line.step("left", start + 0.06, first, (0.42, 0.0), yaw=4, height=0.08, pitch=-10, heel=20)
    line.step("right", first + 0.03, second, (0.9, -0.02), yaw=5, height=0.09, pitch=-8, heel=42)
    line.step("left", second + 0.02, planted, (_SUPPORT - behind, 0.05), yaw=4, height=0.12, pitch=-8, flat_s=0.07, heel=44)
    line.step("left", landed + 0.02, landed + 0.48 * (end - landed), (_END, 0.0), yaw=7, height=0.08, heel=40)
    line.step("right", landed + 0.5 * (end - landed), end - 0.04, (_END, 0.0), yaw=7, height=0.05)
    line.flight(off, planted)
    back = 0.4 * behind
    line.stand(start - 0.05)
    line.key(first, Body(at=(0.3, 0.02), height=0.965, gaze=(-4, 28)))
    line.key(second, Body(at=(0.7, 0.01), height=0.955))
    beside = 1.1 - back
    line.key(off, Body(at=(beside - (beside - 0.7) * _LEAP_S / (planted - second), 0.02), height=0.975))
    line.key(planted, Body(at=(beside, 0.03), height=0.96))
    line.key(hit, Body(at=(1.28 - back, 0.08), height=0.96, gaze=(-6, 42)))
    line.key(high, Body(at=(1.46 - back, 0.08), height=0.965, gaze=(-3, 18)))
    line.key(landed, Body(at=(1.78 - 0.7 * behind, -0.01), height=0.95, gaze=(0, 4)))
    line.pitch(hit, "left", 0.0)
    line.pitch(high, "left", 24.0)
    line.pitch(landed - 0.04, "left", 26.0)


def _kicking_leg(line: Timeline, times: tuple[float, ...], performance: Performance) -> None:
    _, _, _, planted, hit, high, landed, _ = times
    back = max(performance.amplitude - 0.55 * performance.severity("no_backswing"), -0.05)
    on = max(performance.amplitude - 0.75 * performance.severity("no_follow_through"), -0.2)
    behind = _BEHIND * performance.severity("support_foot_behind")
    reach = 0.35 * behind
    line.swing("right", planted - _LEAP_S, landed, (_END - 0.02 - 0.7 * behind, -0.03), yaw=8, pitch=0)
    line.key(planted - _LEAP_S, right_leg=Leg((-0.42, 0.04, -1.0), 30, 5, 45))
    line.key(planted - 0.03, right_leg=Leg((-0.4, 0.1, -1.0), 40 + 26 * back, 6, 34))
    swing = hit - planted
    line.key(planted + 0.27 * swing, right_leg=Leg((0.1 - 0.6 * back, 0.14, -1.0), 8 + 94 * back, 8, 30))
    line.key(hit - 0.3 * swing, right_leg=Leg((0.5 + reach, 0.12, -1.0), 12 + 88 * back, 10, 32))
    line.key(hit, right_leg=Leg((0.8 + reach, 0.12, -1.0), 47, 10, 28), exact=True)
    line.key(hit + 0.22 * swing, right_leg=Leg((0.92 + reach, 0.06, -0.9), 16, 10, 34))
    line.key(high, right_leg=Leg((0.85 + 0.5 * on, -0.12, -1.0 + 0.75 * on), 14 + 30 * (1 - on), 8, 34))
    line.key(landed - 0.09, right_leg=Leg((0.62, 0.02, -1.0), 58, 8, -5))
    line.key(landed, right_leg=Leg((0.5, 0.02, -1.0), 36, 8, -2))


def _trunk(line: Timeline, times: tuple[float, ...], performance: Performance) -> None:
    _, first, second, planted, hit, high, landed, _ = times
    lean = performance.severity("lean_back")
    line.key(first, Body(tip=7, lean=4, facing=4, twist=-6))
    line.key(second, Body(tip=8, lean=4, facing=-6, twist=6))
    line.key(planted, Body(tip=4 - 6 * lean, lean=2 - 12 * lean, facing=-22, twist=20, side=-5, bow=-2))
    line.key(hit, Body(tip=2 - 12 * lean, facing=4, side=-16), exact=True)
    line.key(hit, Body(lean=12 - 24 * lean, twist=6, bow=8))
    line.key(high, Body(tip=-8 - 8 * lean, lean=20 - 28 * lean, facing=18, twist=-12, side=-8, bow=4))
    line.key(landed, Body(tip=6, lean=6, facing=6, twist=-2, side=0, bow=0))


def _arms(line: Timeline, times: tuple[float, ...]) -> None:
    _, first, second, planted, hit, high, landed, _ = times
    line.key(first, left_arm=Arm((-0.35, 0.2, -0.9), (1.0, -0.3, 0.2), 45, 10, 0, 0, 25))
    line.key(first, right_arm=Arm((0.4, 0.15, -0.9), (1.0, -0.4, 0.5), 70, 10, 0, 0, 25))
    line.key(second, left_arm=Arm((0.45, 0.35, -0.8), (1.0, -0.4, 0.5), 60, 10, 0, 0, 20))
    line.key(second, right_arm=Arm((-0.4, 0.2, -0.9), (1.0, -0.3, 0.2), 45, 10, 0, 0, 25))
    line.key(planted, left_arm=Arm((0.1, 1.0, 0.12), (0.9, -0.2, 0.3), 28, 20, 0, 0, 12))
    line.key(planted, right_arm=Arm((-0.25, 0.55, -0.8), (1.0, -0.3, 0.1), 30, 10, 0, 0, 20))
    line.key(hit, left_arm=Arm((0.5, 0.85, -0.1), (0.8, -0.6, 0.2), 35, 20, 0, 0, 14))
    line.key(hit, right_arm=Arm((-0.5, 0.6, -0.7), (1.0, -0.3, 0.1), 28, 10, 0, 0, 20))
    line.key(high, left_arm=Arm((0.9, 0.2, -0.45), (0.3, -0.9, 0.3), 45, 20, 0, 0, 16))
    line.key(high, right_arm=Arm((-0.65, 0.7, -0.45), (0.9, -0.2, 0.1), 25, 10, 0, 0, 20))
    line.arms(landed, Arm((0.1, 0.35, -0.95), (1.0, -0.3, 0.2), 35, 12, 0, 0, 22))


def _ball(line: Timeline, placed: Placed, hit: float) -> Thing:
    """Lies where the instep meets it."""
    toes, ankle = (smpl.INDEX[f"{line.side('right')}_{name}"] for name in ("foot", "ankle"))
    number = round(hit * RATE_HZ)
    instep = 0.6 * placed.joints_m[number, toes] + 0.4 * placed.joints_m[number, ankle]
    rest = np.array((instep[0] + FOOTBALL_RADIUS_M + 0.035, instep[1], FOOTBALL_RADIUS_M))
    after = (np.arange(len(placed.joints_m)) - number) / RATE_HZ
    path = np.tile(rest, (len(after), 1))
    path[number:] = bouncing(rest, _SHOT_M_S, FOOTBALL_RADIUS_M, after[number:])
    return Thing("football", path, spinning(np.eye(3), np.array((0.0, -1.0, 0.0)), 2.5, np.maximum(after, 0.0)))


ACTION: Final = Action("soccer_kick", "Football kick", FAULTS, perform)
