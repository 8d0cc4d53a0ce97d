"""Motions for tests of exports: somebody who stands, waves about and walks through the room, with joints that come and go."""

from functools import cache

import numpy as np

from models.arrays import Float
from models.messages.motion import JointState
from models.motions.motion import RATE_HZ
from models.motions.perform import perform
from models.motions.performance import Performance
from models.motions.rotations import matrices
from models.skeleton import coco
from services.evaluation.attempt import FoundAttempt
from services.evaluation.track import Track, known_track
from services.lesson.export.take import Take
from tests.pupils import pupil

FRAME_S = 1 / 30
SIGMA_M = 0.0085
STANDING_M = np.array(
    (
        (0.12, 0.0, 1.42), (0.1, 0.03, 1.45), (0.1, -0.03, 1.45), (0.02, 0.07, 1.43), (0.02, -0.07, 1.43),
        (0.0, 0.16, 1.22), (0.0, -0.16, 1.22), (0.03, 0.22, 0.96), (0.03, -0.22, 0.96), (0.12, 0.24, 0.76), (0.12, -0.24, 0.76),
        (0.0, 0.11, 0.8), (0.0, -0.11, 0.8), (0.04, 0.12, 0.44), (0.04, -0.12, 0.44), (0.0, 0.12, 0.07), (0.0, -0.12, 0.07),
    )
)  # fmt: skip
"""(17, 3) of somebody who looks along x."""


def moving(seed: int, frames: int, unknown: float = 0.0, swing_m: float = 0.06) -> Track:
    """Everybody's joints swing by themselves, so that no bone keeps its length; a share of joints is unknown for a while each."""
    random = np.random.default_rng(seed)
    t = np.arange(frames)[:, None, None] * FRAME_S
    waves = swing_m * np.sin(random.uniform(2, 9, (17, 3)) * t + random.uniform(0, 6, (17, 3)))
    heading = matrices(np.array((0.0, 0.0, 1.0)) * random.uniform(-3, 3))
    joints = (STANDING_M + waves) @ heading.T + random.uniform(-2, 2, 3) * (1, 1, 0) + t * random.uniform(-1, 1, 3) * (1, 1, 0)
    known = np.ones((frames, coco.COUNT), bool)
    for joint in np.flatnonzero(random.uniform(size=coco.COUNT) < unknown):
        first = int(random.integers(frames))
        known[first : first + 1 + int(random.integers(frames)), joint] = False
    whole = known_track(np.where(known[..., None], joints, np.nan), FRAME_S, SIGMA_M)
    guessed = (random.uniform(size=known.shape) < 0.1) & known
    return Track(whole.t_s + 100.0, whole.joints_m, whole.covariance_m2, np.where(guessed, JointState.GUESSED, whole.states))


@cache
def performed(action: str = "badminton_clear") -> Take:
    """A girl of eleven tries an action, as it truly was, with its keyframes."""
    subject = pupil()
    motion = perform(Performance(action, "right"), subject)
    times = np.arange(0, len(motion.translations_m) / RATE_HZ, FRAME_S)
    track = known_track(np.array([subject.body.coco_m(motion.pose_at(t))[: coco.COUNT] for t in times]), FRAME_S, SIGMA_M)
    (attempt,) = motion.attempts
    moments = (attempt.start_s, attempt.exertion_s, attempt.peak_s, attempt.end_s)
    return Take(track, action, "P07", (FoundAttempt(action, attempt.handed, moments),))


def median_bones(joints_m: Float) -> dict[tuple[str, str], tuple[float, Float]]:
    """Length of each limb in the middle, and (T,) how far it is off that."""
    found = {}
    for near, far in coco.LIMBS.values():
        lengths = np.linalg.norm(joints_m[:, near] - joints_m[:, far], axis=1)
        found[coco.NAMES[near], coco.NAMES[far]] = (float(np.median(lengths)), np.abs(lengths - np.median(lengths)))
    return found
