"""The lesson plans that come with KineBox, and those that benches make by seed."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final, Literal

import numpy as np

from edge.simulation.files import SHIPPED
from edge.simulation.plan import PLAN_VERSION, PerformancePlan, Plan, PupilPlan, ShutterPlan
from edge.simulation.split import Split, generator
from models.motions.performance import AMPLITUDE

SIX_ACTIONS: Final = ("basketball_shot", "long_jump", "forward_roll", "badminton_clear", "volleyball_spike", "soccer_kick")
SLOT_S: Final = 4.0
_LEAD_S: Final = 0.4
_TEMPO: Final = (0.85, 1.2)
_LEFT_HANDED: Final = 0.15


@dataclass(frozen=True)
class Preset:
    """A plan by name: what it is, in a line, and how it is made."""

    what: str
    make: Callable[[], Plan]


def six_actions() -> Plan:
    """The lesson that is shipped: a girl of twelve performs the six actions as the standards say, seen from four corners."""
    return Plan(
        version=PLAN_VERSION,
        name=SHIPPED,
        seed=1,
        rig="corners",
        length_s=SLOT_S * len(SIX_ACTIONS),
        pupils=[
            PupilPlan(
                name="pupil",
                age_years=12.0,
                sex="female",
                performs=[PerformancePlan(action=name, begins_s=begins_s(number)) for number, name in enumerate(SIX_ACTIONS)],
            )
        ],
    )


def begins_s(number: int) -> float:
    """When the `number`th action of a lesson begins that has one every `SLOT_S`."""
    return _LEAD_S + SLOT_S * number


def acceptance(
    seed: int, split: Split = "test", rig: str = "corners", phases: Literal["synced", "free_running"] = "synced"
) -> Plan:
    """A lesson on which figures are measured: whoever is cast by this seed performs the six actions in his own way.

    Args:
        seed: of the pupil, the gym, the rig's variant and how well, how fast and how largely he performs.
        split: figures of merit are measured on "test" only.
        rig: where the cameras stand.
        phases: see `ShutterPlan`.
    """
    random = generator(split, "acceptance", seed)
    handed: Literal["right", "left"] = "left" if random.uniform() < _LEFT_HANDED else "right"
    performs = [
        PerformancePlan(
            action=name,
            handed=handed,
            tempo=_round(random.uniform(*_TEMPO)),
            amplitude=_round(random.uniform(AMPLITUDE[0] + 0.1, AMPLITUDE[1] - 0.1)),
            skill=_round(random.uniform(0.3, 1.0)),
            begins_s=begins_s(number),
        )
        for number, name in enumerate(SIX_ACTIONS)
    ]
    return Plan(
        version=PLAN_VERSION,
        name=f"acceptance-{split}-{rig}-{seed}".replace("_", "-")[:32],
        seed=seed,
        split=split,
        rig=rig,
        length_s=SLOT_S * len(SIX_ACTIONS),
        shutter=ShutterPlan(phases=phases),
        pupils=[PupilPlan(name="pupil", performs=performs)],
    )


def tiny(cameras: int = 2, length_s: float = 1.0) -> Plan:
    """A lesson for tests: a pupil who stands, small, short."""
    return Plan(
        version=PLAN_VERSION,
        name="tiny",
        seed=1,
        cameras=cameras,
        size_px=(320, 180),
        length_s=length_s,
        pupils=[PupilPlan(name="pupil")],
    )


def _round(value: float) -> float:
    return float(np.round(value, 3))


PRESETS: Final = {
    SHIPPED: Preset(
        "the six actions in 24 s, four cameras in the corners; the lesson that comes rendered with KineBox", six_actions
    ),
    "tiny": Preset("a second of a pupil who stands, two cameras, small pictures: to see whether this machine can render", tiny),
    **{
        f"acceptance_{seed}": Preset(
            f"the six actions by test pupil {seed}, on whom figures are measured", partial(acceptance, seed)
        )
        for seed in range(5)
    },
}
"""By name."""
