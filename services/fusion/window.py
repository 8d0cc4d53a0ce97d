"""The smoother's normal equations, compiled; `smoothing.py` says what is solved.

Unknowns are ordered position by position, three coordinates each. Pictures couple four neighbouring positions through cubic
interpolation and third differences do the same, so the normal equations have a band of twelve. A picture's time, and with it the
interpolation, is the same for all joints, which are therefore the innermost index of every array.

Blocks of the equations between two positions are symmetric: six numbers stand for nine (`_PACKED`).
"""

from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.compiled import Counts, compiled

BAND: Final = 12
"""The diagonal and what is above it."""
_PACKED: Final = np.array(((0, 1, 2), (1, 3, 4), (2, 4, 5)))
"""Where an element of a symmetric 3 x 3 block is kept."""
_LEAST_SHARE = 0.02
"""No difference, however large, loses more of its penalty."""
_NEGLIGIBLE = 0.03
"""A point of less than this share (squared) of its weight is 17 sigmas off and left out."""
_OPEN_SHARE = 0.03
"""Penalty of differences beyond the newest picture. Extrapolation makes them look small, which is no evidence that they are."""
_PRIOR_M2 = 1.0
"""A metre of doubt about what was there before keeps what no picture and no neighbour holds in its place."""


@compiled
def _cubic(u: float, weights: Float) -> None:
    """Lagrange weights of positions 0 to 3 at u in [0, 3]."""
    weights[0] = -(u - 1.0) * (u - 2.0) * (u - 3.0) / 6.0
    weights[1] = u * (u - 2.0) * (u - 3.0) / 2.0
    weights[2] = -u * (u - 1.0) * (u - 3.0) / 2.0
    weights[3] = u * (u - 1.0) * (u - 2.0) / 6.0


@compiled
def _linearise(point: Float, projection: Float, pixels: Float, sigma: Float, usable: Bool, scale2: float, terms: Float) -> None:
    """Robust data terms of all joints in one picture: packed blocks of the Hessian, then its product with where to go.

    Args:
        point: (3, J) where the joints are at the picture's time.
        projection: (3, 4).
        pixels, sigma, usable: (J, 2), (J,), (J,) of the picture.
        scale2: of Geman-McClure's function.
        terms: (9, J), filled.
    """
    p = projection
    for j in range(point.shape[1]):
        x, y, z = point[0, j], point[1, j], point[2, j]
        depth = p[2, 0] * x + p[2, 1] * y + p[2, 2] * z + p[2, 3]
        seen = usable[j] and depth > 1e-6
        per_depth = 1.0 / (depth if seen else 1.0)
        u = (p[0, 0] * x + p[0, 1] * y + p[0, 2] * z + p[0, 3]) * per_depth
        v = (p[1, 0] * x + p[1, 1] * y + p[1, 2] * z + p[1, 3]) * per_depth
        du = pixels[j, 0] - u if seen else 0.0
        dv = pixels[j, 1] - v if seen else 0.0
        variance = sigma[j] * sigma[j]
        share = scale2 * variance / (du * du + dv * dv + scale2 * variance)
        weight = share * share / variance if seen and share >= _NEGLIGIBLE else 0.0
        u0, u1, u2 = (p[0, 0] - u * p[2, 0]) * per_depth, (p[0, 1] - u * p[2, 1]) * per_depth, (p[0, 2] - u * p[2, 2]) * per_depth
        v0, v1, v2 = (p[1, 0] - v * p[2, 0]) * per_depth, (p[1, 1] - v * p[2, 1]) * per_depth, (p[1, 2] - v * p[2, 2]) * per_depth
        to_u, to_v = du + u0 * x + u1 * y + u2 * z, dv + v0 * x + v1 * y + v2 * z
        terms[0, j] = weight * (u0 * u0 + v0 * v0)
        terms[1, j] = weight * (u0 * u1 + v0 * v1)
        terms[2, j] = weight * (u0 * u2 + v0 * v2)
        terms[3, j] = weight * (u1 * u1 + v1 * v1)
        terms[4, j] = weight * (u1 * u2 + v1 * v2)
        terms[5, j] = weight * (u2 * u2 + v2 * v2)
        terms[6, j] = weight * (u0 * to_u + v0 * to_v)
        terms[7, j] = weight * (u1 * to_u + v1 * to_v)
        terms[8, j] = weight * (u2 * to_u + v2 * to_v)


