"""What pupils do between attempts: walk, wait, look around, bend down, scratch their heads, clap. None of it is an attempt.

Each act begins and ends in `models.motions.standing.stand`, obeys the same floor and gravity as an action, and is drawn from its
seed: no two waits are alike. Lengths are those of the pupil, places are the world's.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final, Literal, get_args

import numpy as np

from models.errors import UserError
from models.motions.motion import CONTACTS, RATE_HZ, Motion
from models.motions.standing import stand
from models.motions.standpoint import Standpoint
from models.motions.subject import Subject
from models.motions.timeline import Timeline
from models.motions.vocabulary import Arm, Body
from models.motions.walking import JOG, STILL_S, WALK, Gait, go

Pastime = Literal["wait", "scratch", "hands_on_hips", "hands_behind", "bend", "pick_up", "clap", "stretch"]
PASTIMES: Final[tuple[Pastime, ...]] = get_args(Pastime)
LEAST_S: Final[dict[Pastime, float]] = {
    "wait": 1 / RATE_HZ,
    "scratch": 1.8,
    "hands_on_hips": 1.6,
    "hands_behind": 1.6,
    "bend": 2.4,
    "pick_up": 2.4,
    "clap": 1.8,
    "stretch": 2.6,
}
"""Shortest time that each takes."""


_WORTH_MOVING_S: Final = 1.0


@dataclass(frozen=True)
class Go:
    """Walks or jogs to a place.

    Attributes:
        to: where, in the world, and how he looks there. Where he is: he turns.
        jogs: or walks.
        seed: of how he goes.
    """

    to: Standpoint
    jogs: bool = False
    seed: int = 0


@dataclass(frozen=True)
class Pass:
    """Passes time where he stands.

    Attributes:
        how: with what.
        seconds: for how long, to a sample; at least what `LEAST_S` says.
        seed: of how he does it.
    """

    how: Pastime
    seconds: float
    seed: int = 0

    def __post_init__(self) -> None:
        least = LEAST_S[self.how]
        if not least <= self.seconds < np.inf:
            raise UserError(f"between attempts: '{self.how}' takes {least:g} s or more, not {self.seconds:g} s")


Between = Go | Pass


def spend(what: Between, subject: Subject, at: Standpoint) -> Motion:
    """The motion of a pupil who stands at `at`, in his own frame: from `stand` at the origin, looking along x."""
    generator = np.random.default_rng((what.seed, 0x6E7))
    if isinstance(what, Go):
        gait = _varied(JOG if what.jogs else WALK, generator)
        return go(subject, what.to.within(at), gait, float(generator.uniform(0.6, 1.3)), float(generator.normal(0, 12)))
    end = round(what.seconds * RATE_HZ) / RATE_HZ
    if end < _WORTH_MOVING_S:
        return _still(subject, end)
    line = Timeline(subject)
    line.stand(STILL_S)
    _ACTS[what.how](line, end - STILL_S, generator)
    line.stand(end - STILL_S)
    return line.motion(end)


def _still(subject: Subject, seconds: float) -> Motion:
    count = max(round(seconds * RATE_HZ), 1) + 1
    pose, contacts = stand(subject), np.zeros((count, len(CONTACTS)), np.bool_)
    contacts[:, :2] = True
    return Motion(np.tile(pose.translation_m, (count, 1)), np.tile(pose.rotations_rad, (count, 1, 1)), contacts)


def idle_time(seconds: float, where: Callable[[np.random.Generator], Standpoint], seed: int) -> list[Between]:
    """About so many seconds of anything but attempts: walks to places of `where`, turns, and all pastimes in between."""
    generator = np.random.default_rng((seed, 0x1D1E))
    acts: list[Between] = []
    left = seconds
    while left > 0:
        if generator.random() < 0.4:
            acts.append(Go(where(generator), bool(generator.random() < 0.3), int(generator.integers(2**31))))
            left -= _GO_S
            continue
        how = PASTIMES[int(generator.choice(len(PASTIMES), p=_HOW_OFTEN))]
        took = max(LEAST_S[how], float(generator.gamma(4.0, 1.0)))
        acts.append(Pass(how, took, int(generator.integers(2**31))))
        left -= took
    return acts


_GO_S: Final = 6.5
"""What a way across a gym takes, on average."""
_HOW_OFTEN: Final = (0.34, 0.12, 0.12, 0.1, 0.1, 0.08, 0.07, 0.07)


def _varied(gait: Gait, generator: np.random.Generator) -> Gait:
    return replace(
        gait,
        step=gait.step * float(generator.uniform(0.86, 1.08)),
        froude=gait.froude * float(generator.uniform(0.75, 1.15)),
        lean_deg=gait.lean_deg + float(generator.normal(0, 2)),
    )


def _look_around(line: Timeline, start_s: float, end_s: float, generator: np.random.Generator, sway: float = 1.0) -> None:
    """The weight goes from foot to foot, the eyes wander; the rest of the body follows a little."""
    at_s, side = start_s + float(generator.uniform(0.5, 1.2)), float(generator.choice((-1.0, 1.0)))
    while at_s < end_s - 0.5:
        shift = side * sway * float(generator.uniform(0.0, 0.11))
        gaze = (float(generator.normal(0, 26)), float(generator.normal(6, 8)))
        line.key(
            at_s,
            Body(
                at=(float(generator.normal(0, 0.012)), shift),
                height=1.0 - 0.12 * abs(shift) - float(generator.uniform(0, 0.006)),
                facing=float(generator.normal(0, 3)) + 0.06 * gaze[0],
                side=-28 * shift,
                bow=32 * shift,
                twist=0.1 * gaze[0],
                lean=float(generator.normal(2, 2)),
                gaze=gaze,
            ),
        )
        held = float(generator.uniform(0.3, 1.6))
        if at_s + held < end_s - 0.5:
            line.key(at_s + held, Body(at=(float(generator.normal(0, 0.012)), shift), gaze=gaze))
        at_s += held + float(generator.uniform(0.5, 1.1))
        side = -side if generator.random() < 0.7 else side


def _wait(line: Timeline, end_s: float, generator: np.random.Generator) -> None:
    _look_around(line, STILL_S, end_s, generator)
    at_s = STILL_S + float(generator.uniform(0.4, 1.5))
    while at_s < end_s - 0.4:
        line.key(at_s, left_arm=_hanging(generator), right_arm=_hanging(generator))
        at_s += float(generator.uniform(0.8, 2.2))


def _hanging(generator: np.random.Generator) -> Arm:
    upper = (float(generator.normal(0.04, 0.05)), float(generator.uniform(0.1, 0.22)), -1.0)
    return Arm(upper=upper, bend=float(generator.uniform(8, 32)), turn=float(generator.uniform(0, 40)))


def _scratch(line: Timeline, end_s: float, generator: np.random.Generator) -> None:
    reach_s, back_s = STILL_S + float(generator.uniform(0.45, 0.6)), end_s - 0.5
    raised = Arm(upper=(0.3, 0.85, 0.4), fore=(-0.1, -0.33, 0.25), bend=125.0, turn=-20.0, wrist=20.0, curl=40.0)
    right = generator.random() < 0.75
    _look_around(line, STILL_S, end_s, generator, sway=0.5)
    at_s, strokes = reach_s, 0
    while at_s < back_s:
        wobble = 6.0 if strokes % 2 else -6.0
        moved = Arm(raised.upper, raised.fore, 125.0 + wobble, raised.turn, 20.0 - 2 * wobble, 0.0, raised.curl)
        _arms(line, at_s, right, moved)
        at_s += float(generator.uniform(0.1, 0.16))
        strokes += 1


def _arms(line: Timeline, at_s: float, right: bool, leading: Arm, other: Arm | None = None) -> None:
    """Key poses of the leading arm, which is the right one or the left, and of the other."""
    line.key(at_s, left_arm=other if right else leading, right_arm=leading if right else other)


def _posture(posture: Arm) -> Callable[[Timeline, float, np.random.Generator], None]:
    def perform(line: Timeline, end_s: float, generator: np.random.Generator) -> None:
        _look_around(line, STILL_S, end_s, generator)
        for at_s in (STILL_S + float(generator.uniform(0.5, 0.7)), end_s - float(generator.uniform(0.5, 0.7))):
            line.arms(at_s, posture)

    return perform


def _bend(line: Timeline, end_s: float, generator: np.random.Generator) -> None:
    """Down to the shoes, with both hands."""
    down_s, up_s = STILL_S + float(generator.uniform(0.8, 1.0)), end_s - float(generator.uniform(0.8, 1.0))
    at_s, strokes = down_s, 0
    aside = float(generator.choice((-1.0, 1.0))) * 0.04
    while at_s < up_s + 0.01:
        line.key(at_s, Body(at=(-0.22, aside), height=0.56, tip=50.0, lean=38.0, bow=200 * aside, gaze=(0.0, 70.0)))
        wobble = 4.0 if strokes % 2 else -4.0
        line.arms(at_s, Arm(upper=(1.0, -0.12, 0.15), fore=(0.4, -0.6, 0.6), bend=26.0 + wobble, turn=40.0, curl=45.0))
        at_s += float(generator.uniform(0.2, 0.35))
        strokes += 1


def _pick_up(line: Timeline, end_s: float, generator: np.random.Generator) -> None:
    """Down to the floor, with one hand."""
    down_s = STILL_S + float(generator.uniform(0.8, 1.0))
    right = generator.random() < 0.7
    side = 1.0 if right else -1.0
    low = Body(at=(-0.2, -0.05 * side), height=0.5, tip=42.0, lean=40.0, twist=14.0 * side, bow=8 * side, gaze=(-10.0 * side, 60.0))
    resting = Arm(upper=(0.6, 0.4, -0.7), bend=60.0)
    for at_s, curl in ((down_s, 15.0), (down_s + 0.25, 60.0)):
        moved = Arm(upper=(1.0, 0.05, 0.0), bend=38.0, turn=30.0, curl=curl)
        line.key(at_s, low)
        _arms(line, at_s, right, moved, resting)
    _look_around(line, down_s + 1.2, end_s, generator)


def _clap(line: Timeline, end_s: float, generator: np.random.Generator) -> None:
    at_s, period = STILL_S + 0.45, float(generator.uniform(0.22, 0.34))
    while at_s < end_s - 0.5:
        line.arms(at_s, Arm(upper=(0.35, 0.22, -0.9), fore=(1.0, -0.05, 0.1), bend=88.0, turn=0.0, curl=5.0))
        line.arms(at_s + 0.45 * period, Arm(upper=(0.35, 0.16, -0.9), fore=(1.0, -0.5, 0.1), bend=88.0, turn=0.0, curl=5.0))
        at_s += period
    _look_around(line, STILL_S, end_s, generator, sway=0.6)


def _stretch(line: Timeline, end_s: float, generator: np.random.Generator) -> None:
    """Arms over the head, to one side and the other."""
    side = float(generator.choice((-1.0, 1.0)))
    middle = (STILL_S + end_s) / 2
    up_s, down_s = 0.5 * (STILL_S + middle) + 0.2, 0.5 * (end_s + middle) - 0.2
    for at_s, bow in ((up_s, 14.0 * side), (down_s, -14.0 * side)):
        line.key(at_s, Body(at=(0.0, 0.0), height=0.975, bow=bow, lean=-4.0, gaze=(0.0, -20.0)))
        line.arms(at_s, Arm(upper=(0.05, 0.18, 1.0), bend=18.0, turn=40.0))
    for share in (0.25, 0.5, 0.75):  # the centre of mass keeps pace with the arms, so that the knees stay soft
        line.key(STILL_S + share * (up_s - STILL_S), Body(at=(0.0, 0.0), height=1.0 - 0.025 * share))
        line.key(end_s - share * (end_s - down_s), Body(at=(0.0, 0.0), height=1.0 - 0.025 * share))


_ACTS: Final[dict[Pastime, Callable[[Timeline, float, np.random.Generator], None]]] = {
    "wait": _wait,
    "scratch": _scratch,
    "hands_on_hips": _posture(Arm((-0.35, 0.6, -0.75), (0.12, -0.21, -0.2), bend=93.0, turn=60.0, wrist=30.0, curl=20.0)),
    "hands_behind": _posture(Arm((-0.3, 0.15, -0.95), (-0.2, -1.0, 0.1), bend=75.0, turn=-30.0, curl=30.0)),
    "bend": _bend,
    "pick_up": _pick_up,
    "clap": _clap,
    "stretch": _stretch,
}
