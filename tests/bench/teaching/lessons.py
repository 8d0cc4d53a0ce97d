"""Lessons made of cases: one pupil tries one after the other, and walks, waits and scratches his head in between."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from edge.simulation.lesson.plan import PLAN_VERSION, PerformancePlan, Plan, PupilPlan
from edge.simulation.split import Split, generator
from models.motions.between import LEAST_S, PASTIMES
from models.motions.motion import Handed
from tests.bench.seeds import seeds_of
from tests.bench.teaching.cases import Case, filmed

_AHEAD_M: Final = 1.6
_ASIDE_M: Final = 0.8
"""Attempts begin so far behind the middle of the acting area and look across it, by turns from either end; so far aside at most."""
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
    performs = [
        _performs(cases[number], handed, turn % 2 == 1, random) for turn, number in enumerate(random.permutation(len(cases)))
    ]
    pupil = PupilPlan(name="pupil", age_years=age_years, place_m=(-1.5, -1.0), performs=performs)
    return Plan(version=PLAN_VERSION, name=name, seed=seed, split=split, pupils=[pupil])


def filmed_lesson(split: Split, seed: int) -> Plan:
    """The lesson of a pupil that is rendered."""
    return lesson_of(f"teaching-{'dev' if split == 'development' else split}-{seed}", split, seed, filmed(split, seed))


def _performs(case: Case, handed: Handed, back: bool, random: np.random.Generator) -> PerformancePlan:
    performance = case.performance(handed)
    wait_s = float(np.round(random.uniform(*_WAIT_S), 2))
    able = [pastime for pastime in PASTIMES if LEAST_S[pastime] <= wait_s]
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
        place_m=(_AHEAD_M if back else -_AHEAD_M, float(np.round(random.uniform(-_ASIDE_M, _ASIDE_M), 2))),
        facing_deg=(180.0 if back else 0.0) + float(np.round(random.normal(0, 12), 1)),
    )
