"""The mirror that stands in the plane y = 0: left does what right did, and who stands before it has his left side on the right."""

from dataclasses import replace
from functools import lru_cache
from typing import Final

import numpy as np

from models.arrays import Float
from models.body.landmarks import Landmarks, Skin
from models.body.model import Body
from models.motions.motion import CONTACTS, Motion
from models.motions.subject import Subject
from models.skeleton import coco_feet, smpl

_FLIP: Final = np.array((1.0, -1.0, 1.0))
_OTHER: Final = np.array(smpl.MIRROR)
_SWAPPED: Final = [
    CONTACTS.index(name.replace("left", "other").replace("right", "left").replace("other", "right")) for name in CONTACTS
]


def mirrored(motion: Motion) -> Motion:
    """The mirror image of a motion without things, for the mirror image of whoever performs it; its attempts stay as they are.

    Of a body whose sides are not quite alike, it is no motion: feet would slide and sink. `mirror_image` is whom to ask.
    """
    return replace(
        motion,
        translations_m=motion.translations_m * _FLIP,
        rotations_rad=motion.rotations_rad[:, list(smpl.MIRROR)] * -_FLIP,
        contacts=motion.contacts[:, _SWAPPED],
    )


@lru_cache(maxsize=32)
def mirror_image(subject: Subject) -> Subject:
    """The same person with left and right exchanged; made once, as figures are. His body has no shape coefficients and no prior."""
    return replace(subject, body=_mirrored_body(subject.body))


def _mirrored_body(body: Body) -> Body:
    model, skin = body.model, body.model.skin
    if skin.posedirs.shape[2]:
        raise ValueError("a body with pose correctives cannot be mirrored: they are of the model's own sides")
    none = np.zeros((len(skin.vertices), 3, 0))
    image = replace(
        model,
        source=f"mirrored: {model.source}",
        skin=Skin(body.rest_vertices_m * _FLIP, none, none, _OTHER[skin.joints], skin.weights),
        faces=model.faces[:, ::-1],
        joints=body.rest_joints_m[_OTHER] * _FLIP,
        joint_shapedirs=np.zeros((smpl.COUNT, 3, 0)),
        landmarks=_mirrored_landmarks(body.coco_landmarks, body.shape),
        prior=None,
    )
    return image.shaped(np.zeros(0))


def _mirrored_landmarks(landmarks: Landmarks, shape: Float) -> Landmarks:
    offsets = (landmarks.offsets + landmarks.shapedirs @ shape) * _FLIP
    terms = [np.arange(landmarks.starts[point], landmarks.starts[point + 1]) for point in coco_feet.MIRROR]
    order, none = np.concatenate(terms), np.zeros((len(offsets), 3, 0))
    starts = np.cumsum([0, *map(len, terms)])
    return Landmarks(starts, _OTHER[landmarks.joints[order]], landmarks.shares[order], offsets[order], none, none)
