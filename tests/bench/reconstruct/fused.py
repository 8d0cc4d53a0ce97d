"""What fusion makes of recorded events, by instant of its output grid."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from models.arrays import Float, UInt8, UInt32
from models.camera.rig import Rig
from models.messages.motion import JointState, Motion
from models.skeleton import coco
from services.fusion.config import FusionConfig
from services.fusion.pipeline import initial_state, step
from tests.bench.closed_loop import Event
from tests.bench.reconstruct.lesson import START_NS
from tests.bench.reconstruct.observed import CONFIG, RATE_HZ


@dataclass(frozen=True, eq=False)
class Fused:
    """Joints in the world, NaN where nothing is said of them.

    Attributes:
        times_s: (n,) instants, from the lesson's beginning.
        smooth_m, live_m: (n, 17, 3).
        smooth_states, live_states: (n, 17) `JointState`.
        views: (n, 17) inlier views of the smooth motion, a bit a camera.
        cpu_s: CPU seconds of fusion's steps.
    """

    times_s: Float
    smooth_m: Float
    live_m: Float
    smooth_states: UInt8
    live_states: UInt8
    views: UInt32
    cpu_s: float


def fuse(rig: Rig, events: Sequence[Event], length_s: float, config: FusionConfig = CONFIG) -> Fused:
    """Fuse events; `rig` has the cameras that looked."""
    count = round(length_s * RATE_HZ)
    joints = {kind: np.full((count, coco.COUNT, 3), np.nan) for kind in ("smooth", "live")}
    states = {kind: np.zeros((count, coco.COUNT), np.uint8) for kind in ("smooth", "live")}
    views = np.zeros((count, coco.COUNT), np.uint32)
    state, motions = initial_state(rig), list[Motion]()
    began = time.thread_time()
    for event in events:
        state, output = step(state, event, config)
        motions += output.motions
    cpu_s = time.thread_time() - began
    for motion in motions:
        number = round((motion.t_ns - START_NS) * 1e-9 * RATE_HZ)
        if not 0 <= number < count:
            continue
        known = motion.states != JointState.UNKNOWN
        joints[motion.kind][number, known] = motion.joints_m[known]
        states[motion.kind][number] = motion.states
        if motion.kind == "smooth":
            views[number] = motion.views
    times_s = np.arange(count) / RATE_HZ
    return Fused(times_s, joints["smooth"], joints["live"], states["smooth"], states["live"], views, cpu_s)
