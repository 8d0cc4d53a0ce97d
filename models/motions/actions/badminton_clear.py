"""Badminton: an overhead forehand clear. Side-on under the shuttlecock, hit at full reach, the racket foot steps through."""

from typing import Final

import numpy as np

from models.arrays import Float
from models.motions import rotations
from models.motions.actions.action import Action, Fault
from models.motions.figure import Placed
from models.motions.flights import held, shuttlecock
from models.motions.motion import RATE_HZ, Attempt, Motion, Thing
from models.motions.natural import Natural
from models.motions.performance import Performance
from models.motions.subject import Subject
from models.motions.things import RACKET_SWEET_SPOT_M
from models.motions.timeline import Timeline, snapped
from models.motions.vocabulary import Arm, Body, Direction
from models.skeleton import smpl

FAULTS: Final = (
    Fault("hit_too_low", "the shuttlecock is hit beside the head with a bent arm, an upper arm's length too low"),
    Fault("no_body_turn", "the shoulders stay square to the net instead of turning side-on by 80 degrees"),
    Fault("straight_arm", "the racket is taken back with a straight arm, the elbow bent by 40 degrees instead of 115"),
    Fault("no_follow_through", "the racket stops in front of the head after the hit instead of swinging across the body"),
)
_SHAFT: Final = np.array((0.45, -0.89, 0.0))
"""Of the racket in the right hand's frame: between the thumb's side and the fingers."""
_STRINGS: Final = np.array((0.0, 0.0, -1.0))
"""To where the strings look: as the palm does."""
_DRIVE_S: Final = 0.3
_COMING_M_S: Final = np.array((-2.6, 0.0, -5.6))
_CLEARED_M_S: Final = np.array((17.0, 0.5, 13.0))


def perform(performance: Performance, subject: Subject) -> Motion:
    """See `models.motions.perform.perform`."""
    natural = Natural(performance)
    line = Timeline(subject, performance.handed, natural)
    low, square, stiff, stopped = (performance.severity(fault.name) for fault in FAULTS)
    amplitude = performance.amplitude
    turn = max(1.0 - 0.85 * square, -0.2)

    start = 0.2
    back = start + natural.seconds(0.62)
    drive = back + natural.seconds(0.22)
    hit = snapped(drive + natural.seconds(_DRIVE_S))
    through = hit + natural.seconds(0.26)
    rested = through + natural.seconds(0.3)
    end = rested + natural.seconds(0.75)

    _feet(line, (start, back, drive, hit, through, rested, end), turn, amplitude)
    _trunk(line, (back, drive, hit, through, rested), turn, amplitude)
    _racket_arm(line, (start, back, drive, hit, through, rested), (low, stiff, stopped))
    _other_arm(line, (back, drive, hit, through, rested))
    line.stand(end)
    poses = line.poses(end + 0.15)
    placed = line.figure.place_local(poses.pelvis_m, poses.local)
    attempt = Attempt("badminton_clear", performance.handed, start, drive, hit, end, tuple(performance.faults.items()))
    return line.wrapped(poses, (attempt,), _things(line, placed, hit))


def _feet(line: Timeline, times: tuple[float, ...], turn: float, amplitude: float) -> None:
    start, back, drive, hit, through, rested, end = times
    stride = 0.5 * amplitude
    turned = start + 0.58 * (back - start)
    line.step("right", start, turned, (-stride, -0.08), yaw=7 + 50 * turn, height=0.07)
    on_toes = 22 * (1 - turn)  # a heel behind somebody who looks to the net cannot stay down
    line.pitch(turned, "right", 0.0)
    line.pitch(back, "right", on_toes)
    line.step("left", turned + 0.02, back - 0.02, (0.08, 0.02), yaw=7 - 29 * turn, height=0.04)
    line.step("right", drive + 0.06, through, (0.42 * amplitude, -0.04), yaw=20, height=0.1, heel=on_toes)
    line.step("right", rested, rested + 0.54 * (end - rested), (0.0, 0.0), yaw=7, height=0.06)
    line.step("left", rested + 0.56 * (end - rested), end - 0.04, (0.0, 0.0), yaw=7, height=0.05)
    line.pitch(hit, "left", 14.0)
    line.pitch(through, "left", 25.0)
    line.pitch(rested, "left", 12.0)
    line.stand(start - 0.05)
    line.key(turned + 0.02, Body(facing=-24 * turn))  # the hips turn on when the left foot may turn with them
    line.key(back, Body(at=(-0.33 * amplitude, -0.07), height=0.94))
    line.key(drive, Body(at=(-0.27 * amplitude, -0.05), height=0.935))
    line.key(hit, Body(at=(0.0, 0.04), height=1.0))
    line.key(through, Body(at=(0.2 * amplitude, 0.0), height=0.95))
    line.key(rested, Body(at=(0.22 * amplitude, -0.01), height=0.955))


def _trunk(line: Timeline, times: tuple[float, ...], turn: float, amplitude: float) -> None:
    back, drive, hit, through, rested = times
    quick = (hit - drive) / _DRIVE_S
    line.key(back, Body(facing=-56 * turn, twist=-20 * turn, lean=-5, bow=6, tip=-3, gaze=(0, -38)))
    line.key(drive, Body(facing=-54 * turn, twist=-27 * turn, lean=-9 * amplitude, bow=9, tip=-3, gaze=(0, -42)))
    line.key(drive + 0.5 * (hit - drive), Body(facing=-30 * turn, twist=-27 * turn))
    line.key(hit - 0.06 * quick, Body(twist=-20 * turn))
    line.key(hit, Body(facing=6, twist=8, lean=0, bow=-12, tip=4, gaze=(2, -38)))
    line.key(through, Body(facing=14, twist=24, lean=14 * amplitude, bow=-4, tip=12, gaze=(0, -10)))
    line.key(rested, Body(facing=9, twist=8, lean=6, bow=0, tip=6, gaze=(0, -8)))


