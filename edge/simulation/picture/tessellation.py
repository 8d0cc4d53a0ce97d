"""Cuts a room's triangles to what a camera can see and into pieces so small that its lens draws their straight edges straight.

A shader bends only vertices. Whether an edge is split depends on nothing but its two ends, so that two triangles that share it
split it alike and no gap opens between them.
"""

import numpy as np

from edge.simulation.picture.lens import NEAR_M, Lens
from models.arrays import Bool, Float

TOLERANCE_PX = 0.1
"""How far a quarter, a half or three quarters of an edge may be drawn from where the lens puts it."""
_DEEPEST = 12
_MARGIN_PX = 8.0
_QUARTERS = (0.25, 0.5, 0.75)


def tessellate(corners: Float, lens: Lens) -> Float:
    """Triangles for one camera.

    Args:
        corners: (T, 3, A) triangles' corners with their attributes, all of which are linear in space; the first three are the
            place in the world in metres.
        lens: of the camera.

    Returns:
        (N, 3, A) what of it lies in the camera's field, in small pieces.
    """
    pieces = _clipped(corners, lens)
    done = []
    for _ in range(_DEEPEST):
        split = _splits(pieces, lens)
        done.append(pieces[~split.any(1)])
        pieces, split = pieces[split.any(1)], split[split.any(1)]
        if not len(pieces):
            break
        pieces = _split(pieces, split)
    return np.concatenate([*done, pieces])


def _clipped(corners: Float, lens: Lens) -> Float:
    """What lies in the pyramid around the field."""
    wide = lens.limit * 1.05
    for plane in ((0, 0, 1, -1.01 * NEAR_M), (1, 0, wide, 0), (-1, 0, wide, 0), (0, 1, wide, 0), (0, -1, wide, 0)):
        local = lens.camera.to_camera(corners[..., :3])
        corners = _clip(corners, local @ np.array(plane[:3], np.float64) + plane[3])
    return corners


def _clip(corners: Float, inside: Float) -> Float:
    """The part of triangles (T, 3, A) where `inside` (T, 3), linear over each, is not negative."""
    kept = inside >= 0
    count = kept.sum(1)
    parts = [corners[count == 3]]
    for alone in (1, 2):
        chosen = count == alone
        some, values = corners[chosen], inside[chosen]
        # Turn each triangle so that the corner that differs from the other two comes first.
        first = np.argmax(kept[chosen] if alone == 1 else ~kept[chosen], axis=1)
        order = (first[:, None] + np.arange(3)) % 3
        some = np.take_along_axis(some, order[..., None], 1)
        values = np.take_along_axis(values, order, 1)
        a, b, c = some[:, 0], some[:, 1], some[:, 2]
        to_b = a + (b - a) * (values[:, 0] / (values[:, 0] - values[:, 1]))[:, None]
        to_c = a + (c - a) * (values[:, 0] / (values[:, 0] - values[:, 2]))[:, None]
        if alone == 1:
            parts.append(np.stack((a, to_b, to_c), 1))
        else:
            parts += [np.stack((to_b, b, c), 1), np.stack((to_b, c, to_c), 1)]
    return np.concatenate(parts)


def _splits(pieces: Float, lens: Lens) -> Bool:
    """(T, 3) whether the edge from each corner to the next is to be split."""
    start, end = pieces[..., :3], np.roll(pieces[..., :3], -1, axis=1)
    swap = _comes_later(start, end)[..., None]
    start, end = np.where(swap, end, start), np.where(swap, start, end)
    from_px, to_px = lens.project(start), lens.project(end)
    near, far = (lens.camera.to_camera(ends)[..., 2:] for ends in (start, end))
    off = np.zeros(pieces.shape[:2])
    for share in _QUARTERS:
        # The rasteriser's perspective: the place whose picture lies at this share between the pictures of the ends.
        a, b = (1 - share) / near, share / far
        there = lens.project((a * start + b * end) / (a + b))
        off = np.fmax(off, np.sqrt((((1 - share) * from_px + share * to_px - there) ** 2).sum(-1)))
    size = np.array(lens.camera.size_px)
    low, high = np.minimum(from_px, to_px), np.maximum(from_px, to_px)
    seen = ((high > -_MARGIN_PX) & (low < size + _MARGIN_PX)).all(-1)
    return np.asarray((off > TOLERANCE_PX) & seen)


def _comes_later(a: Float, b: Float) -> Bool:
    """Whether (..., 3) points come after others by x, then y, then z: an order that both triangles of an edge agree on."""
    return np.asarray(
        (a[..., 0] > b[..., 0])
        | ((a[..., 0] == b[..., 0]) & ((a[..., 1] > b[..., 1]) | ((a[..., 1] == b[..., 1]) & (a[..., 2] > b[..., 2]))))
    )


def _split(pieces: Float, split: Bool) -> Float:
    count = split.sum(1)
    parts = []
    for number in (1, 2, 3):
        some, edges = pieces[count == number], split[count == number]
        # One edge to split, or one not to: turn the triangle so that it is the first.
        first = np.argmax(edges if number == 1 else ~edges, axis=1) if number < 3 else np.zeros(len(some), np.int64)
        some = np.take_along_axis(some, ((first[:, None] + np.arange(3)) % 3)[..., None], 1)
        a, b, c = some[:, 0], some[:, 1], some[:, 2]
        ab, bc, ca = _middle(a, b), _middle(b, c), _middle(c, a)
        made = {
            1: ((a, ab, c), (ab, b, c)),
            2: ((a, b, bc), (a, bc, ca), (ca, bc, c)),
            3: ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)),
        }[number]
        parts += [np.stack(triangle, 1) for triangle in made]
    return np.concatenate(parts)


def _middle(a: Float, b: Float) -> Float:
    return (a + b) / 2
