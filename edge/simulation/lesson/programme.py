"""What a pupil does in a lesson, from its plan: goes to his place, waits, performs, in order, as one motion."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from msgspec import UNSET

from edge.simulation.lesson.plan import PerformancePlan, Plan, PupilPlan
from models.errors import UserError
from models.motions.between import LEAST_S, Between, Go, Pass, idle_time, spend
from models.motions.motion import RATE_HZ, Motion
from models.motions.perform import perform
from models.motions.sequence import Act, Sequence
from models.motions.standpoint import Standpoint
from models.motions.subject import Subject

ABOUT_M = 0.6
"""How far a bystander strays from his place."""
_SHORTEST_S = 2 / RATE_HZ


@dataclass(frozen=True, eq=False)
class Programme:
    """What a pupil does.

    Attributes:
        motion: from the lesson's beginning; afterwards he stands as at its end.
        begins: where he stands and to where he looks as each performance of his plan begins.
    """

    motion: Motion
    begins: tuple[Standpoint, ...]


def programme_of(plan: Plan, pupil: int, subject: Subject) -> Programme:
    """The programme of pupil number `pupil`.

    Raises:
        UserError: something shall begin before what is before it is over; the line names the key.
    """
    wanted = plan.pupils[pupil]
    start = Standpoint(*wanted.place_m, math.radians(wanted.facing_deg))
    director = _Director(plan, pupil, subject)
    motion = Sequence(director.acts(), start).motion()
    return Programme(motion, tuple(director.begins[number] for number in range(len(wanted.performs))))


class _Director:
    """Hands out acts one by one, each when the length of the one before it is known."""

    def __init__(self, plan: Plan, pupil: int, subject: Subject) -> None:
        self._plan = plan
        self._pupil = pupil
        self._subject = subject
        self._now_s = 0.0
        self.begins: dict[int, Standpoint] = {}

    def acts(self) -> Iterator[Act]:
        """In their order."""
        performs = self._plan.pupils[self._pupil].performs
        for number, wanted in enumerate(performs):
            if wanted.place_m is not UNSET or wanted.facing_deg is not UNSET:
                yield self._timed(partial(self._go, wanted, self._lot("way", number)))
            wait_s = self._wait_s(number, wanted)
            if wait_s >= _SHORTEST_S:
                yield self._timed(self._spend(Pass(wanted.meanwhile, wait_s, self._lot("wait", number))))
            yield self._timed(self._perform(number))
        length_s = 0.0 if self._plan.length_s is UNSET else self._plan.length_s
        rest_s = max(length_s - self._now_s, 0.0)
        if not performs and rest_s > LEAST_S["wait"]:
            for what in idle_time(rest_s, self._about, self._lot("idle", 0)):
                yield self._timed(self._spend(what))
        elif rest_s >= _SHORTEST_S or not performs:
            yield self._timed(self._spend(Pass("wait", max(rest_s, _SHORTEST_S), self._lot("rest", 0))))

    def _wait_s(self, number: int, wanted: PerformancePlan) -> float:
        """How long he waits before something, once he is at its place."""
        key = f"lesson plan {self._plan.name}: pupils[{self._pupil}].performs[{number}]"
        wait_s = wanted.wait_s if wanted.begins_s is UNSET else wanted.begins_s - self._now_s
        if wait_s < 0:
            raise UserError(
                f"{key}.begins_s is {wanted.begins_s:g}, but the pupil is ready only at {self._now_s:.2f} s; "
                "have it begin later, or what is before it earlier"
            )
        if wanted.meanwhile != "wait" and wait_s < LEAST_S[wanted.meanwhile]:
            raise UserError(
                f"{key}.meanwhile is '{wanted.meanwhile}', which takes {LEAST_S[wanted.meanwhile]:g} s, but there are only "
                f"{wait_s:.2f} s for it; have him wait longer, or do something else"
            )
        return wait_s

    def _go(self, wanted: PerformancePlan, seed: int, at: Standpoint) -> Motion:
        x_m, y_m = (at.x_m, at.y_m) if wanted.place_m is UNSET else wanted.place_m
        heading = at.heading_rad if wanted.facing_deg is UNSET else math.radians(wanted.facing_deg)
        return spend(Go(Standpoint(x_m, y_m, heading), wanted.jogs, seed), self._subject, at)

    def _perform(self, number: int) -> Act:
        performance = self._plan.performance(self._pupil, number)

        def act(at: Standpoint) -> Motion:
            self.begins[number] = at
            return perform(performance, self._subject)

        return act

    def _spend(self, what: Between) -> Act:
        return lambda at: spend(what, self._subject, at)

    def _about(self, random: np.random.Generator) -> Standpoint:
        """Somewhere near his place, looking about where he looked at first."""
        wanted: PupilPlan = self._plan.pupils[self._pupil]
        x_m, y_m = (value + random.uniform(-ABOUT_M, ABOUT_M) for value in wanted.place_m)
        return Standpoint(float(x_m), float(y_m), math.radians(wanted.facing_deg) + float(random.normal(0, 0.5)))

    def _lot(self, what: str, number: int) -> int:
        return self._plan.lot(what, self._pupil, number)

    def _timed(self, act: Act) -> Act:
        """The same act; its length is added to the time when it is first performed."""
        known = False

        def timed(at: Standpoint) -> Motion:
            nonlocal known
            motion = act(at)
            if not known:
                self._now_s, known = self._now_s + motion.duration_s, True
            return motion

        return timed
