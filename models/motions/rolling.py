"""A body that rolls on its back: where its skin touches the ground, and how far it must travel so that it does not slide there.

The skin that touches is weighted by how near it is to the lowest: a patch of some centimetres, as flesh makes it. The lowest
skin is pressed into the ground by a few millimetres.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float
from models.compiled import Counts
from models.motions import flesh
from models.motions.figure import Figure

PATCH_M: Final = 0.004
"""How fast the skin's share in the contact falls off with its height over the lowest."""
SINKS_M: Final = 0.004
"""How deep the lowest skin is pressed into the ground, at most."""
_TRUNK: Final = (
    *("pelvis", "spine1", "spine2", "spine3", "neck", "head"),
    *("left_hip", "right_hip", "left_collar", "right_collar", "left_shoulder", "right_shoulder"),
)


@dataclass(frozen=True, eq=False)
class Rolled:
    """What rolling asks of the pelvis, for T poses.

    Attributes:
        heights_m: (T,) of the pelvis over the ground.
        travel_m: (T,) of the pelvis along x, from 0 at the first pose.
        touching_m: (T,) along x from the pelvis to the middle of the patch that touches.
        heading_up_m: (T,) where on the body the patch is: its height over the pelvis in the T-pose, below 0 on the seat.
    """

    heights_m: Float
    travel_m: Float
    touching_m: Float
    heading_up_m: Float


def trunk_skin(figure: Figure) -> Counts:
    """Indices of the vertices of trunk, head and buttocks."""
    return flesh.carried_by(figure, _TRUNK)


def roll(figure: Figure, local: Float) -> Rolled:
    """Let T poses, (T, 24, 3, 3) rotations against the parents, roll along x on level ground."""
    body = figure.subject.body
    trunk = trunk_skin(figure)
    area = _areas(body.rest_vertices_m, body.model.faces)[trunk]
    placed = figure.place_local(np.zeros((len(local), 3)), local)
    rest = body.rest_vertices_m[trunk]
    places = flesh.places_m(figure, trunk, placed)
    lowest = places[..., 2].min(1)
    shares = area * np.exp((lowest[:, None] - places[..., 2]) / PATCH_M)
    shares /= shares.sum(1, keepdims=True)
    patch = np.einsum("tv,tva->ta", shares, places)
    # The patch of two neighbouring poses is the same skin: that it stays where it is, is what rolling means.
    common = (shares[1:] + shares[:-1]) / 2
    slipped = np.einsum("tv,tv->t", common, np.diff(places[..., 0], axis=0))
    return Rolled(
        heights_m=-np.minimum(lowest + SINKS_M, patch[:, 2]),
        travel_m=np.concatenate(((0.0,), np.cumsum(-slipped))),
        touching_m=patch[:, 0],
        heading_up_m=shares @ rest[:, 2],
    )


def _areas(vertices: Float, faces: Counts) -> Float:
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    of_faces = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 6
    areas = np.zeros(len(vertices))
    for corner in range(3):
        np.add.at(areas, faces[:, corner], of_faces)
    return areas