def _racket_arm(line: Timeline, times: tuple[float, ...], faults: tuple[float, float, float]) -> None:
    start, back, drive, hit, through, rested = times
    quick = (hit - drive) / _DRIVE_S
    low, stiff, stopped = faults[0], faults[1], min(faults[2], 1.2)
    bent = max(1.0 - 0.66 * stiff, 0.03)
    ready = Arm((-0.3, 0.85, 0.05 + 0.1 * bent), (0.2, 0.0, 1.0), 92 * bent, -5, -15, 10, 70)
    line.key(start + 0.5 * (back - start), right_arm=Arm((0.25, 0.5, -0.7), (0.8, 0.0, 0.8), 80 * bent, 10, -10, 5, 70))
    line.key(back, right_arm=ready)
    line.key(drive, right_arm=ready)
    # The elbow leads: it goes up and to the front while the racket falls, past the shoulder, behind the back.
    reach = np.array((0.36, 0.34, 1.0)) * (1 - 0.45 * low) + np.array((0.8, 0.8, 0.0)) * 0.45 * low
    drawn, lead = np.array((-0.22, 0.9, 0.25)), np.array((0.03, 0.9, 0.48 - 0.3 * low))
    line.key(drive + 0.35 * (hit - drive), right_arm=Arm(_direction(drawn), (-0.06, -0.2, 0.95), 112 * bent, -4, -48, 12, 75))
    line.key(hit - 0.12 * quick, right_arm=Arm(_direction(lead), (-0.08, -0.46, 0.82), 122 * bent, 0, -55, 12, 75))
    line.key(hit - 0.064 * quick, right_arm=Arm(_direction(lead), (-0.1, -0.6, 0.77), 112 * bent, -8, -48, 8, 75))
    line.key(hit, right_arm=Arm(_direction(reach), (-0.2, -0.9, 0.35), 30 + 50 * low, 5, -4, -18, 75))
    line.key(hit + 0.022 * quick, right_arm=Arm((0.72, 0.2, 0.95 - 0.6 * low), (-0.15, -0.9, 0.4), 9 + 50 * low, 22, 12, -24, 75))
    line.key(hit + 0.08 * quick, right_arm=Arm((0.95, 0.0, 0.3 - 0.2 * low), (-0.05, -0.9, 0.7), 16 + 35 * low, 40, 22, -10, 75))
    after = np.array((0.62, -0.38, -0.6)) * max(1 - stopped, -0.2) + np.array((0.95, 0.25, 0.25)) * stopped
    line.key(through, right_arm=Arm(_direction(after), (0.3, -0.6, 0.75), 40 + 25 * stopped, 40, 10, 0, 72))
    line.key(rested, right_arm=Arm((0.45, 0.05, -0.85), (0.8, -0.5, 0.3), 60, 20, 0, 0, 60))


def _direction(vector: Float) -> Direction:
    return (float(vector[0]), float(vector[1]), float(vector[2]))


def _other_arm(line: Timeline, times: tuple[float, ...]) -> None:
    back, drive, hit, through, rested = times
    pointing = Arm((0.3, 0.85, 0.6), (0.5, -0.2, 0.9), 24, 20, 0, 0, 10)
    line.key(back, left_arm=pointing)
    line.key(drive, left_arm=pointing)
    line.key(hit, left_arm=Arm((0.4, 0.35, -0.75), (1.0, -0.5, 0.5), 88, 10, 0, 0, 35))
    line.key(through, left_arm=Arm((-0.05, 0.4, -0.9), (1.0, -0.5, 0.3), 75, 10, 0, 0, 35))
    line.key(rested, left_arm=Arm((0.1, 0.25, -0.95), (1.0, -0.3, 0.2), 50, 10, 0, 0, 30))


def _things(line: Timeline, placed: Placed, hit: float) -> tuple[Thing, Thing]:
    wrist, hand = (smpl.INDEX[f"{line.side('right')}_{name}"] for name in ("wrist", "hand"))
    grip = 0.75 * line.figure.bones_m[hand] + 0.02 * _STRINGS * line.across
    z, x = rotations.unit(_SHAFT) * line.across, _STRINGS * line.across
    turns = placed.turns[:, wrist] @ np.stack((x, np.cross(z, x), z), axis=-1)
    grips = held(placed, wrist, grip)
    number = round(hit * RATE_HZ)
    place = grips[number] + turns[number] @ np.array((0.0, 0.0, RACKET_SWEET_SPOT_M))
    after = (np.arange(len(grips)) - number) / RATE_HZ
    coming, falling = shuttlecock(place, _COMING_M_S * line.across, np.minimum(after, 0.0))
    leaving, flying = shuttlecock(place, _CLEARED_M_S * line.across, np.maximum(after, 0.0))
    before = (after < 0)[:, None]
    places = np.where(before, coming, leaving)
    places[np.linalg.norm(places - place, axis=1) > 9.0] = np.nan
    return (
        Thing("racket", grips, rotations.vectors(turns)),
        Thing("shuttlecock", places, np.where(before, falling, flying)),
    )


ACTION: Final = Action("badminton_clear", "Badminton clear", FAULTS, perform)
