"""Going somewhere on foot: walking and jogging, with turns on the spot before and after.

Step length, cadence and their children's sizes go by the leg's length: people walk at a Froude number (v^2 / g l) of about 0.2
and change to running at about 0.5 (Alexander, "Optimization and gaits in the locomotion of vertebrates", Physiol. Rev. 69, 1989).
Feet that stand are held by the floor (`models.motions.timeline`); arms swing against the legs.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float
from models.motions.ballistics import GRAVITY_M_S2
from models.motions.figure import Figure
from models.motions.motion import Motion
from models.motions.standing import TOES_OUT_DEG, standing_values
from models.motions.standpoint import Standpoint
from models.motions.subject import Subject
from models.motions.timeline import Side, Timeline
from models.motions.vocabulary import Arm, Body

STILL_S: Final = 0.1
"""At the beginning and at the end: the corners of words are rounded, and the last pose shall be `stand`."""
_TURN_DEG: Final = 60.0
"""The most that one step turns."""
_TURN_S: Final = 0.42
_WORTH_JOGGING: Final = 2.5
"""Steps; nobody jogs to what is nearer."""
_HEEL_OFF: Final = 0.5
"""Share of its stance, from the end, at which a foot's heel begins to rise."""
_NEAR: Final = 0.02
"""Nearer than this, in leg lengths, is there."""


@dataclass(frozen=True)
class Gait:
    """How somebody goes.

    Attributes:
        step: length of a step, in leg lengths.
        froude: of the speed.
        ahead: of the pelvis, how far a foot lands, in steps.
        stance: how long a foot stands, in step times; above 1 a walk, below 1 a jog that flies for the rest.
        lift: height of the swinging foot's sole, in leg lengths.
        toes_deg: pitch with which a foot leaves, on its toes.
        heel_deg: pitch with which a foot lands; below 0 on the heel.
        heights: of the pelvis, in its height when standing: as a foot lands, and in the middle of its stance.
        sway: of the pelvis to the foot that stands, in leg lengths.
        width: between the feet, in what it is when standing.
        lean_deg: of the trunk.
        arm: forward and backward swing of the upper arm: the front of its direction where -1 is down.
        elbows_deg: bend of the elbows, behind and before.
    """

    step: float
    froude: float
    ahead: float
    stance: float
    lift: float
    toes_deg: float
    heel_deg: float
    heights: tuple[float, float]
    sway: float
    width: float
    lean_deg: float
    arm: tuple[float, float]
    elbows_deg: tuple[float, float]

    def step_s(self, leg_m: float) -> float:
        """Time of a step."""
        return float(self.step * leg_m / np.sqrt(self.froude * GRAVITY_M_S2 * leg_m))


WALK: Final = Gait(
    step=0.7, froude=0.19, ahead=0.53, stance=1.2, lift=0.05, toes_deg=44.0, heel_deg=-16.0,
    heights=(0.95, 0.972), sway=0.028, width=0.5, lean_deg=3.0, arm=(0.38, -0.36), elbows_deg=(14.0, 30.0),
)  # fmt: skip
JOG: Final = Gait(
    step=0.86, froude=0.62, ahead=0.3, stance=0.78, lift=0.17, toes_deg=56.0, heel_deg=-6.0,
    heights=(0.965, 0.925), sway=0.012, width=0.35, lean_deg=8.0, arm=(0.45, -0.6), elbows_deg=(88.0, 96.0),
)  # fmt: skip


def go(subject: Subject, to: Standpoint, gait: Gait = WALK, arms: float = 1.0, gaze_deg: float = 0.0) -> Motion:
    """From `stand` at the origin, looking along x, to `stand` somewhere else.

    Args:
        subject: who goes.
        to: where, and how he looks there.
        gait: how.
        arms: how far the arms swing, against the gait's.
        gaze_deg: how far to the left he looks on the way.
    """
    way = _Way(subject, gait, arms, gaze_deg)
    far = float(np.hypot(to.x_m, to.y_m))
    if far > _NEAR * way.leg_m:
        along = float(np.arctan2(to.y_m, to.x_m))
        way.turn_to(along)
        way.ahead(far, to)
        way.turn_to(along + float((to.heading_rad - along + np.pi) % (2 * np.pi) - np.pi))
    else:
        way.turn_to(to.heading_rad)
    return way.arrive()


