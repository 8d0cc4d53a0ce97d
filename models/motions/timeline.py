"""Key poses in a coach's words, laid on a line of time, become a motion.

Each word has knots of its own: a key pose names those that it changes. Between knots a word goes monotonically, without
overshoot, its corners rounded. Feet are held by the floor from a landing to the next lift. The pelvis' keys fix where the
centre of mass is at their times; between them it goes smoothly, and in the air by gravity alone; the pelvis follows from it. So
the body gives way to the swing of its limbs, and leaves the floor with the very velocity that its flight takes.

Times are seconds from the motion's beginning, lengths are leg lengths (hip to ankle), so that a child's motion is a child's size.
"""

from collections.abc import Callable
from dataclasses import fields
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.motions import posing, rotations, splines
from models.motions.figure import Figure, figure_of
from models.motions.motion import RATE_HZ, Attempt, Handed, Motion, Thing
from models.motions.score import Following, Poses, Score, Step
from models.motions.subject import Subject
from models.motions.vocabulary import Arm, Body, Direction, Leg, Side

__all__ = ["Grip", "Poses", "Side", "Timeline", "Vary", "snapped"]

Grip = tuple[Direction, Direction]

_YIELD_S: Final = 0.09
"""How long a foot takes from being held to being free, and back."""


Vary = Callable[[str, Float], Float]
"""Natural variation: another value for a word."""


def snapped(at_s: float) -> float:
    """The time of the nearest sample, so that what happens happens at one."""
    return round(at_s * RATE_HZ) / RATE_HZ