@compiled
def _add_pictures(
    blocks: Float,
    right: Float,
    x: Float,
    start: float,
    frame: float,
    projections: Float,
    times: Float,
    counts: Counts,
    pixels: Float,
    sigma: Float,
    usable: Bool,
    scale2: float,
) -> None:
    """Data terms of every picture within the window.

    Args:
        blocks: (knots, 4, 6, J) packed blocks between a position and the next three, added to.
        right: (knots, 3, J) right side, added to.
        x: (knots, 3, J) positions.
        start, frame: time of the first position, and between two, in seconds.
        projections, times, counts, pixels, sigma, usable: as in `Views` and `Tracks`.
        scale2: as in `_linearise`.
    """
    knots, joints = x.shape[0], x.shape[2]
    weights, point, terms = np.empty(4), np.empty((3, joints)), np.empty((9, joints))
    hessian, pull = terms[:6].reshape(6 * joints), terms[6:].reshape(3 * joints)
    block_rows, right_rows = blocks.reshape(knots, 4, 6 * joints), right.reshape(knots, 3 * joints)
    for camera in range(projections.shape[0]):
        for i in range(counts[camera]):
            place = (times[camera, i] - start) / frame
            if place < 0.0 or place > knots - 1:
                continue
            base = min(max(int(place) - 1, 0), knots - 4)
            _cubic(place - base, weights)
            for k in range(3):
                for j in range(joints):
                    point[k, j] = (
                        weights[0] * x[base, k, j]
                        + weights[1] * x[base + 1, k, j]
                        + weights[2] * x[base + 2, k, j]
                        + weights[3] * x[base + 3, k, j]
                    )
            _linearise(point, projections[camera], pixels[camera, i], sigma[camera, i], usable[camera, i], scale2, terms)
            for a in range(4):
                for n in range(3 * joints):
                    right_rows[base + a, n] += weights[a] * pull[n]
                for b in range(a, 4):
                    factor = weights[a] * weights[b]
                    for n in range(6 * joints):
                        block_rows[base + a, b - a, n] += factor * hessian[n]


@compiled
def _add_differences(penalty: Float, x: Float, order: int, strength: Float, freedom: float, held: float) -> None:
    """Penalty on differences, heavy-tailed: Student's t of this freedom, so that a throw is not ironed out (reweighted).

    Args:
        penalty: (knots, 4, J) coefficients between a position and the next three, the same for each coordinate, added to.
        x: (knots, 3, J) positions.
        order: of the difference.
        strength: (J,) inverse variance of a difference.
        freedom: of Student's t; infinite is a Gaussian.
        held: knots that pictures reach.
    """
    knots, joints = x.shape[0], x.shape[2]
    stencil = np.array([-1.0, 3.0, -3.0, 1.0]) if order == 3 else np.array([1.0, -2.0, 1.0, 0.0])
    weight = np.empty(joints)
    for first in range(knots - order):
        if freedom < np.inf:
            bound = _OPEN_SHARE if first + order > held else np.inf
            last = min(first + 3, knots - 1)
            for j in range(joints):
                size2 = 0.0
                for k in range(3):
                    size2 += (
                        stencil[0] * x[first, k, j]
                        + stencil[1] * x[first + 1, k, j]
                        + stencil[2] * x[first + 2, k, j]
                        + stencil[3] * x[last, k, j]
                    ) ** 2
                share = max((freedom + 3.0) / (freedom + strength[j] * size2), _LEAST_SHARE)
                weight[j] = strength[j] * min(share, bound)
        else:
            weight[:] = strength
        for a in range(order + 1):
            for b in range(a, order + 1):
                factor = stencil[a] * stencil[b]
                for j in range(joints):
                    penalty[first + a, b - a, j] += factor * weight[j]


