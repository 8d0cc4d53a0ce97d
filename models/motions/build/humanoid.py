"""Reads the recordings of pybullet's humanoid and retargets them to SMPL's joints in the frame of `models.body`.

A frame holds its duration, the root's place and 13 rotations (`_ROTATIONS`): quaternions (w, x, y, z) against the parent, or the
angle of a hinge about z. Their axes are x to the front, y up, z to the right; at rest the humanoid stands with hanging arms.
"""

import json
from dataclasses import dataclass

import numpy as np

from models.arrays import Float
from models.skeleton import smpl

_ROTATIONS = (
    ("pelvis", 4), ("spine", 4), ("neck", 4),
    ("right_hip", 4), ("right_knee", 1), ("right_ankle", 4), ("right_shoulder", 4), ("right_elbow", 1),
    ("left_hip", 4), ("left_knee", 1), ("left_ankle", 4), ("left_shoulder", 4), ("left_elbow", 1),
)  # fmt: skip
_COLUMNS = 4 + sum(size for _, size in _ROTATIONS)
_TO_OURS = np.array(((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)))
_SPREAD = {"spine": ("spine1", "spine2", "spine3"), "neck": ("neck", "head")}


@dataclass(frozen=True, eq=False)
class Recording:
    """A motion at even steps.

    Attributes:
        step_s: from one frame to the next.
        rotations_rad: (T, 24, 3) as in `models.body.pose.Pose`.
    """

    step_s: float
    rotations_rad: Float


def read(text: str) -> Recording:
    """A recording from its file's text.

    Raises:
        ValueError: it is not such a file.
    """
    frames = np.array(json.loads(text)["Frames"], np.float64)
    if frames.ndim != 2 or frames.shape[1] != _COLUMNS:
        raise ValueError(f"a frame of the humanoid has {_COLUMNS} numbers, not {frames.shape[1:]}")
    rotations = np.zeros((len(frames), smpl.COUNT, 3))
    start = 4
    for joint, size in _ROTATIONS:
        numbers = frames[:, start : start + size]
        start += size
        vectors = (_vectors(numbers) if size == 4 else numbers * (0.0, 0.0, 1.0)) @ _TO_OURS.T
        if joint.endswith("shoulder"):
            vectors = np.array([_after_hanging(vector, joint.startswith("left")) for vector in vectors])
        if joint.endswith("elbow"):
            vectors = vectors @ _hanging(joint.startswith("left"))
        names = _SPREAD.get(joint, (joint,))
        for name in names:
            rotations[:, smpl.INDEX[name]] = vectors / len(names)
    return Recording(float(frames[0, 0]), rotations)


def _hanging(left: bool) -> Float:
    """(3, 3) from the arm of the T-pose to the hanging one."""
    sign = -1.0 if left else 1.0
    return np.array(((1.0, 0.0, 0.0), (0.0, 0.0, -sign), (0.0, sign, 0.0)))


def _after_hanging(vector: Float, left: bool) -> Float:
    """Rotation vector of `vector`'s rotation after the arm was lowered."""
    angle = float(np.linalg.norm(vector))
    x, y, z = vector / (angle + 1e-12)
    cross = np.array(((0, -z, y), (z, 0, -x), (-y, x, 0)))
    matrix = (np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross) @ _hanging(left)
    axis = np.array((matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]))
    turned = np.arctan2(np.linalg.norm(axis), np.trace(matrix) - 1)
    return np.asarray(axis / (np.linalg.norm(axis) + 1e-12) * turned)


def _vectors(quaternions: Float) -> Float:
    """(T, 3) rotation vectors of (T, 4) quaternions (w, x, y, z)."""
    shortest = np.where(quaternions[:, :1] < 0, -quaternions, quaternions)
    sines = np.linalg.norm(shortest[:, 1:], axis=1, keepdims=True)
    angles = 2 * np.arctan2(sines, shortest[:, :1])
    return np.asarray(shortest[:, 1:] * np.where(sines > 1e-9, angles / (sines + 1e-12), 2.0))
