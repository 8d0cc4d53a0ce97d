"""Bodies that the model cannot make, so that a fit of the model is not tested on itself (the "inverse crime").

A person is drawn from the model and then altered in the T-pose: every segment is stretched along its axes by its own ratio, the
skin going with it as it goes with the skeleton (weighted sums of the segments' stretches, so it cannot tear), and afterwards the
joints' centres are moved inside the flesh while the skin stays. What is true of such a body - joints, COCO points, skin - is
computed from the altered body itself.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from edge.simulation.split import Split, generator
from models.arrays import Float
from models.body.landmarks import Skin, from_vertices
from models.body.model import Body, BodyModel
from models.skeleton import smpl

LIMB_RATIO: Final = 0.06
"""Largest change of a segment's length against the model's."""
CENTRE_MOVED_M: Final = (0.005, 0.010)

_ONE_SIDE: Final = ("hip", "knee", "ankle", "foot", "collar", "shoulder", "elbow", "wrist", "hand")
_ALONG: Final = {"hip": 2, "knee": 2, "ankle": 0, "foot": 0, "collar": 1, "shoulder": 1, "elbow": 1, "wrist": 1, "hand": 1}
"""Axis of the T-pose along which the segment that a joint turns lies: thigh, shank, foot, toes, collar bone, upper arm, ..."""
_WIDER: Final = 0.04
"""Largest change of a limb's girth, of the trunk's depth and of the head's size."""
_UNEVEN: Final = 0.006
"""Largest difference of a ratio between the sides."""


@dataclass(frozen=True, eq=False)
class Alteration:
    """How a body differs from what the model made.

    Attributes:
        stretch: (24, 3) ratio by which each joint's segment is stretched along x, y and z of the T-pose.
        centres_m: (24, 3) how far each joint's centre is moved in the T-pose; the pelvis' own defines the origin.
    """

    stretch: Float
    centres_m: Float


def draw_alteration(split: Split, seed: int) -> Alteration:
    """Limbs at most `LIMB_RATIO` longer or shorter, centres moved by `CENTRE_MOVED_M`; sides alike but for a little."""
    random = generator(split, "off-model body", seed)
    stretch = np.ones((smpl.COUNT, 3))
    trunk = 1 + random.uniform((-_WIDER, -LIMB_RATIO, -LIMB_RATIO), (_WIDER, LIMB_RATIO, LIMB_RATIO))
    for name in ("pelvis", "spine1", "spine2", "spine3"):
        stretch[smpl.INDEX[name]] = trunk
    stretch[smpl.INDEX["neck"]] = (trunk[0], trunk[1], 1 + random.uniform(-LIMB_RATIO, LIMB_RATIO))
    stretch[smpl.INDEX["head"]] = 1 + random.uniform(-_WIDER, _WIDER)
    for name in _ONE_SIDE:
        left, right = smpl.INDEX[f"left_{name}"], smpl.INDEX[f"right_{name}"]
        stretch[left] = stretch[right] = 1 + random.uniform(-_WIDER, _WIDER)
        length = random.uniform(-(LIMB_RATIO - _UNEVEN), LIMB_RATIO - _UNEVEN)
        stretch[left, _ALONG[name]], stretch[right, _ALONG[name]] = 1 + length + random.uniform(-_UNEVEN, _UNEVEN, 2)
    return Alteration(stretch, _drawn_centres(random))


def _drawn_centres(random: np.random.Generator) -> Float:
    centres = np.zeros((smpl.COUNT, 3))
    for joint in range(1, smpl.COUNT):
        mirror = smpl.MIRROR[joint]
        if mirror < joint:
            centres[joint] = centres[mirror] * (1, -1, 1)
            continue
        direction = random.standard_normal(3)
        if mirror == joint:
            direction[1] = 0
        centres[joint] = random.uniform(*CENTRE_MOVED_M) * direction / np.linalg.norm(direction)
    return centres


def altered(body: Body, alteration: Alteration, regressor: Float) -> Body:
    """The altered body. Its model knows this one shape only: it has no shape coefficients and no prior.

    Args:
        body: from the model; without pose correctives.
        alteration: what changes.
        regressor: (23, V) COCO points and points of the feet as sums of vertices; see `models.body.file.coco_regressor`.
    """
    skin, old = body.model.skin, body.rest_joints_m
    if skin.posedirs.shape[2]:
        raise ValueError("a body with pose correctives cannot be altered: they are of the model's own skeleton")
    joints = old.copy()
    for joint, parent in enumerate(smpl.PARENTS):
        if parent >= 0:
            joints[joint] = joints[parent] + alteration.stretch[parent] * (old[joint] - old[parent])
    vertices = np.zeros_like(body.rest_vertices_m)
    for place in range(skin.joints.shape[1]):
        carrier, share = skin.joints[:, place], skin.weights[:, place : place + 1]
        vertices += share * (joints[carrier] + alteration.stretch[carrier] * (body.rest_vertices_m - old[carrier]))
    joints = joints + alteration.centres_m
    own = Skin(vertices, np.zeros((*vertices.shape, 0)), np.zeros((*vertices.shape, 0)), skin.joints, skin.weights)
    none = np.zeros((smpl.COUNT, 3, 0))
    model = BodyModel(
        source=f"altered: {body.model.source}",
        skin=own,
        faces=body.model.faces,
        joints=joints,
        joint_shapedirs=none,
        landmarks=from_vertices(regressor, own, joints, none),
        part_names=body.model.part_names,
        vertex_parts=body.model.vertex_parts,
        prior=None,
    )
    return model.shaped(np.zeros(0))
