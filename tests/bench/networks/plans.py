"""Lessons for judging networks: every action there is, few pictures a second, many people."""

from typing import Final

import numpy as np

from edge.simulation.plan import PLAN_VERSION, PerformancePlan, Plan, PupilPlan
from edge.simulation.split import Split, generator
from models.motions.actions.library import ACTIONS
from models.motions.performance import AMPLITUDE

RATE_HZ: Final = 4.0
"""Neighbouring pictures of a film tell a network's errors twice."""
_BEFORE_M: Final = 0.8
"""How far before the court's middle an action begins, since many go forwards."""
_TEMPO: Final = (0.85, 1.2)


def plan_of(seed: int, split: Split) -> Plan:
    """Whoever is cast by this seed performs all actions, each looking another way."""
    random = generator(split, "networks", seed)
    performs = []
    for name in ACTIONS:
        facing = float(random.uniform(-np.pi, np.pi))
        performs.append(
            PerformancePlan(
                action=name,
                tempo=round(float(random.uniform(*_TEMPO)), 3),
                amplitude=round(float(random.uniform(AMPLITUDE[0] + 0.1, AMPLITUDE[1] - 0.1)), 3),
                skill=round(float(random.uniform(0.3, 1.0)), 3),
                wait_s=0.3,
                place_m=(round(-_BEFORE_M * float(np.cos(facing)), 3), round(-_BEFORE_M * float(np.sin(facing)), 3)),
                facing_deg=round(float(np.degrees(facing)), 1),
            )
        )
    return Plan(
        version=PLAN_VERSION,
        name=f"networks-{split}-{seed}",
        seed=seed,
        split=split,
        rate_hz=RATE_HZ,
        pupils=[PupilPlan(name="pupil", performs=performs)],
    )
