"""The lesson plans that come with KineBox, and those that benches make by seed."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Final, Literal

import numpy as np
from msgspec import UNSET

from edge.simulation.lesson.files import SHIPPED
from edge.simulation.lesson.plan import PLAN_VERSION, PerformancePlan, Plan, PupilPlan, ShutterPlan
from edge.simulation.split import Split, generator
from models.motions.performance import AMPLITUDE

_START_M: Final = (-1.5, -1.1)
_BACK_DEG: Final = 152.0
SIX_ACTIONS: Final = ("volleyball_spike", "basketball_shot", "badminton_clear", "long_jump", "soccer_kick", "forward_roll")
"""In the order in which a pupil performs them in the acting area: there along one side, then he turns, and back to the mat."""
_TURNS_BEFORE: Final = "soccer_kick"
_WAIT_S: Final = 0.5
_TEMPO: Final = (0.85, 1.2)
_LEFT_HANDED: Final = 0.15
_PUPIL_YEARS: Final = (7.0, 16.0)
_ADULT_YEARS: Final = (20.0, 50.0)
_ADULT_EVERY: Final = 5
_NAME_LENGTH: Final = 32
"""`models.config.site.Name` has at most so many characters."""


@dataclass(frozen=True)
class Preset:
    """A plan by name: what it is, in a line, and how it is made."""

    what: str
    make: Callable[[], Plan]


def six_actions() -> Plan:
    """The lesson that is shipped: a girl of twelve performs the six actions as the standards say, seen from four corners."""
    performs = [_performs(action) for action in SIX_ACTIONS]
    pupil = PupilPlan(name="pupil", age_years=12.0, sex="female", looks=2, place_m=_START_M, performs=performs)
    return _lesson(SHIPPED, 0, pupil, gym=1, split="development")


def acceptance(
    seed: int, split: Split = "test", rig: str = "corners", phases: Literal["synced", "free_running"] = "synced"
) -> Plan:
    """A lesson on which figures are measured: whoever is cast by this seed performs the six actions in his own way.

    Of five seeds that follow one another, four are of pupils and one of a grown-up.

    Args:
        seed: of the pupil, the gym, the rig's variant and how well, how fast and how largely he performs.
        split: figures of merit are measured on "test" only.
        rig: where the cameras stand.
        phases: see `ShutterPlan`.
    """
    random = generator(split, "acceptance", seed)
    age_years = _round(random.uniform(*(_ADULT_YEARS if seed % _ADULT_EVERY == _ADULT_EVERY - 1 else _PUPIL_YEARS)))
    handed: Literal["right", "left"] = "left" if random.uniform() < _LEFT_HANDED else "right"
    performs = [
        _performs(
            action,
            handed=handed,
            tempo=_round(random.uniform(*_TEMPO)),
            amplitude=_round(random.uniform(AMPLITUDE[0] + 0.1, AMPLITUDE[1] - 0.1)),
            skill=_round(random.uniform(0.3, 1.0)),
        )
        for action in SIX_ACTIONS
    ]
    name = f"acceptance-{split}-{rig}-{seed}".replace("_", "-")
    if len(name) > _NAME_LENGTH:
        name = name.replace("acceptance", "accept").replace("development", "dev")
    pupil = PupilPlan(name="pupil", age_years=age_years, place_m=_START_M, performs=performs)
    return _lesson(name, seed, pupil, split=split, rig=rig, shutter=ShutterPlan(phases=phases))


def _performs(action: str, **how: Any) -> PerformancePlan:
    return PerformancePlan(action=action, wait_s=_WAIT_S, facing_deg=_BACK_DEG if action == _TURNS_BEFORE else UNSET, **how)


def _lesson(name: str, seed: int, pupil: PupilPlan, **more: Any) -> Plan:
    return Plan(version=PLAN_VERSION, name=name, seed=seed, pupils=[pupil], **more)


_TEN_ATTEMPTS: Final[tuple[tuple[str, str | None, tuple[tuple[float, float], float] | None], ...]] = (
    ("squat", "too_shallow", None),
    ("star_jump", None, None),
    ("basketball_shot", "no_knee_bend", None),
    ("badminton_clear", None, None),
    ("long_jump", "no_arm_swing", None),
    ("volleyball_spike", None, None),
    ("soccer_kick", "no_backswing", ((1.3, 0.6), 180.0)),
    ("forward_roll", None, None),
    ("cartwheel", "bent_legs", ((0.0, 0.4), 0.0)),
    ("run", None, ((-3.4, 0.0), 0.0)),
)
"""Action, fault, and where the pupil goes before it and turns to; what is not said follows where he is."""


def ten_attempts() -> Plan:
    """All that is taught, once: a boy of eleven, every other time with a fault that a teacher would correct at once."""
    performs = [
        PerformancePlan(
            action=action,
            faults={} if fault is None else {fault: 1.0},
            skill=0.8,
            wait_s=0.8,
            place_m=UNSET if to is None else to[0],
            facing_deg=UNSET if to is None else to[1],
        )
        for action, fault, to in _TEN_ATTEMPTS
    ]
    pupil = PupilPlan(name="pupil", age_years=11.0, sex="male", place_m=(-1.5, -0.8), performs=performs)
    return _lesson("ten_attempts", 11, pupil, split="test")


def tiny(cameras: int = 2, length_s: float = 1.0) -> Plan:
    """A lesson for tests: a pupil who stands, small, short."""
    return _lesson("tiny", 1, PupilPlan(name="pupil"), cameras=cameras, size_px=(320, 180), length_s=length_s)


def _round(value: float) -> float:
    return float(np.round(value, 3))


PRESETS: Final = {
    SHIPPED: Preset("the six actions, four cameras in the corners; the lesson that comes rendered with KineBox", six_actions),
    "ten_attempts": Preset(
        "each of the ten actions once, every other one with a fault; a test pupil, of whom nothing was tuned", ten_attempts
    ),
    "tiny": Preset("a second of a pupil who stands, two cameras, small pictures: to see whether this machine can render", tiny),
    **{
        f"acceptance_{seed}": Preset(f"the six actions as test pupil {seed} performs them", partial(acceptance, seed))
        for seed in range(5)
    },
}
"""By name."""
