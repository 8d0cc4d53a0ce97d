"""Lessons for judging networks: every action there is, few pictures a second, many people."""

from typing import Final

import numpy as np
from msgspec import UNSET

from edge.simulation.lesson.plan import PLAN_VERSION, PerformancePlan, Plan, PupilPlan
from edge.simulation.split import Split, generator
from models.motions.actions.library import ACTIONS
from models.motions.performance import AMPLITUDE

RATE_HZ: Final = 2.0
"""Neighbouring pictures of a film tell a network's errors twice."""
_GOES: Final = ("volleyball_spike", "soccer_kick", "long_jump", "forward_roll", "cartwheel", "run")
"""Actions that end elsewhere than they began: one leads forth, the next one back."""
_BEFORE_M: Final = 1.0
"""How far before the court's middle the pupil begins."""
_RUN_M: Final = 7.0
"""As far as most run; the middle of it is the court's, or the cameras do not see him begin and end."""
_TEMPO: Final = (0.85, 1.2)


def plan_of(seed: int, split: Split) -> Plan:
    """Whoever is cast by this seed performs all actions."""
    random = generator(split, "networks", seed)
    forth_deg = round(float(random.uniform(-180, 0)), 1)
    performs = [
        PerformancePlan(
            action=name,
            tempo=round(float(random.uniform(*_TEMPO)), 3),
            amplitude=round(float(random.uniform(AMPLITUDE[0] + 0.1, AMPLITUDE[1] - 0.1)), 3),
            skill=round(float(random.uniform(0.3, 1.0)), 3),
            wait_s=0.1,
            place_m=_along(_RUN_M / 2, forth_deg) if name == "run" else UNSET,
            facing_deg=forth_deg + 180.0 * (_GOES.index(name) % 2) if name in _GOES else UNSET,
        )
        for name in sorted(ACTIONS, key=lambda name: (name in _GOES, _GOES.index(name) if name in _GOES else 0, name))
    ]
    return Plan(
        version=PLAN_VERSION,
        name=f"networks-{split}-{seed}",
        seed=seed,
        split=split,
        rate_hz=RATE_HZ,
        pupils=[PupilPlan(name="pupil", place_m=_along(-_BEFORE_M, forth_deg), facing_deg=forth_deg, performs=performs)],
    )


def _along(distance_m: float, direction_deg: float) -> tuple[float, float]:
    """That far from the court's middle."""
    angle = np.radians(direction_deg)
    return round(float(distance_m * np.cos(angle)), 3), round(float(distance_m * np.sin(angle)), 3)