class Timeline:
    """Collects key poses; begins in `stand` at time 0.

    Everything is said of a right-handed person. For a left-handed one right and left change their places, here and nowhere else.
    """

    def __init__(self, subject: Subject, handed: Handed = "right", vary: Vary | None = None) -> None:
        self._score = Score(figure_of(subject))
        self._mirrored = handed == "left"
        self._vary = vary

    @property
    def figure(self) -> Figure:
        """Who moves."""
        return self._score.figure

    @property
    def leg_m(self) -> float:
        """The unit of lengths."""
        return self.figure.leg_m

    def side(self, side: Side) -> Side:
        """Whose side that is: the other one for a left-handed person."""
        return side if not self._mirrored else "left" if side == "right" else "right"

    @property
    def across(self) -> Float:
        """(3,) by which directions and places are multiplied for this person: y goes the other way for a left-handed one."""
        return np.array((1.0, -1.0 if self._mirrored else 1.0, 1.0))

    def key(
        self,
        at_s: float,
        body: Body | None = None,
        left_arm: Arm | None = None,
        right_arm: Arm | None = None,
        left_leg: Leg | None = None,
        right_leg: Leg | None = None,
        exact: bool = False,
    ) -> None:
        """A key pose: what its words say, at this time. A later call for the same time and word takes its place.

        Args:
            at_s: time.
            body: and
            left_arm: and
            right_arm: and
            left_leg: and
            right_leg: the words.
            exact: said as it is, without natural variation: where a ball is to be met.
        """
        vary = None if exact else self._vary
        for prefix, words in (
            ("left_arm.", left_arm),
            ("right_arm.", right_arm),
            ("left_leg.", left_leg),
            ("right_leg.", right_leg),
        ):
            if words is not None:
                side, limb = prefix.split("_")
                side = self.side("left" if side == "left" else "right")
                for field in fields(words):
                    self._say(at_s, f"{side}_{limb}{field.name}", field.name, getattr(words, field.name), vary)
        if body is not None:
            for name, value in (("tip", body.tip), ("lean", body.lean)):
                self._say(at_s, name, name, value, vary)
            for name, value in (("facing", body.facing), ("side", body.side), ("bow", body.bow), ("twist", body.twist)):
                self._say(at_s, name, name, value, vary, self.across[1])
            self._say(at_s, "gaze", "gaze", body.gaze, vary, np.array((self.across[1], 1.0)))
            self._set_pelvis(at_s, body.at, body.height)

    def arms(self, at_s: float, both: Arm) -> None:
        """Both arms alike."""
        self.key(at_s, left_arm=both, right_arm=both)

    def legs(self, at_s: float, both: Leg) -> None:
        """Both legs alike."""
        self.key(at_s, left_leg=both, right_leg=both)

    def step(
        self,
        side: Side,
        lift_s: float,
        land_s: float,
        place: tuple[float, float],
        yaw: float = 0.0,
        height: float = 0.12,
        pitch: float = 0.0,
        flat_s: float = 0.12,
        heel: float = 0.0,
        heel_s: float = 0.16,
    ) -> None:
        """A foot goes from where it stands to a new footprint.

        Args:
            side: of the foot.
            lift_s: its last contact.
            land_s: its next contact.
            place: (front, left) against where this foot stood when the action began.
            yaw: of the toes, degrees, outwards.
            height: of the sole in the middle of the step.
            pitch: with which it lands, degrees: below 0 on the heel, above 0 on the toes.
            flat_s: from the landing until it stands flat.
            heel: how far it has raised its heel when it lifts, degrees. More if the leg needs it; but a leg that is pulled straight
                in a long stride jerks when it is let go, so a stride takes 30 to 45 here.
            heel_s: how long before the lift the heel begins to rise.
        """
        side, place = self.side(side), (place[0], place[1] * self.across[1])
        self._score.add_step(Step(side, snapped(lift_s), snapped(land_s), place, yaw, height))
        pitches = self._score.knots[f"{side}_foot.pitch"]
        if heel:
            since = max([lift_s - heel_s, *(at_s for at_s in pitches if at_s < lift_s)])
            self._set(since, f"{side}_foot.pitch", float(pitches.get(snapped(since), np.zeros(()))))
            self._set(lift_s, f"{side}_foot.pitch", heel)
        elif not any(lift_s - 0.15 < at_s <= lift_s for at_s in pitches):
            self._set(lift_s, f"{side}_foot.pitch", 0.0)
        self._set(land_s, f"{side}_foot.pitch", pitch)
        if pitch:
            self._set(land_s + flat_s, f"{side}_foot.pitch", 0.0)

    def swing(
        self,
        side: Side,
        lift_s: float,
        land_s: float,
        place: tuple[float, float],
        yaw: float = 0.0,
        pitch: float = 0.0,
        flat_s: float = 0.1,
    ) -> None:
        """A foot leaves the floor, goes by the words of its leg (`Leg`), and lands. Arguments as `step`."""
        side, place = self.side(side), (place[0], place[1] * self.across[1])
        self._score.add_step(Step(side, snapped(lift_s), snapped(land_s), place, yaw, height=0.1, free=True))
        ease = min(_YIELD_S, 0.4 * (land_s - lift_s))
        for at_s, hold in ((lift_s, 1.0), (lift_s + ease, 0.0), (land_s - ease, 0.0), (land_s, 1.0)):
            self._set(at_s, f"{side}_foot.hold", hold)
        self._set(lift_s, f"{side}_foot.pitch", 0.0)
        self._set(land_s, f"{side}_foot.pitch", pitch)
        self._set(land_s + flat_s, f"{side}_foot.pitch", 0.0)

    def pitch(self, at_s: float, side: Side, degrees: float) -> None:
        """A held foot raises its heel (above 0) or its toes (below 0) at least this far."""
        self._set(at_s, f"{self.side(side)}_foot.pitch", degrees)

    def knee(self, at_s: float, side: Side, degrees: float) -> None:
        """The knee over a held foot points so far beside the toes: outwards, or inwards (below 0)."""
        self._set(at_s, f"{self.side(side)}_foot.knee", degrees)

    def flight(self, off_s: float, on_s: float) -> None:
        """Nothing touches the floor in between; both times need a key of the pelvis."""
        self._score.flights.append((snapped(off_s), snapped(on_s)))

    def guide(
        self, side: Side, pole: Direction, weights: dict[float, float], centre_m: Float, gap_m: float, grips: dict[float, Grip]
    ) -> None:
        """A hand lies on a ball that the other hand carries (see `posing.Guide`).

        Args:
            side: the hand that follows.
            pole: (front, out, up) where its elbow points, against the chest.
            weights: at times, 1 follows, 0 does not.
            centre_m: (3,) of the ball from the other wrist, in that hand's frame, for a right-handed person.
            gap_m: of the palm's skeleton from the ball's centre.
            grips: at times, from the centre to the palm, and the fingers' direction, in the same frame.
        """
        side = self.side(side)
        towards, fingers = ({snapped(at_s): np.array(grip[part]) * self.across for at_s, grip in grips.items()} for part in (0, 1))
        knots = {snapped(at_s): np.array(weight) for at_s, weight in weights.items()}
        self._score.guides.append(
            Following(side, np.array(pole) * posing.OUT[side], centre_m * self.across, gap_m, knots, towards, fingers)
        )

    def stand(self, at_s: float, at: tuple[float, float] = (0.0, 0.0)) -> None:
        """Back in `stand`, there; feet that are elsewhere must have stepped."""
        for name, value in self._score.home.items():
            if "_foot." not in name and name != "pelvis":
                self._score.knots[name][snapped(at_s)] = value
        self._set_pelvis(at_s, at, 1.0)

    def _say(
        self,
        at_s: float,
        name: str,
        word: str,
        value: float | tuple[float, ...] | None,
        vary: Vary | None,
        mirror: Float | float = 1.0,
    ) -> None:
        if value is not None:
            said = np.asarray(value, np.float64)
            self._set(at_s, name, mirror * (said if vary is None else vary(word, said)))

    def _set(self, at_s: float, name: str, value: float | Float) -> None:
        self._score.knots[name][snapped(at_s)] = np.asarray(value, np.float64)

    def _set_pelvis(self, at_s: float, at: tuple[float, float] | None, height: float | None) -> None:
        if at is None and height is None:
            return
        times, values = self._score.ordered("pelvis")
        now = splines.monotone(times, values, np.array([at_s]))[0]
        place = now[:2] if at is None else self.leg_m * np.array(at) * self.across[:2]
        up = now[2] if height is None else self._score.home["pelvis"][2] * height
        self._set(at_s, "pelvis", np.array((*place, up)))

    def poses(self, end_s: float) -> Poses:
        """Sample from 0 to `end_s`, rounded up to a whole sample.

        Raises:
            ValueError: both feet are in the air without a flight, or a flight has no keys of the pelvis at its ends.
        """
        return self._score.poses(end_s)

    def contacts(self, times_s: Float) -> Bool:
        """(T, 5) feet that are not in a step; nothing else bears."""
        return self._score.contacts(times_s)

    def motion(self, end_s: float, attempts: tuple[Attempt, ...] = (), things: tuple[Thing, ...] = ()) -> Motion:
        """Everything, sampled."""
        poses = self.poses(end_s)
        return self.wrapped(poses, attempts, things)

    def wrapped(self, poses: Poses, attempts: tuple[Attempt, ...] = (), things: tuple[Thing, ...] = ()) -> Motion:
        """Sampled poses as a motion."""
        turned = rotations.vectors(poses.local)
        return Motion(poses.pelvis_m, turned, self.contacts(poses.times_s), attempts, things)
