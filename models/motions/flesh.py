"""Where some of a body's skin is, for many poses at once."""

import numpy as np

from models.arrays import Float
from models.body import kinematics
from models.compiled import Counts
from models.motions.figure import Figure, Placed
from models.skeleton import smpl


def carried_by(figure: Figure, joints: tuple[str, ...]) -> Counts:
    """Indices of the vertices that hang most of all on one of these joints."""
    skin = figure.subject.body.model.skin
    carrier = np.take_along_axis(skin.joints, skin.weights.argmax(1)[:, None], axis=1)[:, 0]
    return np.flatnonzero(np.isin(carrier, [smpl.INDEX[name] for name in joints]))


def places_m(figure: Figure, vertices: Counts, placed: Placed) -> Float:
    """(T, V, 3) of V vertices in the world, of T poses."""
    body, skin = figure.subject.body, figure.subject.body.model.skin
    rest, joints, weights = body.rest_vertices_m[vertices], skin.joints[vertices], skin.weights[vertices]
    return np.array(
        [
            kinematics.skin(body.rest_joints_m, at, turned, rest, joints, weights)
            for at, turned in zip(placed.joints_m, placed.turns, strict=True)
        ]
    ).reshape(len(placed.joints_m), len(vertices), 3)