class _Way:
    """A timeline that grows step by step. Lengths in leg lengths, headings in degrees without wrapping."""

    def __init__(self, subject: Subject, gait: Gait, arms: float, gaze_deg: float) -> None:
        self._line = Timeline(subject)
        figure = Figure(subject)
        self.leg_m = figure.leg_m
        home = standing_values(figure)
        self._home = {side: home[f"{side}_foot.place"][:2] / figure.leg_m for side in ("left", "right")}
        self._gait, self._arms, self._gaze_deg = gait, arms, gaze_deg
        self._at = np.zeros(2)
        self._heading = 0.0
        self._now = STILL_S
        self._stand(STILL_S)

    def turn_to(self, heading_rad: float) -> None:
        """On the spot, the foot on the inner side first."""
        change = float(np.degrees(heading_rad)) - self._heading
        steps = int(np.ceil(abs(change) / _TURN_DEG - 1e-6))
        sides: tuple[Side, Side] = ("left", "right") if change > 0 else ("right", "left")
        for _ in range(steps):
            for number, side in enumerate(sides):
                heading = self._heading + change / steps * (number + 1) / 2
                feet = self._heading + change / steps
                self._line.pitch(self._now, side, 0.0)
                self._step(side, self._now + 0.06 * _TURN_S, self._now + 0.94 * _TURN_S, self._at, feet, 1.0, 0.05)
                self._now += _TURN_S
                self._line.key(
                    self._now, Body(at=self._point(), height=0.995, facing=heading, gaze=(heading + change / steps / 2, 4))
                )
            self._heading += change / steps
        if steps:
            self._rest(0.0)

    def ahead(self, far_m: float, to: Standpoint) -> None:
        """Straight on, and the feet together at the end."""
        far = far_m / self.leg_m
        gait = WALK if self._gait.stance < 1 and far < _WORTH_JOGGING * self._gait.step else self._gait
        count = max(int(np.ceil(far / gait.step - 1e-6)), 1)
        length = far / count
        size = length / gait.step  # a short step is slower and flatter
        step_s = gait.step_s(self.leg_m) * (0.75 + 0.25 * size)
        start, begun = self._at, self._now
        forward = np.array((np.cos(np.radians(self._heading)), np.sin(np.radians(self._heading))))
        across = np.array((-forward[1], forward[0]))
        first: Side = "right" if to.y_m < 0 else "left"
        sides: tuple[Side, Side] = (first, "left" if first == "right" else "right")
        flies = gait.stance < 1
        for number in range(count + 1):
            side, last = sides[number % 2], number == count
            lands = begun + (number + 1) * step_s
            lifts = begun + 0.1 * step_s if number == 0 else lands - (2 - gait.stance) * step_s
            place = start + forward * min((number + 1) * length, far)
            width = 1.0 if number >= count - 1 else gait.width
            lift, heel_deg = (0.6 * gait.lift, 0.0) if last else (gait.lift, gait.heel_deg * size)
            toes_deg = 0.0 if number == 0 else gait.toes_deg * size * (0.85 if last else 1.0)
            heel_s = _HEEL_OFF * gait.stance * step_s
            self._step(side, lifts, lands, place, self._heading, width, lift, heel_deg, toes_deg, heel_s)
            if last:
                break
            out = (1.0 if side == "left" else -1.0) * gait.sway
            landing = start + forward * (number + 1 - gait.ahead) * length
            middle = landing + 0.4 * forward * length
            self._stride(gait, side, lands, landing)
            if flies:
                self._stride(gait, side, lands - (1 - gait.stance) * step_s, landing - forward * (1 - gait.stance) * length)
                self._line.flight(lands - (1 - gait.stance) * step_s, lands)
            if number < count - 1:
                self._line.key(lands + 0.4 * step_s, Body(at=self._pair(middle + out * across), height=gait.heights[1]))
        self._at = start + forward * far
        self._now = begun + (count + 1) * step_s
        self._rest(0.15)

    def arrive(self) -> Motion:
        """Stand still, there."""
        self._now += STILL_S
        self._stand(self._now)
        return self._line.motion(self._now + STILL_S)

    def _stride(self, gait: Gait, side: Side, at_s: float, place: Float) -> None:
        """The body as a foot lands: the other side's arm and shoulder in front."""
        turn = 1.0 if side == "left" else -1.0
        before = Arm(upper=(gait.arm[0] * self._arms, 0.12, -1), bend=gait.elbows_deg[1])
        behind = Arm(upper=(gait.arm[1] * self._arms, 0.2, -1), bend=gait.elbows_deg[0])
        left, right = (behind, before) if side == "left" else (before, behind)
        body = Body(
            at=self._pair(place),
            height=gait.heights[0],
            facing=self._heading - 5.0 * turn,
            twist=9.0 * turn,
            lean=gait.lean_deg,
            gaze=(self._heading + self._gaze_deg, 6.0),
        )
        self._line.key(at_s, body, left, right)

    def _step(
        self,
        side: Side,
        lifts: float,
        lands: float,
        at: Float,
        heading: float,
        width: float,
        lift: float,
        heel_deg: float = 0.0,
        toes_deg: float = 0.0,
        heel_s: float = 0.16,
    ) -> None:
        """A foot to where it stands when the pupil stands there so turned."""
        home = self._home[side]
        cosine, sine = np.cos(np.radians(heading)), np.sin(np.radians(heading))
        x, y = home[0], home[1] * width
        place = at + np.array((cosine * x - sine * y, sine * x + cosine * y)) - home
        out = 1.0 if side == "left" else -1.0
        yaw = out * heading + TOES_OUT_DEG
        self._line.step(side, lifts, lands, self._pair(place), yaw, lift, heel_deg, heel=toes_deg, heel_s=heel_s)

    def _rest(self, after_s: float) -> None:
        self._now += after_s
        self._stand(self._now)

    def _stand(self, at_s: float) -> None:
        self._line.pitch(at_s, "left", 0.0)
        self._line.pitch(at_s, "right", 0.0)
        self._line.stand(at_s, self._point())
        self._line.key(at_s, Body(facing=self._heading, gaze=(self._heading, 0.0)))

    def _point(self) -> tuple[float, float]:
        return self._pair(self._at)

    @staticmethod
    def _pair(place: Float) -> tuple[float, float]:
        return float(place[0]), float(place[1])
