"""Feed a gym's events through fusion, and hold what comes out against the truth."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np

from models.arrays import Float
from models.camera.rig import Rig
from models.messages.motion import JointState, Motion
from models.messages.observation import Observation
from services.fusion.config import PRESETS, FusionConfig
from services.fusion.pipeline import FusionOutput, FusionState, Tick, initial_state, step
from tests.synthetic.gym import T0_NS

DEFAULT = PRESETS["default"]


@dataclass
class Played:
    """Everything that came out."""

    live: list[Motion] = field(default_factory=list)
    smooth: list[Motion] = field(default_factory=list)
    outputs: list[FusionOutput] = field(default_factory=list)
    state: FusionState | None = None


def play(rig: Rig, events: Iterable[Observation | Tick], config: FusionConfig = DEFAULT) -> Played:
    """Run all events."""
    state, played = initial_state(rig), Played()
    for event in events:
        state, output = step(state, event, config)
        played.outputs.append(output)
        for motion in output.motions:
            (played.live if motion.kind == "live" else played.smooth).append(motion)
    played.state = state
    return played


def after(motions: Iterable[Motion], seconds: float, until: float = np.inf) -> list[Motion]:
    """Motions of instants between `seconds` and `until` after the gym's start."""
    return [motion for motion in motions if seconds <= (motion.t_ns - T0_NS) * 1e-9 < until]


def errors_mm(motions: Iterable[Motion], truth: Callable[[int], Float]) -> Float:
    """(n, 17) distances from the truth; NaN where nothing was claimed."""
    rows = []
    for motion in motions:
        distance = np.linalg.norm(motion.joints_m - truth(motion.t_ns), axis=1) * 1e3
        distance[motion.states == JointState.UNKNOWN] = np.nan
        rows.append(distance)
    return np.array(rows)


def nees(motions: Iterable[Motion], truth: Callable[[int], Float]) -> Float:
    """(n, 17) squared errors in sigmas of the covariance claimed; 3 in the mean and 2.37 in the median if that is honest."""
    rows = []
    for motion in motions:
        error = motion.joints_m - truth(motion.t_ns)
        rows.append(np.einsum("ji,jik,jk->j", error, np.linalg.pinv(motion.covariance_m2.astype(np.float64)), error))
    return np.array(rows)
