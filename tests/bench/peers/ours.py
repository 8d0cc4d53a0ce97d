"""The box's own fusion on a clip: the `step` that its process runs, event by event, with delays and without a look ahead."""

import time

import numpy as np

from models.arrays import Float
from models.messages.motion import JointState, Motion
from models.skeleton import coco
from services.fusion.config import PRESETS
from services.fusion.pipeline import initial_state, step
from tests.bench.peers.answer import Answer
from tests.bench.peers.clips import RATE_HZ, Clip
from tests.synthetic.gym import T0_NS

NAME = "ours"
SETTINGS = {
    "smooth": "the box's `step`, preset default: output 7 frames behind the tick, for evaluation and recording",
    "live": "the same run, output 2 frames behind the tick, pictures arriving 40-80 ms late",
}
CONFIG = PRESETS["default"]


def run_ours(clip: Clip) -> list[Answer]:
    """Smooth and live; frame k is the output grid's instant k. CPU is that of both together, which cannot be had apart."""
    state = initial_state(clip.gym.rig)
    motions: list[Motion] = []
    wall, cpu = time.perf_counter(), time.thread_time()
    for event in clip.events:
        state, output = step(state, event, CONFIG)
        motions += output.motions
    cpu_s, wall_s = time.thread_time() - cpu, time.perf_counter() - wall
    frames = len(clip.keypoints)
    joints = {setting: np.full((frames, coco.COUNT, 3), np.nan) for setting in SETTINGS}
    for motion in motions:
        frame = round((motion.t_ns - T0_NS) * 1e-9 * RATE_HZ)
        known = motion.states != JointState.UNKNOWN
        if 0 <= frame < frames:
            joints[motion.kind][frame, known] = motion.joints_m[known]
    return [Answer(f"{NAME}.{setting}", joints[setting], 1e3 * cpu_s / frames, 1e3 * wall_s / frames) for setting in SETTINGS]


def grid_ns(frames: int) -> Float:
    """(frames,) the instants of `run_ours`'s frames."""
    return T0_NS + np.round(np.arange(frames) * 1e9 / RATE_HZ)
