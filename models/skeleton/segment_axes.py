"""Axes of the segment that each COCO point belongs to, from the points alone: front, left, up of the body, carried along limbs.

The trunk's axes follow from hips and shoulders, the head's from ears and nose. A limb's are the trunk's, turned as little as brings
the limb from where it is in the T-pose (arms sideways, legs down) to where it is; the next segment's are the limb's, turned on in
the same way. So the axes of a body in the T-pose are all front (x), left (y) and up (z).
"""

from typing import Final

import numpy as np

from models.arrays import Float
from models.skeleton import coco

_I: Final = coco.INDEX
_OPPOSITE: Final = 1e-6
_HEAD: Final = tuple(_I[name] for name in ("nose", "left_eye", "right_eye", "left_ear", "right_ear"))


def segment_axes(points_m: Float) -> Float:
    """Axes of each point's segment.

    A shoulder and a hip belong to the trunk, an elbow to its upper arm, a wrist to its forearm, a knee to its thigh, an ankle to
    its shank.

    Args:
        points_m: (..., 17, 3) COCO points in the world.

    Returns:
        (..., 17, 3, 3) rotations from (front, left, up) into the world; NaN where a point that they need is NaN, or where a limb
        points the opposite way of where it is in the T-pose.
    """
    points = [points_m[..., joint, :] for joint in range(coco.COUNT)]
    axes = np.empty((*points_m.shape[:-1], 3, 3))
    trunk = _trunk(points)
    axes[..., list(_HEAD), :, :] = _head(points)[..., None, :, :]
    axes[..., list(coco.TRUNK), :, :] = trunk[..., None, :, :]
    for side, outwards in (("left", 1.0), ("right", -1.0)):
        arm = [points[_I[f"{side}_{part}"]] for part in ("shoulder", "elbow", "wrist")]
        leg = [points[_I[f"{side}_{part}"]] for part in ("hip", "knee", "ankle")]
        for (near, middle, far), rest, joints in (
            (arm, outwards * trunk[..., 1], (f"{side}_elbow", f"{side}_wrist")),
            (leg, -trunk[..., 2], (f"{side}_knee", f"{side}_ankle")),
        ):
            along = _unit(middle - near)
            first = _carried(trunk, rest, along)
            axes[..., _I[joints[0]], :, :] = first
            axes[..., _I[joints[1]], :, :] = _carried(first, along, _unit(far - middle))
    return axes


def trunk_length_m(points_m: Float) -> Float:
    """(...) from the middle of the hips to the middle of the shoulders, of (..., 17, 3)."""
    left_shoulder, right_shoulder, left_hip, right_hip = (points_m[..., joint, :] for joint in coco.TRUNK)
    return np.asarray(np.linalg.norm(left_shoulder + right_shoulder - left_hip - right_hip, axis=-1) / 2)


def _trunk(points: list[Float]) -> Float:
    left_shoulder, right_shoulder, left_hip, right_hip = (points[joint] for joint in coco.TRUNK)
    up = _unit(left_shoulder + right_shoulder - left_hip - right_hip)
    left = _unit(_across(left_shoulder - right_shoulder + left_hip - right_hip, up))
    return np.stack((np.cross(left, up), left, up), axis=-1)


def _head(points: list[Float]) -> Float:
    left_ear, right_ear = points[_I["left_ear"]], points[_I["right_ear"]]
    left = _unit(left_ear - right_ear)
    front = _unit(_across(points[_I["nose"]] - (left_ear + right_ear) / 2, left))
    return np.stack((front, left, np.cross(front, left)), axis=-1)


def _across(vector: Float, axis: Float) -> Float:
    """The part of a vector that is at right angles to a unit vector."""
    return np.asarray(vector - (vector * axis).sum(axis=-1, keepdims=True) * axis)


def _unit(vector: Float) -> Float:
    length = np.linalg.norm(vector, axis=-1, keepdims=True)
    return vector / np.where(length > 0, length, np.nan)


def _carried(axes: Float, before: Float, after: Float) -> Float:
    """Axes turned by the smallest rotation that takes one unit vector to another."""
    cosine = (before * after).sum(axis=-1)[..., None, None]
    normal = np.cross(before, after)
    zero = np.zeros_like(normal[..., 0])
    x, y, z = normal[..., 0], normal[..., 1], normal[..., 2]
    rows = ((zero, -z, y), (z, zero, -x), (-y, x, zero))
    cross = np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
    turn = np.eye(3) + cross + cross @ cross / np.where(cosine > _OPPOSITE - 1, 1 + cosine, np.nan)
    return np.asarray(turn @ axes)
