"""GLB, binary glTF 2.0 (https://registry.khronos.org/glTF/specs/2.0): a figure of simple limbs that moves; metres, y up.

A limb is not drawn while its rotation is unknown, or that of a bone between it and the hips, which carries it: its shape is scaled
to nothing then. Who it is and the keyframes stand in the `extras` of `asset`.
"""

import json
import struct
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from models.arrays import Bool, Float
from models.motions.rotations import quaternions
from services.lesson.export.armature import Armature, armature
from services.lesson.export.axes import FIGURES
from services.lesson.export.limb_shapes import MATERIALS, Shape, shapes_of
from services.lesson.export.take import Take

SUFFIX = ".glb"
_FLOAT, _UINT16 = 5126, 5123
_VERTICES, _INDICES = 34962, 34963
_KINDS: Final = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}
_TOLERANCE: Final = 1e-9


class _Content:
    """Arrays one after the other in the binary chunk, and what glTF says of each."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def add(self, values: Float, *, bounds: bool = False, target: int | None = None) -> int:
        """Numbers (n,) or (n, 3 or 4) as 32-bit floats; the number of the accessor."""
        return self._add(np.ascontiguousarray(values, "<f4"), _FLOAT, bounds, target)

    def add_indices(self, values: Float) -> int:
        """Whole numbers (n,) of vertices; the number of the accessor."""
        return self._add(np.ascontiguousarray(values, "<u2"), _UINT16, bounds=False, target=_INDICES)

    def _add(self, array: npt.NDArray[Any], component: int, bounds: bool, target: int | None) -> int:
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": array.nbytes}
        self.views.append(view | ({} if target is None else {"target": target}))
        self.data += array.tobytes() + b"\0" * (-array.nbytes % 4)
        rows = array.reshape(len(array), -1)
        accessor: dict[str, Any] = {"bufferView": len(self.views) - 1, "componentType": component, "count": len(rows)}
        accessor["type"] = _KINDS[rows.shape[1]]
        if bounds:
            accessor |= {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
        self.accessors.append(accessor)
        return len(self.accessors) - 1


class _Motion:
    """The samplers and channels of the one animation."""

    def __init__(self, content: _Content) -> None:
        self.content = content
        self.samplers: list[dict[str, Any]] = []
        self.channels: list[dict[str, Any]] = []

    def add(self, node: int, path: str, times: int, values: Float, interpolation: str = "LINEAR") -> None:
        """A channel of values (n, 3 or 4) at the instants of an accessor."""
        self.samplers.append({"input": times, "output": self.content.add(values), "interpolation": interpolation})
        self.channels.append({"sampler": len(self.samplers) - 1, "target": {"node": node, "path": path}})


def encode(take: Take) -> bytes:
    """The file.

    Raises:
        TakeError: there are no bones; see `armature`.
    """
    tree = armature(take)
    content = _Content()
    nodes = _nodes(tree)
    motion = _Motion(content)
    times = content.add(take.seconds, bounds=True)
    motion.add(0, "translation", times, FIGURES.to(tree.root_m))
    for bone in range(len(tree.bones)):
        if np.abs(tree.turns[:, bone] - np.eye(3)).max() > _TOLERANCE:
            motion.add(bone, "rotation", times, _rotations(tree, bone))
    meshes: list[dict[str, Any]] = []
    lost = tree.lost
    for shape in shapes_of(tree.bones):
        nodes[shape.bone].setdefault("children", []).append(len(nodes))
        unknown = lost[:, shape.bone]
        if unknown.any():
            instants, scales = _blinking(take.seconds, unknown)
            motion.add(len(nodes), "scale", content.add(instants, bounds=True), scales, "STEP")
        nodes.append({"name": f"{tree.bones[shape.bone].name} shape", "mesh": len(meshes)})
        meshes.append(_mesh(shape, content))
    description = {
        "asset": {"version": "2.0", "generator": "KineBox", "extras": take.about()},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": list(MATERIALS),
        "animations": [{"name": take.name, "samplers": motion.samplers, "channels": motion.channels}],
        "accessors": content.accessors,
        "bufferViews": content.views,
        "buffers": [{"byteLength": len(content.data)}],
    }
    text = json.dumps(description, separators=(",", ":"), ensure_ascii=False).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(content.data), b"BIN\0") + content.data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def _nodes(tree: Armature) -> list[dict[str, Any]]:
    nodes: list[dict[str, Any]] = []
    for index, bone in enumerate(tree.bones):
        nodes.append({"name": bone.name, "translation": [float(value) for value in FIGURES.to(bone.offset_m).astype("f4")]})
        if bone.parent >= 0:
            nodes[bone.parent].setdefault("children", []).append(index)
    return nodes


def _rotations(tree: Armature, bone: int) -> Float:
    """(T, 4) unit quaternions (x, y, z, w) of a bone, neighbours on the same side so that between them it turns the short way."""
    found = quaternions(FIGURES.turns_to(tree.turns[:, bone]))[:, [1, 2, 3, 0]]
    flips = np.sum(found[1:] * found[:-1], axis=1) < 0
    signs = np.concatenate(([1.0], np.where(np.cumsum(flips) % 2, -1.0, 1.0)))
    return np.asarray(found * signs[:, None])


def _blinking(seconds: Float, unknown: Bool) -> tuple[Float, Float]:
    """Instants (n,) at which a shape goes or comes, and its scales (n, 3) from then on."""
    changes = np.concatenate(([0], np.flatnonzero(np.diff(unknown.astype(np.int8))) + 1))
    return seconds[changes], np.repeat(np.where(unknown[changes], 0.0, 1.0)[:, None], 3, axis=1)


def _mesh(shape: Shape, content: _Content) -> dict[str, Any]:
    attributes = {
        "POSITION": content.add(FIGURES.to(shape.vertices_m), bounds=True, target=_VERTICES),
        "NORMAL": content.add(FIGURES.to(shape.normals), target=_VERTICES),
    }
    return {"primitives": [{"attributes": attributes, "indices": content.add_indices(shape.indices), "material": shape.material}]}