@compiled
def _add_limb(
    blocks: Float,
    right: Float,
    x: Float,
    known: Bool,
    j: int,
    other: int,
    length: float,
    sigma: float,
    spread: Float,
    scale2: float,
) -> None:
    """Pull every position of a joint onto the limb's length from its other end, along the limb only."""
    direction = np.empty(3)
    for knot in range(x.shape[0]):
        if not known[other, knot]:
            continue
        distance = 0.0
        for k in range(3):
            direction[k] = x[knot, k, j] - x[knot, k, other]
            distance += direction[k] ** 2
        distance = np.sqrt(distance)
        if distance < 1e-3:
            continue
        variance = sigma * sigma
        for k in range(3):
            direction[k] /= distance
        for k in range(3):
            for m in range(3):
                variance += direction[k] * spread[k, m] * direction[m]
        # An end that went astray must not drag the other along: the term gives way (Geman-McClure) to a large difference.
        variance *= (1.0 + (distance - length) ** 2 / (scale2 * variance)) ** 2
        along = length
        for k in range(3):
            along += direction[k] * x[knot, k, other]
        for k in range(3):
            right[knot, k, j] += direction[k] * along / variance
            for m in range(k, 3):
                blocks[knot, 0, _PACKED[k, m], j] += direction[k] * direction[m] / variance


@compiled
def _add_limbs(
    blocks: Float,
    right: Float,
    x: Float,
    known: Bool,
    ends: Counts,
    lengths: Float,
    length_sigmas: Float,
    spread: Float,
    scale2: float,
) -> None:
    """Hold both ends of each limb whose length is known (not 0) at that length from each other.

    Args:
        blocks, right, x, scale2: as in `_add_pictures`.
        known: (J, knots) positions that hold anything.
        ends, lengths, length_sigmas: (L, 2), (L,), (L,) of the limbs.
        spread: (J, 3, 3) what is known of a joint, as seen from the other end.
    """
    for limb in range(ends.shape[0]):
        if lengths[limb] > 0.0:
            a, b = ends[limb]
            _add_limb(blocks, right, x, known, a, b, lengths[limb], length_sigmas[limb], spread[b], scale2)
            _add_limb(blocks, right, x, known, b, a, lengths[limb], length_sigmas[limb], spread[a], scale2)


@compiled
def _unpack(blocks: Float, penalty: Float, x: Float, right: Float, matrix: Float) -> None:
    """Write packed blocks (knots, 4, 6, J) and penalties (knots, 4, J) as the banded matrix (3 knots, band, J), with the prior."""
    knots, joints = x.shape[0], x.shape[2]
    for knot in range(knots):
        for k in range(3):
            row = 3 * knot + k
            for ahead in range(4):
                for m in range(3):
                    d = 3 * ahead + m - k
                    if d < 0:
                        continue
                    for j in range(joints):
                        matrix[row, d, j] = blocks[knot, ahead, _PACKED[k, m], j]
                    if k == m:
                        for j in range(joints):
                            matrix[row, d, j] += penalty[knot, ahead, j]
            for j in range(joints):
                matrix[row, 0, j] += _PRIOR_M2
                right[knot, k, j] += _PRIOR_M2 * x[knot, k, j]
            for d in range(BAND - k, BAND):
                matrix[row, d] = 0.0


@compiled
def assemble(
    x: Float,
    known: Bool,
    start: float,
    frame: float,
    projections: Float,
    times: Float,
    counts: Counts,
    pixels: Float,
    sigma: Float,
    usable: Bool,
    order: int,
    strength: Float,
    freedom: float,
    bend: Float,
    scale2: float,
    ends: Counts,
    lengths: Float,
    length_sigmas: Float,
    spread: Float,
    held: float,
    blocks: Float,
    penalty: Float,
    matrix: Float,
    right: Float,
) -> None:
    """The normal equations of all joints, linearised at `x`, into `matrix` (3 knots, band, J) and `right` (knots, 3, J).

    `blocks` and `penalty` are room to work in.
    """
    blocks[:] = 0.0
    penalty[:] = 0.0
    right[:] = 0.0
    _add_pictures(blocks, right, x, start, frame, projections, times, counts, pixels, sigma, usable, scale2)
    _add_differences(penalty, x, order, strength, freedom, held)
    _add_differences(penalty, x, 2, bend, np.inf, held)
    _add_limbs(blocks, right, x, known, ends, lengths, length_sigmas, spread, scale2)
    _unpack(blocks, penalty, x, right, matrix)
