"""BVH, the text format of moving skeletons: centimetres, y up, rotations about z, x and y."""

import numpy as np

from models.arrays import Float
from services.lesson.export.armature import Armature, Bone, armature
from services.lesson.export.axes import FIGURES
from services.lesson.export.rows import rows
from services.lesson.export.take import Take
from services.lesson.export.zxy import zxy_deg

SUFFIX = ".bvh"
_CM = 100.0
_TURNS = "Zrotation Xrotation Yrotation"


def encode(take: Take) -> bytes:
    """The file. What is held because it is unknown stands in `services.lesson.export.beside`.

    Raises:
        TakeError: there are no bones; see `armature`.
    """
    tree = armature(take)
    lines = ["HIERARCHY", *_joint(tree.bones, 0, ""), "MOTION", f"Frames: {len(take.track)}"]
    lines.append(f"Frame Time: {1 / take.rate_hz:.8f}")
    columns = [FIGURES.to(tree.root_m) * _CM] + [zxy_deg(FIGURES.turns_to(tree.turns[:, bone])) for bone in _order(tree)]
    lines += rows(np.concatenate(columns, axis=1), 4, " ")
    return ("\n".join(lines) + "\n").encode()


def _joint(bones: tuple[Bone, ...], index: int, indent: str) -> list[str]:
    bone, inner = bones[index], f"{indent}\t"
    channels = f"CHANNELS 3 {_TURNS}" if index else f"CHANNELS 6 Xposition Yposition Zposition {_TURNS}"
    lines = [f"{indent}{'JOINT' if index else 'ROOT'} {bone.name}", f"{indent}{{", f"{inner}{_offset(bone.offset_m)}"]
    lines.append(f"{inner}{channels}")
    for child, other in enumerate(bones):
        if other.parent == index:
            lines += _joint(bones, child, inner)
    if bone.tip_m is not None:
        lines += [f"{inner}End Site", f"{inner}{{", f"{inner}\t{_offset(bone.tip_m)}", f"{inner}}}"]
    return [*lines, f"{indent}}}"]


def _order(tree: Armature) -> list[int]:
    """Bones as the file has them: each before what hangs on it, and that before its sisters."""
    order: list[int] = []
    waiting = [0]
    while waiting:
        index = waiting.pop()
        order.append(index)
        waiting += [child for child in reversed(range(len(tree.bones))) if tree.bones[child].parent == index]
    return order


def _offset(vector_m: Float) -> str:
    return "OFFSET " + " ".join(f"{value:.4f}" for value in FIGURES.to(vector_m) * _CM + 0.0)
