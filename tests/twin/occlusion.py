"""Whether bodies hide a point from a camera, by capsules around COCO points: no picture and no mesh is needed.

It only has to mean the same when the twin is fitted and when it is used, and to say more than nothing: it is a feature by which
alike situations are found, not a truth. So radii are shares of the stature, the same for everybody.
"""

from typing import Final

import numpy as np

from models.arrays import Float
from models.compiled import Counts, compiled
from models.skeleton import coco

_I: Final = coco.INDEX
_MIDDLES: Final = (("left_ear", "right_ear"), ("left_shoulder", "right_shoulder"), ("left_hip", "right_hip"))
"""Points that bodies have besides the COCO points: indices 17, 18, 19."""
_EARS, _SHOULDERS, _HIPS = 17, 18, 19
_SIDES: Final = ("left", "right")

_CAPSULES: Final = (
    (_EARS, _EARS, 0.050),
    (_EARS, _SHOULDERS, 0.030),
    (_SHOULDERS, _HIPS, 0.070),
    (_I["left_shoulder"], _I["right_shoulder"], 0.035),
    (_I["left_hip"], _I["right_hip"], 0.050),
    *((_I[f"{side}_shoulder"], _I[f"{side}_elbow"], 0.026) for side in _SIDES),
    *((_I[f"{side}_elbow"], _I[f"{side}_wrist"], 0.022) for side in _SIDES),
    *((_I[f"{side}_hip"], _I[f"{side}_knee"], 0.045) for side in _SIDES),
    *((_I[f"{side}_knee"], _I[f"{side}_ankle"], 0.032) for side in _SIDES),
)
"""From, to, radius over stature."""
_STARTS: Final[Counts] = np.array([start for start, _, _ in _CAPSULES])
_ENDS: Final[Counts] = np.array([end for _, end, _ in _CAPSULES])
_RADII: Final[Float] = np.array([radius for _, _, radius in _CAPSULES])


def hidden(centre_m: Float, points_m: Float, statures_m: Float) -> Float:
    """How far the first body's points are hidden from a camera.

    Args:
        centre_m: (3,) the camera's place.
        points_m: (n, P, 17, 3) all bodies.
        statures_m: (P,).

    Returns:
        (n, 17) in [-1, 1]: 1 behind the middle of a capsule, 0 at its edge, -1 if the line of sight passes every capsule by more
        than its radius.
    """
    middles = [(points_m[..., _I[a], :] + points_m[..., _I[b], :]) / 2 for a, b in _MIDDLES]
    bodies = np.ascontiguousarray(np.concatenate((points_m, np.stack(middles, axis=-2)), axis=-2))
    return _hidden(np.asarray(centre_m, np.float64), bodies, np.asarray(statures_m, np.float64), _STARTS, _ENDS, _RADII)


@compiled
def _hidden(centre: Float, bodies: Float, statures: Float, starts: Counts, ends: Counts, radii: Float) -> Float:
    out = np.empty((bodies.shape[0], 17))
    for n in range(bodies.shape[0]):
        for j in range(17):
            worst = -1.0
            for p in range(bodies.shape[1]):
                for c in range(starts.shape[0]):
                    if p == 0 and (starts[c] == j or ends[c] == j):
                        continue
                    radius = radii[c] * statures[p]
                    passed, before = _passing(centre, bodies[n, 0, j], bodies[n, p, starts[c]], bodies[n, p, ends[c]])
                    # A point lies within its own body: what is nearer to it than half a capsule is not before it.
                    if before > 0.5 * radius:
                        worst = max(worst, 1.0 - passed / radius)
            out[n, j] = worst
    return out


@compiled
def _passing(eye: Float, point: Float, start: Float, end: Float) -> tuple[float, float]:
    """Least distance of the line of sight from an axis, and how far before the point that is (Ericson, 2005, 5.1.9)."""
    sight2 = axis2 = both = to_sight = to_axis = 0.0
    for k in range(3):
        sight, axis, between = point[k] - eye[k], end[k] - start[k], eye[k] - start[k]
        sight2 += sight * sight
        axis2 += axis * axis
        both += sight * axis
        to_sight += sight * between
        to_axis += axis * between
    along_axis = 0.0
    if axis2 < 1e-12:
        along = min(max(-to_sight / sight2, 0.0), 1.0)
    else:
        square = sight2 * axis2 - both * both
        along = min(max((both * to_axis - to_sight * axis2) / square, 0.0), 1.0) if square > 1e-12 else 0.0
        along_axis = (both * along + to_axis) / axis2
        if along_axis < 0.0 or along_axis > 1.0:
            along_axis = min(max(along_axis, 0.0), 1.0)
            along = min(max((both * along_axis - to_sight) / sight2, 0.0), 1.0)
    apart2 = 0.0
    for k in range(3):
        apart = eye[k] + along * (point[k] - eye[k]) - start[k] - along_axis * (end[k] - start[k])
        apart2 += apart * apart
    return np.sqrt(apart2), (1.0 - along) * np.sqrt(sight2)
