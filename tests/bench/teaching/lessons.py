"""Lessons made of cases: one pupil tries one after the other, and walks, waits and scratches his head in between."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from msgspec import UNSET

from edge.simulation.lesson.plan import PLAN_VERSION, PerformancePlan, Plan, PupilPlan
from edge.simulation.split import Split, generator
from models.motions.between import LEAST_S, PASTIMES
from models.motions.motion import Handed
from tests.bench.seeds import seeds_of
from tests.bench.teaching.cases import Case, filmed, single, well

_TRAVELS_M: Final = {
    "volleyball_spike": 1.1,
    "soccer_kick": 1.3,
    "long_jump": 1.6,
    "forward_roll": 2.4,
    "run": 7.1,
    "cartwheel": 0.0,
}
"""How far an action goes to the front: it begins half of that behind the acting area's middle. The cartwheel goes aside."""
_ASIDE_M: Final = 0.4
_WANDERS: Final = 0.35
"""Share of attempts at actions that stay where they are before which the pupil walks somewhere else."""
_WAIT_S: Final = (0.6, 3.0)
_LEFT_HANDED: Final = 0.2
_PUPIL_YEARS: Final = (7.0, 16.0)
_ADULT_YEARS: Final = (20.0, 50.0)


def lesson_of(name: str, split: Split, seed: int, cases: Sequence[Case]) -> Plan:
    """A lesson in which pupil `seed` of a split performs the cases, in an order by lot."""
    random = generator(split, "teaching lesson", seed)
    grown_up = seed == seeds_of(split)[-1]
    age_years = float(np.round(random.uniform(*(_ADULT_YEARS if grown_up else _PUPIL_YEARS)), 1))
    handed: Handed = "left" if random.uniform() < _LEFT_HANDED else "right"
    performs, back, away = [], False, True
    for number in random.permutation(len(cases)):
        performs.append(_performs(cases[number], handed, back, away, random))
        away = cases[number].action == "run"
        back = not back if cases[number].action in _TRAVELS_M else back
    pupil = PupilPlan(name="pupil", age_years=age_years, place_m=(-1.5, -1.0), performs=performs)
    return Plan(version=PLAN_VERSION, name=name, seed=seed, split=split, pupils=[pupil])


def lesson_of_all(split: Split, seed: int) -> Plan:
    """A lesson in which a pupil tries everything well, twice, and with each fault."""
    return lesson_of(f"teaching-cues-{seed}", split, seed, [*well(split, seed), *single(split, seed)])


def filmed_lesson(split: Split, seed: int) -> Plan:
    """The lesson of a pupil that is rendered."""
    return lesson_of(f"teaching-{'dev' if split == 'development' else split}-{seed}", split, seed, filmed(split, seed))


def _performs(case: Case, handed: Handed, back: bool, away: bool, random: np.random.Generator) -> PerformancePlan:
    """An attempt across the acting area, towards its other end; `away` says that the pupil is outside of it."""
    performance = case.performance(handed)
    wait_s = float(np.round(random.uniform(*_WAIT_S), 2))
    able = [pastime for pastime in PASTIMES if LEAST_S[pastime] <= wait_s]
    travel_m = _TRAVELS_M.get(case.action)
    walks = random.uniform() < _WANDERS or away or travel_m is not None
    behind_m = float(random.uniform(-0.5, 0.5)) if travel_m is None else travel_m / 2
    place = np.round((behind_m if back else -behind_m, random.uniform(-_ASIDE_M, _ASIDE_M)), 2)
    facing_deg = float(np.round((180.0 if back else 0.0) + random.normal(0, 8), 1))
    return PerformancePlan(
        action=performance.action,
        handed=handed,
        tempo=performance.tempo,
        amplitude=performance.amplitude,
        skill=performance.skill,
        faults=dict(performance.faults),
        seed=performance.seed,
        wait_s=wait_s,
        meanwhile=able[int(random.integers(len(able)))],
        jogs=bool(random.uniform() < 0.15),
        place_m=(float(place[0]), float(place[1])) if walks else UNSET,
        facing_deg=facing_deg if walks else UNSET,
    )
