"""Key poses in a coach's words, laid on a line of time, become a motion.

Each word has knots of its own: a key pose names those that it changes. Between knots a word goes monotonically, without
overshoot, its corners rounded. Feet are held by the floor from a landing to the next lift. The pelvis' keys fix where the
centre of mass is at their times; between them it goes smoothly, and in the air by gravity alone; the pelvis follows from it. So
the body gives way to the swing of its limbs, and leaves the floor with the very velocity that its flight takes.

Times are seconds from the motion's beginning, lengths are leg lengths (hip to ankle), so that a child's motion is a child's size.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Final, Literal

import numpy as np

from models.arrays import Bool, Float
from models.motions import posing, rotations, splines
from models.motions.ballistics import GRAVITY_M_S2
from models.motions.figure import figure_of
from models.motions.grounding import balanced
from models.motions.motion import CONTACTS, RATE_HZ, Attempt, Handed, Motion, Thing
from models.motions.standing import standing_values
from models.motions.subject import Subject
from models.motions.vocabulary import Arm, Body, Direction, Leg

Side = Literal["left", "right"]
Grip = tuple[Direction, Direction]

SOFT_S: Final = 0.012
"""Deviation of the Gaussian that rounds the corners of words."""
_HANGING_DEG: Final = 25.0
"""Pitch of a foot in the middle of a step."""
_TINY_S: Final = 1e-6
_YIELD_S: Final = 0.09
"""How long a foot takes from being held to being free, and back."""


Vary = Callable[[str, Float], Float]
"""Natural variation: another value for a word."""


def snapped(at_s: float) -> float:
    """The time of the nearest sample, so that what happens happens at one."""
    return round(at_s * RATE_HZ) / RATE_HZ


@dataclass(frozen=True)
class _Step:
    side: Side
    lift_s: float
    land_s: float
    place: tuple[float, float]
    yaw_deg: float
    height: float
    free: bool = False


@dataclass(frozen=True, eq=False)
class _Guide:
    side: Side
    pole: Float
    centre_m: Float
    gap_m: float
    weights: dict[float, Float]
    towards: dict[float, Float]
    fingers: dict[float, Float]


@dataclass(frozen=True, eq=False)
class Poses:
    """Sampled poses, before they are wrapped up as a motion. Fields as in `Motion`; `local` are rotations against the parents."""

    times_s: Float
    pelvis_m: Float
    local: Float


class Timeline:
    """Collects key poses; begins in `stand` at time 0.

    Everything is said of a right-handed person. For a left-handed one right and left change their places, here and nowhere else.
    """

    def __init__(self, subject: Subject, handed: Handed = "right", vary: Vary | None = None) -> None:
        self.figure = figure_of(subject)
        self._mirrored = handed == "left"
        self._vary = vary
        self._home = standing_values(self.figure)
        self._knots: dict[str, dict[float, Float]] = {name: {0.0: value} for name, value in self._home.items()}
        self._steps: list[_Step] = []
        self._flights: list[tuple[float, float]] = []
        self._guides: list[_Guide] = []

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
        self._move(_Step(side, snapped(lift_s), snapped(land_s), place, yaw, height))
        pitches = self._knots[f"{side}_foot.pitch"]
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
        self._move(_Step(side, snapped(lift_s), snapped(land_s), place, yaw, height=0.1, free=True))
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
        self._flights.append((snapped(off_s), snapped(on_s)))

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
        self._guides.append(_Guide(side, np.array(pole) * posing.OUT[side], centre_m * self.across, gap_m, knots, towards, fingers))

    def stand(self, at_s: float, at: tuple[float, float] = (0.0, 0.0)) -> None:
        """Back in `stand`, there; feet that are elsewhere must have stepped."""
        for name, value in self._home.items():
            if "_foot." not in name and name != "pelvis":
                self._knots[name][snapped(at_s)] = value
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
        self._knots[name][snapped(at_s)] = np.asarray(value, np.float64)

    def _set_pelvis(self, at_s: float, at: tuple[float, float] | None, height: float | None) -> None:
        if at is None and height is None:
            return
        times, values = self._ordered("pelvis")
        now = splines.monotone(times, values, np.array([at_s]))[0]
        place = now[:2] if at is None else self.leg_m * np.array(at) * self.across[:2]
        up = now[2] if height is None else self._home["pelvis"][2] * height
        self._set(at_s, "pelvis", np.array((*place, up)))

    def _move(self, step: _Step) -> None:
        if any(o.side == step.side and o.lift_s < step.land_s and step.lift_s < o.land_s for o in self._steps):
            raise ValueError(f"the {step.side} foot lifts at {step.lift_s:.3f} s, but is in the air for another step")
        if step.land_s <= step.lift_s:
            raise ValueError(f"the {step.side} foot would land at {step.land_s:.3f} s before it lifts at {step.lift_s:.3f} s")
        self._steps = sorted([*self._steps, step], key=lambda other: other.lift_s)

    def _ordered(self, name: str) -> tuple[Float, Float]:
        return _in_order(self._knots[name])

    def _sampled(self, at_s: Float, even: bool) -> dict[str, Float]:
        """All words at these times; `even` says that they are `RATE_HZ` apart, so that corners can be rounded."""
        values = {name: splines.monotone(*self._ordered(name), at_s) for name in self._knots if name != "pelvis"}
        if even:
            for name, value in values.items():
                if not name.endswith(("_foot.hold", "_foot.place", "_foot.yaw")):
                    values[name] = splines.softened(value, SOFT_S * RATE_HZ)
        for side in posing.SIDES:
            place, yaw, pitch = self._footprints(side, at_s)
            values[f"{side}_foot.place"], values[f"{side}_foot.yaw"] = place, yaw
            values[f"{side}_foot.pitch"] += pitch
        return values

    def _footprints(self, side: str, at_s: Float) -> tuple[Float, Float, Float]:
        """(T, 3) footprints, the sole's height as z, (T,) yaw and (T,) how far the toes hang in a step, in degrees."""
        home, out = self._home[f"{side}_foot.place"], 1.0 if side == "left" else -1.0
        place, yaw = np.tile(home, (len(at_s), 1)), np.full(len(at_s), float(self._home[f"{side}_foot.yaw"]))
        pitch = np.zeros(len(at_s))
        for step in self._steps:
            if step.side != side:
                continue
            share = (at_s - step.lift_s) / (step.land_s - step.lift_s)
            gone = _landing(share) if step.free else splines.minimum_jerk(share)
            target = home + self.leg_m * np.array((*step.place, 0.0))
            bump = np.sin(np.pi * np.clip(share, 0, 1)) ** 2
            place[:, :2] += gone[:, None] * (target - place)[:, :2]
            place[:, 2] += self.leg_m * step.height * bump
            yaw += gone * (out * step.yaw_deg - yaw)
            pitch += _HANGING_DEG * bump
        return place, yaw, pitch

    def _posed(self, values: dict[str, Float], at_s: Float) -> Float:
        guides = []
        for guide in self._guides:
            weight, towards, fingers = (
                splines.monotone(*_in_order(knots), at_s) for knots in (guide.weights, guide.towards, guide.fingers)
            )
            guides.append(
                posing.Guide(guide.side, guide.centre_m, guide.gap_m, rotations.unit(towards), fingers, weight, guide.pole)
            )
        return posing.upper_body(self.figure, values, tuple(guides))

    def _centre_of_mass(self, at_s: Float) -> Float:
        """(T, 3) smooth through where the pelvis' keys put it, ballistic in flights."""
        times, pelvis = self._ordered("pelvis")
        values = self._sampled(times, even=False)
        local = self._posed(values, times)
        posing.legs(self.figure, values, pelvis, local)
        places = self.figure.centres_of_mass_m(self.figure.place_local(pelvis, local))
        slopes = splines.monotone_slopes(times, places)
        for off_s, on_s in self._flights:
            off, on = self._number(times, off_s), self._number(times, on_s)
            if on != off + 1:
                raise ValueError(f"the pelvis has a key within the flight from {off_s:.3f} to {on_s:.3f} s, where gravity rules")
            mean = (places[on] - places[off]) / (on_s - off_s)
            change = np.array((0.0, 0.0, GRAVITY_M_S2 * (on_s - off_s) / 2))
            slopes[off], slopes[on] = mean + change, mean - change
        return splines.hermite(times, places, slopes, at_s)

    @staticmethod
    def _number(times: Float, at_s: float) -> int:
        found = np.flatnonzero(np.abs(times - at_s) < 1e-9)
        if len(found) != 1:
            raise ValueError(f"a flight begins or ends at {at_s:.3f} s, where the pelvis has no key")
        return int(found[0])

    def poses(self, end_s: float) -> Poses:
        """Sample from 0 to `end_s`, rounded up to a whole sample.

        Raises:
            ValueError: both feet are in the air without a flight, or a flight has no keys of the pelvis at its ends.
        """
        times = np.arange(int(np.ceil(end_s * RATE_HZ - 1e-6)) + 1) / RATE_HZ
        self._check_airborne(times)
        values = self._sampled(times, even=True)
        local = self._posed(values, times)
        pelvis = balanced(
            self.figure,
            self._centre_of_mass(times),
            local,
            lambda places, turned: posing.legs(self.figure, values, places, turned),
        )
        return Poses(times, pelvis, local)

    def _check_airborne(self, times_s: Float) -> None:
        flying = np.zeros(len(times_s), bool)
        for off_s, on_s in self._flights:
            flying |= (times_s > off_s) & (times_s < on_s)
        lost = np.flatnonzero(~self.contacts(times_s).any(1) & ~flying)
        if len(lost):
            raise ValueError(f"both feet are in the air at {times_s[lost[0]]:.3f} s, but no flight is said")

    def contacts(self, times_s: Float) -> Bool:
        """(T, 5) feet that are not in a step; nothing else bears."""
        contacts = np.zeros((len(times_s), len(CONTACTS)), bool)
        for number, side in enumerate(posing.SIDES):
            contacts[:, number] = True
            for step in self._steps:
                if step.side == side:
                    contacts[(times_s > step.lift_s + _TINY_S) & (times_s < step.land_s - _TINY_S), number] = False
        return contacts

    def motion(self, end_s: float, attempts: tuple[Attempt, ...] = (), things: tuple[Thing, ...] = ()) -> Motion:
        """Everything, sampled."""
        poses = self.poses(end_s)
        return self.wrapped(poses, attempts, things)

    def wrapped(self, poses: Poses, attempts: tuple[Attempt, ...] = (), things: tuple[Thing, ...] = ()) -> Motion:
        """Sampled poses as a motion."""
        turned = rotations.vectors(poses.local)
        return Motion(poses.pelvis_m, turned, self.contacts(poses.times_s), attempts, things)


def _landing(share: Float) -> Float:
    """From 0, still, to 1, arriving at an even pace, as a foot does whose body flies on over it."""
    u = np.clip(share, 0.0, 1.0)
    return np.asarray(u**2 * (2 - u))


def _in_order(knots: dict[float, Float]) -> tuple[Float, Float]:
    times = np.array(sorted(knots))
    return times, np.stack([knots[at_s] for at_s in times])
