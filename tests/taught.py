"""What KineBox brings to teach with, and attempts that are performed exactly as it is taught."""

from functools import cache

import numpy as np

from models.arrays import Float
from models.interpolation import between
from models.motions.motion import Handed
from models.skeleton import coco
from models.teaching.standard import Exemplar
from services.evaluation.attempt import FoundAttempt
from services.evaluation.config import VOCABULARY, EvaluationConfig
from services.evaluation.normalise import mirrored
from services.evaluation.track import Track, known_track
from services.support.teaching_files import load_standards, load_teachings

SIGMA_M = 0.01


@cache
def shipped() -> EvaluationConfig:
    """All actions."""
    return EvaluationConfig(load_teachings(None, VOCABULARY), load_standards(None))


@cache
def some(*actions: str) -> EvaluationConfig:
    """Only these actions, which is faster."""
    whole = shipped()
    return EvaluationConfig({name: whole.teachings[name] for name in actions}, {name: whole.standards[name] for name in actions})


def placed(joints_m: Float, handed: Handed = "right", heading_rad: float = 0.7, at_m: tuple[float, float] = (1.5, -2.0)) -> Float:
    """(T, 17, 3) of somebody who leads with the right, somewhere in the room and looking somewhere; or in a mirror first."""
    sine, cosine = np.sin(heading_rad), np.cos(heading_rad)
    turn = np.array(((cosine, -sine, 0.0), (sine, cosine, 0.0), (0.0, 0.0, 1.0)))
    own = mirrored(joints_m) if handed == "left" else joints_m
    return np.asarray(own @ turn.T + (*at_m, 0.0))


def performance(action: str, handed: Handed = "right", number: int = 0) -> tuple[Track, FoundAttempt]:
    """The standard of an action (0) or one of its exemplars, performed in the room, with its true keyframes."""
    standard = shipped().standards[action]
    exemplar: Exemplar = (standard.performance, *standard.exemplars)[number]
    track = known_track(placed(exemplar.joints_m, handed), shipped().frame_s, SIGMA_M)
    return track, FoundAttempt(action, handed, exemplar.moments_s)


def shallow_squat(depth: float) -> Float:
    """(T, 17, 3) the squat of the standard to a share of its depth: every pose is one of its own, on the same way down or up."""
    joints_m = shipped().standards["squat"].joints_m
    heights_m = joints_m[:, [coco.INDEX["left_hip"], coco.INDEX["right_hip"]], 2].mean(axis=1)
    lowest, frames = int(heights_m.argmin()), np.arange(len(joints_m), dtype=np.float64)
    drop_m = heights_m.max() - heights_m
    down, up = np.maximum.accumulate(drop_m[: lowest + 1]), np.maximum.accumulate(drop_m[:lowest:-1])
    poses = np.concatenate(
        (np.interp(depth * down, down, frames[: lowest + 1]), np.interp(depth * up, up, frames[:lowest:-1])[::-1])
    )
    return between(joints_m, poses)
