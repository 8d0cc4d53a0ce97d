"""All that was said of a motion, and what comes of it: words between knots, footprints, the way of the centre of mass, poses."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.motions import posing, rotations, splines
from models.motions.ballistics import GRAVITY_M_S2
from models.motions.figure import Figure
from models.motions.grounding import balanced
from models.motions.motion import CONTACTS, RATE_HZ
from models.motions.standing import standing_values
from models.motions.vocabulary import Side

SOFT_S: Final = 0.012
"""Deviation of the Gaussian that rounds the corners of words."""
_HANGING_DEG: Final = 25.0
"""Pitch of a foot in the middle of a step."""
_TINY_S: Final = 1e-6


@dataclass(frozen=True)
class Step:
    """A foot's way from its footprint to the next; places are in leg lengths from where the foot stood first.

    Attributes:
        side: of the foot.
        lift_s, land_s: its last and its next contact.
        place: (x, y).
        yaw_deg: of the toes, outwards.
        height: of the sole in the middle.
        free: it goes by the words of its leg.
    """

    side: Side
    lift_s: float
    land_s: float
    place: tuple[float, float]
    yaw_deg: float
    height: float
    free: bool = False


@dataclass(frozen=True, eq=False)
class Following:
    """A hand that lies on a ball: as `posing.Guide`, with knots by time."""

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


class Score:
    """What `models.motions.timeline.Timeline` collects; of the person himself, no longer of a right-handed one.

    Attributes:
        figure: who moves.
        home: all words as he stands, and his pelvis and footprints in metres.
        knots: values by time, by word.
        steps: of both feet, in the order of their lifts.
        flights: first and last moment without any contact.
        guides: hands that lie on a ball.
    """

    def __init__(self, figure: Figure) -> None:
        self.figure = figure
        self.home = standing_values(figure)
        self.knots: dict[str, dict[float, Float]] = {name: {0.0: value} for name, value in self.home.items()}
        self.steps: list[Step] = []
        self.flights: list[tuple[float, float]] = []
        self.guides: list[Following] = []

    def add_step(self, step: Step) -> None:
        """Raises ValueError for a foot that is in the air for another step."""
        if any(o.side == step.side and o.lift_s < step.land_s and step.lift_s < o.land_s for o in self.steps):
            raise ValueError(f"the {step.side} foot lifts at {step.lift_s:.3f} s, but is in the air for another step")
        if step.land_s <= step.lift_s:
            raise ValueError(f"the {step.side} foot would land at {step.land_s:.3f} s before it lifts at {step.lift_s:.3f} s")
        self.steps = sorted([*self.steps, step], key=lambda other: other.lift_s)

    def ordered(self, name: str) -> tuple[Float, Float]:
        """(N,) times and (N, ...) values of a word's knots."""
        return _in_order(self.knots[name])

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

    def contacts(self, times_s: Float) -> Bool:
        """(T, 5) feet that are not in a step; nothing else bears."""
        contacts = np.zeros((len(times_s), len(CONTACTS)), bool)
        for number, side in enumerate(posing.SIDES):
            contacts[:, number] = True
            for step in self.steps:
                if step.side == side:
                    contacts[(times_s > step.lift_s + _TINY_S) & (times_s < step.land_s - _TINY_S), number] = False
        return contacts

    def _check_airborne(self, times_s: Float) -> None:
        flying = np.zeros(len(times_s), bool)
        for off_s, on_s in self.flights:
            flying |= (times_s > off_s) & (times_s < on_s)
        lost = np.flatnonzero(~self.contacts(times_s).any(1) & ~flying)
        if len(lost):
            raise ValueError(f"both feet are in the air at {times_s[lost[0]]:.3f} s, but no flight is said")

    def _sampled(self, at_s: Float, even: bool) -> dict[str, Float]:
        """All words at these times; `even` says that they are `RATE_HZ` apart, so that corners can be rounded."""
        values = {name: splines.monotone(*self.ordered(name), at_s) for name in self.knots if name != "pelvis"}
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
        home, out = self.home[f"{side}_foot.place"], 1.0 if side == "left" else -1.0
        place, yaw = np.tile(home, (len(at_s), 1)), np.full(len(at_s), float(self.home[f"{side}_foot.yaw"]))
        pitch = np.zeros(len(at_s))
        for step in self.steps:
            if step.side != side:
                continue
            share = (at_s - step.lift_s) / (step.land_s - step.lift_s)
            gone = _landing(share) if step.free else splines.minimum_jerk(share)
            target = home + self.figure.leg_m * np.array((*step.place, 0.0))
            bump = np.sin(np.pi * np.clip(share, 0, 1)) ** 2
            place[:, :2] += gone[:, None] * (target - place)[:, :2]
            place[:, 2] += self.figure.leg_m * step.height * bump
            yaw += gone * (out * step.yaw_deg - yaw)
            pitch += _HANGING_DEG * bump
        return place, yaw, pitch

    def _posed(self, values: dict[str, Float], at_s: Float) -> Float:
        guides = []
        for guide in self.guides:
            weight, towards, fingers = (
                splines.monotone(*_in_order(knots), at_s) for knots in (guide.weights, guide.towards, guide.fingers)
            )
            guides.append(
                posing.Guide(guide.side, guide.centre_m, guide.gap_m, rotations.unit(towards), fingers, weight, guide.pole)
            )
        return posing.upper_body(self.figure, values, tuple(guides))

    def _centre_of_mass(self, at_s: Float) -> Float:
        """(T, 3) smooth through where the pelvis' keys put it, ballistic in flights."""
        times, pelvis = self.ordered("pelvis")
        values = self._sampled(times, even=False)
        local = self._posed(values, times)
        posing.legs(self.figure, values, pelvis, local)
        places = self.figure.centres_of_mass_m(self.figure.place_local(pelvis, local))
        slopes = splines.monotone_slopes(times, places)
        for off_s, on_s in self.flights:
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


def _landing(share: Float) -> Float:
    """From 0, still, to 1, arriving at an even pace, as a foot does whose body flies on over it."""
    u = np.clip(share, 0.0, 1.0)
    return np.asarray(u**2 * (2 - u))


def _in_order(knots: dict[float, Float]) -> tuple[Float, Float]:
    times = np.array(sorted(knots))
    return times, np.stack([knots[at_s] for at_s in times])
