"""What is drawn of a bone: a box that narrows to its end, twelve triangles. It shows where a limb is, not how thick."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from models.arrays import Float
from services.lesson.export.armature import Bone

MATERIALS: Final[tuple[dict[str, Any], ...]] = tuple(
    {
        "name": name,
        "pbrMetallicRoughness": {"baseColorFactor": [*colour, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.8},
    }
    for name, colour in (("middle", (0.55, 0.57, 0.6)), ("left", (0.1, 0.42, 0.75)), ("right", (0.85, 0.42, 0.1)))
)
_LIMBS: Final = {
    "UpLeg": ("Leg", 0.17, 0.12),
    "Leg": ("Foot", 0.13, 0.08),
    "Arm": ("ForeArm", 0.16, 0.12),
    "ForeArm": ("Hand", 0.14, 0.09),
}
"""Limb: what hangs at its end, and half its thickness at both ends, in its lengths."""
_WAIST, _DEPTH, _NECK, _HEAD_HEIGHT = 0.8, 0.35, 0.5, 1.1
_FACES: Final = np.array(((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)))
"""Of a box whose corner c is at the end if c & 4, and on the positive side of its first and second axis if c & 2 and c & 1."""


@dataclass(frozen=True, eq=False)
class Shape:
    """A mesh of triangles that moves with a bone.

    Attributes:
        bone: its index.
        material: index in `MATERIALS`.
        vertices_m, normals: (24, 3) in the bone's axes.
        indices: (36,) of vertices, three a triangle, counter-clockwise from outside.
    """

    bone: int
    material: int
    vertices_m: Float
    normals: Float
    indices: Float


def shapes_of(bones: tuple[Bone, ...]) -> Iterator[Shape]:
    """The shapes of all bones whose ends are known."""
    places = {bone.name: index for index, bone in enumerate(bones)}
    for material, side in ((1, "Left"), (2, "Right")):
        for limb, (end, near, far) in _LIMBS.items():
            if f"{side}{end}" in places:
                offset = bones[places[f"{side}{end}"]].offset_m
                length = float(np.linalg.norm(offset))
                yield _box(places[f"{side}{limb}"], material, offset, (near * length,) * 2, (far * length,) * 2)
    chest, hip, shoulder = (bones[places[name]].offset_m if name in places else None for name in ("Spine1", "LeftUpLeg", "LeftArm"))
    if chest is not None and hip is not None and shoulder is not None:
        hips, shoulders = float(np.linalg.norm(hip)), float(np.linalg.norm(shoulder))
        depth = _DEPTH * (hips + shoulders)
        yield _box(places["Spine"], 0, chest, (depth, hips), (depth, _WAIST * shoulders))
    ear = bones[places["LeftEar"]].offset_m if "LeftEar" in places else None
    if ear is not None:
        half = float(np.linalg.norm(ear))
        low, high = np.array((0.0, 0.0, -half)), np.array((0.0, 0.0, _HEAD_HEIGHT * half))
        yield _box(places["Head"], 0, high, (half, _WAIST * half), (half, _WAIST * half), low)
        yield _box(places["Neck"], 0, bones[places["Head"]].offset_m, (_NECK * half,) * 2, (_NECK * half,) * 2)


def _box(
    bone: int, material: int, end: Float, near: tuple[float, float], far: tuple[float, float], start: Float | None = None
) -> Shape:
    """A box from `start` (the joint) to `end` with half its widths there, along the front and along what is left."""
    begin = np.zeros(3) if start is None else start
    along = (end - begin) / max(float(np.linalg.norm(end - begin)), 1e-9)
    first = np.array((1.0, 0.0, 0.0))
    second = np.cross(along, first)
    corners = np.array(
        [
            (end if c & 4 else begin)
            + (1 if c & 2 else -1) * (far if c & 4 else near)[0] * first
            + (1 if c & 1 else -1) * (far if c & 4 else near)[1] * second
            for c in range(8)
        ]
    )
    faces = corners[_FACES]
    normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    indices = (np.arange(6)[:, None] * 4 + np.array((0, 1, 2, 0, 2, 3))).reshape(-1)
    return Shape(bone, material, faces.reshape(-1, 3), np.repeat(normals, 4, axis=0), indices.astype(np.float64))
