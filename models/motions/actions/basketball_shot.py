"""Basketball: a set shot from the ground with a small jump. The ball comes as a pass, is shot at a basket, and bounces on."""

from typing import Final

import numpy as np

from models.arrays import Float
from models.motions import rotations
from models.motions.actions.action import Action, Fault
from models.motions.ballistics import GRAVITY_M_S2, push_off_s, take_off_m_s, throw_to, thrown
from models.motions.figure import Placed
from models.motions.flights import bouncing, held, spinning
from models.motions.motion import RATE_HZ, Attempt, Motion, Thing
from models.motions.natural import Natural
from models.motions.performance import Performance
from models.motions.subject import Subject
from models.motions.things import BASKETBALL_RADIUS_M
from models.motions.timeline import Timeline, snapped
from models.motions.vocabulary import Arm, Body
from models.skeleton import smpl

FAULTS: Final = (
    Fault("elbow_out", "the elbow points 40 degrees to the side instead of to the basket"),
    Fault("no_knee_bend", "the knees bend by 20 degrees instead of 65 before the shot, which comes from the arm alone"),
    Fault("no_follow_through", "the wrist does not snap, and the arm is pulled down at once after the release"),
    Fault("ball_from_chest", "the ball is pushed from the chest, 25 cm below the chin, instead of shot from above the forehead"),
)
_BASKET_M: Final = np.array((3.4, 0.0, 2.6))
"""From the shooter; the height for the young."""
_PASSER_M: Final = np.array((4.2, 0.6, 1.1))
_PASS_S: Final = 0.55
"""Where the pass comes from, against the shooter, and how long it takes."""
_DIP: Final = 0.86
_TIPTOE: Final = 1.085
"""Heights of the pelvis, in its height when standing: with bent knees, and when the feet leave the floor."""
_PALM_M: Final = 0.03
"""From a ball's skin to the joints of the hand that holds it."""


def perform(performance: Performance, subject: Subject) -> Motion:
    """See `models.motions.perform.perform`."""
    natural = Natural(performance)
    line = Timeline(subject, performance.handed, natural)
    out, straight, pulled, low = (performance.severity(fault.name) for fault in FAULTS)
    amplitude = performance.amplitude
    # Without bent knees there is little to jump from.
    airborne = 0.22 * np.sqrt(amplitude) * (1.0 - 0.3 * min(straight, 1.5))
    dip = 1.0 - (1.0 - _DIP) * amplitude * max(1.0 - 0.85 * straight, 0.08)
    high = _TIPTOE
    push = push_off_s((high - dip) * line.leg_m, take_off_m_s(airborne))

    catch = 0.2 + natural.seconds(0.45)
    start = catch + natural.seconds(0.2)
    bottom = start + natural.seconds(0.4)
    off = snapped(bottom + max(push, 0.14))
    on = snapped(off + airborne)
    release = snapped(off + 0.055)
    settled = on + natural.seconds(0.22)
    end = settled + natural.seconds(0.85)

    _legs(line, dip, high, (catch, start, bottom, off, on, settled, end))
    raised = snapped(off - 0.13)
    _arms(line, (catch, bottom, raised, release, settled), (out, pulled, low), end)
    _trunk(line, (start, bottom, off, settled))
    line.stand(end, (0.05, 0.0))
    poses = line.poses(end + 0.15)
    placed = line.figure.place_local(poses.pelvis_m, poses.local)
    ball = _ball(line, placed, poses.times_s, catch, release)
    attempt = Attempt("basketball_shot", performance.handed, start, bottom, release, end, tuple(performance.faults.items()))
    return line.wrapped(poses, (attempt,), (ball,))


def _legs(line: Timeline, dip: float, high: float, times: tuple[float, ...]) -> None:
    catch, start, bottom, off, on, settled, end = times
    line.stand(0.12)
    line.key(catch, Body(height=0.985, gaze=(0.0, 5.0)))
    line.key(start, Body(height=0.985, gaze=(0.0, -14.0)))
    line.key(bottom, Body(height=dip))
    line.key(off, Body(height=high, at=(0.02, 0.0)))
    line.key(on, Body(height=high - 0.02, at=(0.05, 0.0)))
    line.key(settled, Body(height=0.97, at=(0.05, 0.0)))
    line.flight(off, on)
    for side in ("left", "right"):
        line.swing(side, off, on, (0.05, 0.0), yaw=7.0, pitch=28.0, flat_s=0.1)
    line.key(end - 0.3, Body(gaze=(0.0, -8.0)))


def _trunk(line: Timeline, times: tuple[float, ...]) -> None:
    start, bottom, off, settled = times
    line.key(start, Body(tip=0.0, lean=2.0, twist=4.0))
    line.key(bottom, Body(tip=10.0, lean=10.0, twist=7.0))
    line.key(off, Body(tip=0.0, lean=-3.0, twist=6.0))
    line.key(settled, Body(tip=2.0, lean=0.0, twist=4.0))


