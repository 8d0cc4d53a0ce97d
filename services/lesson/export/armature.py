"""A tree of rigid bones that moves as the 17 points do: what BVH and glTF want, and a track does not have.

In the rest pose the pupil stands with his arms sideways and looks forward: all bones' axes are then front (x), left (y), up (z).
A bone's length is the median of what was seen. Its rotation follows from the points: hips and shoulders are turned with the line
between left and right, the spine lies along the trunk, limbs are turned as `models.skeleton.segment_axes` carries the trunk's axes
along them. So the turn of a limb about itself is a convention and was not seen, nor were hands and feet, which go on with their
limbs. Where a rotation is unknown, the last one against its parent is kept. A point that is never known has no bone.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.motions import rotations
from models.skeleton import coco
from models.skeleton.segment_axes import segment_axes
from services.lesson.export.directions import complete, pair
from services.lesson.export.holding import held
from services.lesson.export.take import Take, TakeError

ROOT: Final = "Hips"
_UP: Final = np.array((0.0, 0.0, 1.0))
_LEFT: Final = np.array((0.0, 1.0, 0.0))
_FRONT: Final = np.array((1.0, 0.0, 0.0))
_HAND: Final = 0.35
_FOOT: Final = 0.5
"""Length of what is drawn of a hand and a foot, which were not seen, in forearms and shanks."""
_FACE_M: Final = 0.03
"""What is drawn of a point of the face, which has no extent."""


@dataclass(frozen=True, eq=False)
class Bone:
    """One joint of the tree and what hangs on it.

    Attributes:
        name: as Mixamo, Unity and Blender know it.
        parent: index of the bone that carries it, which stands before it; -1 of the root.
        offset_m: (3,) of the joint from the parent's, in the parent's axes.
        tip_m: (3,) where it ends, in its own axes, if nothing hangs on it.
    """

    name: str
    parent: int
    offset_m: Float
    tip_m: Float | None = None


@dataclass(frozen=True, eq=False)
class Armature:
    """The bones and their motion.

    Attributes:
        bones: parents before their children.
        root_m: (T, 3) of the root in the world: the middle of the hips.
        turns: (T, bones, 3, 3) rotation of each bone against its parent, of the root against the world.
        held: (T, bones) where that is not known and the last one is shown; for the root its position, too.
    """

    bones: tuple[Bone, ...]
    root_m: Float
    turns: Float
    held: Bool

    @property
    def lost(self) -> Bool:
        """(T, bones) where a bone is not where the points were: its own turn is held, or that of one which carries it."""
        lost = self.held.copy()
        for index, bone in enumerate(self.bones):
            if bone.parent >= 0:
                lost[:, index] |= lost[:, bone.parent]
        return lost


@dataclass(frozen=True, eq=False)
class _Seen:
    """A bone as the points tell it: (T, 3) where its joint is and (T, 3, 3) its axes in the world, NaN where unknown."""

    name: str
    parent: str
    along: Float
    joint_m: Float
    axes: Float
    tip_m: Float | None = None


def armature(take: Take) -> Armature:
    """The bones of a take.

    Raises:
        TakeError: both hips and both shoulders are nowhere known at once, and nothing can hang on them.
    """
    seen = _seen(take.joints_m)
    if not complete(seen[0].axes).any():
        raise TakeError("has no frame in which both hips and both shoulders are known, without which there are no bones")
    bones: list[Bone] = []
    places: dict[str, int] = {"": -1}
    points = {each.name: each.joint_m for each in seen}
    world: list[Float] = []
    turns: list[Float] = []
    unknown: list[Bool] = []
    for each in seen:
        parent = places.get(each.parent)
        offset = np.zeros(3) if each.parent == "" else _offset_m(each, points[each.parent])
        if parent is None or offset is None:
            continue
        before = world[parent] if parent >= 0 else np.broadcast_to(np.eye(3), each.axes.shape)
        known = complete(each.axes)
        turn = before.swapaxes(1, 2) @ each.axes
        turn = held(turn, known) if known.any() else np.broadcast_to(np.eye(3), turn.shape)
        places[each.name] = len(bones)
        bones.append(Bone(each.name, parent, offset, each.tip_m))
        world.append(before @ turn)
        turns.append(turn)
        unknown.append(~known)
    root = seen[0].joint_m
    root_known = np.asarray(np.isfinite(root).all(axis=1))
    unknown[0] = unknown[0] | ~root_known
    bones = [_ended(bone, index, bones) for index, bone in enumerate(bones)]
    return Armature(tuple(bones), held(root, root_known), np.stack(turns, axis=1), np.stack(unknown, axis=1))


def _seen(joints_m: Float) -> list[_Seen]:
    point = {name: joints_m[:, index] for index, name in enumerate(coco.NAMES)}
    axes = segment_axes(joints_m)
    hips, shoulders = ((point[f"left_{part}"] + point[f"right_{part}"]) / 2 for part in ("hip", "shoulder"))
    across_hips, across_shoulders = (point[f"left_{part}"] - point[f"right_{part}"] for part in ("hip", "shoulder"))
    ears = (point["left_ear"] + point["right_ear"]) / 2
    trunk = axes[:, coco.INDEX["left_hip"]]
    chest = _sideways(across_shoulders, shoulders - hips)
    head = axes[:, coco.INDEX["nose"]]
    found = [
        _Seen(ROOT, "", _UP, hips, _sideways(across_hips, shoulders - hips)),
        _Seen("Spine", ROOT, 0 * _UP, hips, trunk),
        _Seen("Spine1", "Spine", _UP, shoulders, chest),
        _Seen("Neck", "Spine1", 0 * _UP, shoulders, _upwards(ears - shoulders, chest[..., 1])),
        _Seen("Head", "Neck", _UP, ears, head),
    ]
    for name, label in (
        ("nose", "Nose"), ("left_eye", "LeftEye"), ("right_eye", "RightEye"), ("left_ear", "LeftEar"), ("right_ear", "RightEar")
    ):  # fmt: skip
        found.append(_Seen(label, "Head", _middle(head, point[name] - ears), point[name], head, _FACE_M * _FRONT))
    for side, outwards in (("left", _LEFT), ("right", -_LEFT)):
        label = side.capitalize()
        thigh, shank, upper_arm, forearm = (axes[:, coco.INDEX[f"{side}_{far}"]] for far in ("knee", "ankle", "elbow", "wrist"))
        arm = _length_m(point[f"{side}_elbow"], point[f"{side}_wrist"])
        leg = _length_m(point[f"{side}_knee"], point[f"{side}_ankle"])
        found += [
            _Seen(f"{label}UpLeg", ROOT, outwards, point[f"{side}_hip"], thigh),
            _Seen(f"{label}Leg", f"{label}UpLeg", -_UP, point[f"{side}_knee"], shank),
            _Seen(f"{label}Foot", f"{label}Leg", -_UP, point[f"{side}_ankle"], shank, _FOOT * leg * _FRONT),
            _Seen(f"{label}Arm", "Spine1", outwards, point[f"{side}_shoulder"], upper_arm),
            _Seen(f"{label}ForeArm", f"{label}Arm", outwards, point[f"{side}_elbow"], forearm),
            _Seen(f"{label}Hand", f"{label}ForeArm", outwards, point[f"{side}_wrist"], forearm, _HAND * arm * outwards),
        ]
    return found


def _offset_m(bone: _Seen, parent_m: Float) -> Float | None:
    """(3,) from the parent in its axes; None if it was never seen. Points of the face have theirs already."""
    if not np.isfinite(bone.along).all():
        return None
    if bone.parent == "Head":
        return bone.along
    if not bone.along.any():
        return np.zeros(3)
    length = _length_m(parent_m, bone.joint_m)
    return bone.along * length if np.isfinite(length) else None


def _ended(bone: Bone, index: int, bones: list[Bone]) -> Bone:
    """The bone with a tip exactly if nothing hangs on it."""
    if any(other.parent == index for other in bones):
        return Bone(bone.name, bone.parent, bone.offset_m)
    tip = bone.tip_m if bone.tip_m is not None and np.isfinite(bone.tip_m).all() else _FACE_M * _UP
    return Bone(bone.name, bone.parent, bone.offset_m, tip)


def _length_m(start: Float, end: Float) -> float:
    """Median distance; NaN if it was never seen."""
    return float(_median(np.linalg.norm(end - start, axis=1)[:, None])[0])


def _middle(axes: Float, vectors: Float) -> Float:
    """(3,) median of vectors (T, 3) in axes (T, 3, 3)."""
    return _median(rotations.through(axes.swapaxes(1, 2), vectors))


def _median(values: Float) -> Float:
    known = np.isfinite(values).all(axis=1)
    return np.asarray(np.median(values[known], axis=0) if known.any() else np.full(values.shape[1], np.nan))


def _sideways(left: Float, up: Float) -> Float:
    """(T, 3, 3) axes with exactly this left, and up as near as can be."""
    y, z = pair(left, up)
    return np.stack((np.cross(y, z), y, z), axis=-1)


def _upwards(up: Float, left: Float) -> Float:
    """(T, 3, 3) axes with exactly this up, and left as near as can be."""
    z, y = pair(up, left)
    return np.stack((np.cross(y, z), y, z), axis=-1)
