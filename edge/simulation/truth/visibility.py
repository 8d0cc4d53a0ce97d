"""Which surface is the first on the way from a camera to some points, found without the renderer.

Triangles are taken as the lens and the rolling rows put them into the picture; a point is looked for in those that cover its
pixel. As the triangles are small, their edges are straight there and one over the depth is linear.
"""

from enum import IntEnum
from typing import Final

import numpy as np

from models.arrays import Float, UInt8
from models.body.model import Body
from models.body.pose import t_pose
from models.compiled import Counts, compiled

TILE_PX: Final = 32


class Seen(IntEnum):
    """Whether a point of a body is to be seen in a picture, and if not, why.

    A joint lies inside the body. It is seen if the first surface on the way to it is the body's own, and no farther before it than
    the limb is thick there (`reach_m`): what is farther before it is another part of the same body, or the back of the head before
    the nose.
    """

    VISIBLE = 0
    OUTSIDE = 1
    """Of the picture, or behind the camera; or the pupil is not there."""
    BEHIND_ITSELF = 2
    BEHIND_PUPIL = 3
    BEHIND_THING = 4
    BEHIND_ROOM = 5


_THICKER = 1.75
_CLOTHES_M = 0.04
_TOUCHING_M = 0.01


def reach_m(body: Body) -> Float:
    """(47,) how far before joints, then COCO points, the body's own surface may be for them to be seen.

    1.75 times as far as the nearest skin is in the T-pose, since limbs are not round, and 4 cm for clothes.
    """
    pose = t_pose()
    skin = body.vertices_m(pose)
    points = np.concatenate((body.joints_m(pose), body.coco_m(pose)))
    nearest = np.sqrt(((points[:, None] - skin) ** 2).sum(-1)).min(1)
    return np.asarray(_THICKER * nearest + _CLOTHES_M)


def judge(owner: int, depths_m: Float, reaches_m: Float, first: Float, owners: Counts, pupils: int, things: int) -> UInt8:
    """`Seen` of points of one pupil that are inside the picture.

    Args:
        owner: the pupil's number.
        depths_m: (Q,) of the points along the axis.
        reaches_m: (Q,) as `reach_m`.
        first: (Q,) depths of the first surfaces there; infinite where there is none.
        owners: (Q,) whose they are: pupils, then things, then the room.
        pupils: how many.
        things: how many.
    """
    seen = np.full(len(depths_m), Seen.VISIBLE, np.uint8)
    before = first < depths_m - _TOUCHING_M
    seen[before & (owners < pupils)] = Seen.BEHIND_PUPIL
    seen[before & (owners >= pupils) & (owners < pupils + things)] = Seen.BEHIND_THING
    seen[before & (owners >= pupils + things)] = Seen.BEHIND_ROOM
    own = owners == owner
    seen[own] = np.where(first < depths_m - reaches_m, Seen.BEHIND_ITSELF, Seen.VISIBLE)[own]
    return seen


@compiled
def first_surfaces(
    pixels: Float,
    depths: Float,
    faces: Counts,
    owner: int,
    queries: Float,
    first: Float,
    found: Counts,
    width: int,
    height: int,
) -> None:
    """Look for points in the triangles that cover them.

    Args:
        pixels: (V, 2) where the corners are in the picture; NaN behind the camera.
        depths: (V,) their depths along the axis.
        faces: (F, 3) corners of the triangles.
        owner: whose they are.
        queries: (Q, 2) pixels.
        first: (Q,) depths of the nearest surfaces yet, infinite if none; is updated.
        found: (Q,) whose they are; is updated.
        width: of the picture.
        height: of the picture.
    """
    columns = width // TILE_PX + 1
    starts, order = _by_tile(queries, width, height)
    for face in range(faces.shape[0]):
        a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
        ax, ay, bx, by, cx, cy = pixels[a, 0], pixels[a, 1], pixels[b, 0], pixels[b, 1], pixels[c, 0], pixels[c, 1]
        left, right = min(ax, bx, cx), max(ax, bx, cx)
        top, bottom = min(ay, by, cy), max(ay, by, cy)
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        # NaN answers no to all of these.
        if not (right >= 0 and left < width and bottom >= 0 and top < height and area != 0):
            continue
        for row in range(np.int64(max(top, 0)) // TILE_PX, np.int64(min(bottom, height - 1)) // TILE_PX + 1):
            for column in range(np.int64(max(left, 0)) // TILE_PX, np.int64(min(right, width - 1)) // TILE_PX + 1):
                tile = row * columns + column
                for place in range(starts[tile], starts[tile + 1]):
                    query = order[place]
                    x, y = queries[query, 0], queries[query, 1]
                    v = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area
                    w = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area
                    u = 1 - v - w
                    if u >= 0 and v >= 0 and w >= 0:
                        depth = 1 / (u / depths[a] + v / depths[b] + w / depths[c])
                        if depth < first[query]:
                            first[query] = depth
                            found[query] = owner


@compiled
def _by_tile(queries: Float, width: int, height: int) -> tuple[Counts, Counts]:
    """First place of each tile in an order of the queries in which those of a tile follow one another; and that order."""
    columns, rows = width // TILE_PX + 1, height // TILE_PX + 1
    starts = np.zeros(columns * rows + 1, np.int64)
    tiles = np.full(queries.shape[0], -1)
    for query in range(queries.shape[0]):
        x, y = queries[query, 0], queries[query, 1]
        if 0 <= x < width and 0 <= y < height:
            tiles[query] = np.int64(y) // TILE_PX * columns + np.int64(x) // TILE_PX
            starts[tiles[query] + 1] += 1
    for tile in range(columns * rows):
        starts[tile + 1] += starts[tile]
    order = np.empty(queries.shape[0], np.int64)
    filled = starts.copy()
    for query in range(queries.shape[0]):
        if tiles[query] >= 0:
            order[filled[tiles[query]]] = query
            filled[tiles[query]] += 1
    return starts, order