def _arms(line: Timeline, times: tuple[float, ...], faults: tuple[float, float, float], end: float) -> None:
    catch, bottom, raised, release, settled = times
    out, pulled, low = faults
    aside = np.tan(np.radians(-3.0 + 40.0 * out))
    line.key(
        catch,
        right_arm=Arm((0.38, 0.22, -0.9), (1.0, -0.25, 0.35), 82, 15, -15, 0, 12),
        left_arm=Arm((0.38, 0.22, -0.9), (1.0, -0.25, 0.35), 82, 15, -10, 0, 12),
    )
    low_point = min(bottom, raised - 0.24)
    line.key(low_point, right_arm=Arm((0.25, 0.2 + 0.6 * out, -0.95), (1.0, -0.15, 0.4), 100, 60, -45, 0, 12))
    up = 0.12 - 0.75 * low
    line.key(raised, right_arm=Arm((1.0, aside, up), (0.12, -0.2 * aside, 1.0), 105, 72, -62, 0, 12))
    line.key(snapped(raised + 0.08), right_arm=Arm(wrist=-62))
    line.key(release, right_arm=Arm((1.0, 0.8 * aside, 1.35 - 0.95 * low), (-0.3, -0.85, 0.5), 22, 26, -12, 0, 14))
    snap = release + 0.09
    wrist = 46 - 54 * min(pulled, 1.3)
    line.key(snap, right_arm=Arm((1.0, 0.6 * aside, 1.5 - 1.0 * low), (-0.35, -0.8, 0.6), 12 + 30 * pulled, 28, wrist, 0, 16))
    down = min(pulled, 1.3)
    rest = snap + (settled - snap + 0.18) * (1.0 - 0.35 * down)
    held_up = (1.0 - 0.3 * down, 0.6 * aside, 1.4 - low - (1.75 - low) * down)
    bend = 16 + 70 * down
    line.key(rest, right_arm=Arm(held_up, (-0.35 + 0.6 * down, -0.8 + 0.3 * down, 0.6), bend, 28, wrist * (1 - 0.7 * down), 0, 16))
    line.key(rest + 0.5 * (end - rest), right_arm=Arm((0.55, 0.2, -0.7), (0.6, -0.2, 1.0), 60, 40, 10, 0, 20))
    # The guide hand: on the ball's side, leaves it just before the release, and stays up.
    line.key(raised, left_arm=Arm((0.85, 0.05, 0.05), (0.1, -0.25, 1.0), 95, -10, -10, 0, 8))
    line.key(release, left_arm=Arm((0.85, 0.3, 0.7 - 0.85 * low), (0.0, -0.45, 1.0), 55, -10, -8, 0, 8))
    line.key(settled, left_arm=Arm((0.85, 0.2, 0.6 - 0.7 * low), (0.0, -0.35, 1.0), 58, -5, -4, 0, 10))
    line.guide(
        "left",
        (0.1, 0.75, -1.0),
        {0.2: 0.0, catch - 0.1: 0.5, catch: 1.0, release - 0.05: 1.0, release + 0.06: 0.0},
        _ball_in_hand(line),
        BASKETBALL_RADIUS_M + _PALM_M,
        {
            catch: ((0.25, 0.0, -1.0), (0.0, -1.0, 0.0)),
            low_point: ((0.6, 0.0, -0.8), (0.0, -1.0, -0.2)),
            raised: ((1.0, 0.1, -0.1), (0.0, -0.8, -0.6)),
        },
    )


def _ball_in_hand(line: Timeline) -> Float:
    """(3,) centre of the ball from the right wrist, in the hand's frame: on the palm and the fingers."""
    hand = float(np.linalg.norm(line.figure.bones_m[smpl.INDEX["right_hand"]]))
    return np.array((0.01, -0.95 * hand, -(BASKETBALL_RADIUS_M + _PALM_M)))


def _ball(line: Timeline, placed: Placed, times_s: Float, catch: float, release: float) -> Thing:
    wrist = smpl.INDEX[f"{line.side('right')}_wrist"]
    place = held(placed, wrist, _ball_in_hand(line) * line.across)
    turned = rotations.vectors(placed.turns[:, wrist])
    first, last = round(snapped(catch) * RATE_HZ), round(release * RATE_HZ)
    shooter = placed.joints_m[last, 0] * np.array((1.0, 1.0, 0.0))
    velocity = throw_to(place[last], shooter + _BASKET_M, 54.0)
    place[last:] = bouncing(place[last], velocity, BASKETBALL_RADIUS_M, times_s[last:] - times_s[last])
    turned[last:] = spinning(placed.turns[last, wrist], np.array((0.0, -1.0, 0.0)), 2.0, times_s[last:] - times_s[last])
    arrival = (place[first] - shooter - _PASSER_M * line.across) / _PASS_S - np.array((0.0, 0.0, GRAVITY_M_S2 * _PASS_S / 2))
    place[:first] = thrown(place[first], arrival, times_s[:first] - times_s[first])
    place[: max(first - round(_PASS_S * RATE_HZ), 0)] = np.nan
    turned[:first] = spinning(placed.turns[first, wrist], np.array((0.0, -1.0, 0.0)), 1.0, times_s[:first] - times_s[first])
    return Thing("basketball", place, turned)


ACTION: Final = Action("basketball_shot", "Basketball shot", FAULTS, perform)
