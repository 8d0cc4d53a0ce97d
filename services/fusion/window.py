"""Compiled solution of the smoother's window; `smoothing.py` says what is solved.

Unknowns are ordered position by position, three coordinates each. Pictures couple four neighbouring positions through cubic
interpolation and third differences do the same, so the normal equations have a band of twelve.
"""

import numpy as np

from models.arrays import Bool, Float, UInt32
from services.fusion.compiled import Counts, compiled

_BAND = 12
"""Sub-diagonals and the diagonal."""
_LEAST_SHARE = 0.02
"""No difference, however large, loses more of its penalty."""
_NEGLIGIBLE = 0.03
"""A point of less than this share (squared) of its weight is 17 sigmas off and left out."""
_OPEN_SHARE = 0.03
"""Penalty of differences beyond the newest picture. Extrapolation makes them look small, which is no evidence that they are."""


@compiled
def _cubic(u: float, weights: Float) -> None:
    """Lagrange weights of positions 0 to 3 at u in [0, 3]."""
    weights[0] = -(u - 1.0) * (u - 2.0) * (u - 3.0) / 6.0
    weights[1] = u * (u - 2.0) * (u - 3.0) / 2.0
    weights[2] = -u * (u - 1.0) * (u - 3.0) / 2.0
    weights[3] = u * (u - 1.0) * (u - 2.0) / 6.0


@compiled
def _add_picture(
    band: Float,
    right: Float,
    x: Float,
    place: float,
    projection: Float,
    pixel: Float,
    variance: float,
    scale2: float,
    scratch: Float,
) -> None:
    """Linearised robust data term of one point of one picture, taken `place` knots into the window."""
    weights, point, block, pull = scratch[0], scratch[1], scratch[2:5], scratch[5]
    base = min(max(int(place) - 1, 0), x.shape[0] - 4)
    _cubic(place - base, weights)
    for k in range(3):
        point[k] = weights[0] * x[base, k] + weights[1] * x[base + 1, k] + weights[2] * x[base + 2, k] + weights[3] * x[base + 3, k]
    w = projection[2, 0] * point[0] + projection[2, 1] * point[1] + projection[2, 2] * point[2] + projection[2, 3]
    if w <= 1e-6:
        return
    u = (projection[0, 0] * point[0] + projection[0, 1] * point[1] + projection[0, 2] * point[2] + projection[0, 3]) / w
    v = (projection[1, 0] * point[0] + projection[1, 1] * point[1] + projection[1, 2] * point[2] + projection[1, 3]) / w
    du, dv = pixel[0] - u, pixel[1] - v
    share = scale2 / ((du * du + dv * dv) / variance + scale2)
    weight = share * share / variance
    if share < _NEGLIGIBLE:
        return
    for k in range(3):
        along_u = (projection[0, k] - u * projection[2, k]) / w
        along_v = (projection[1, k] - v * projection[2, k]) / w
        pull[k] = weight * (along_u * du + along_v * dv)
        for m in range(3):
            block[k, m] = weight * (
                along_u * (projection[0, m] - u * projection[2, m]) / w + along_v * (projection[1, m] - v * projection[2, m]) / w
            )
            pull[k] += block[k, m] * point[m]
    for a in range(4):
        row = 3 * (base + a)
        for k in range(3):
            right[row + k] += weights[a] * pull[k]
            for m in range(k + 1):
                band[row + k, k - m] += weights[a] * weights[a] * block[k, m]
        for b in range(a):
            factor = weights[a] * weights[b]
            for k in range(3):
                for m in range(3):
                    band[row + k, 3 * (a - b) + k - m] += factor * block[k, m]


@compiled
def _add_pictures(
    band: Float,
    right: Float,
    x: Float,
    start: float,
    frame: float,
    projection: Float,
    times: Float,
    count: int,
    pixels: Float,
    sigma: Float,
    usable: Bool,
    scale2: float,
    joint: int,
    scratch: Float,
) -> None:
    """Data terms of one joint in one camera's pictures."""
    for i in range(count):
        place = (times[i] - start) / frame
        if usable[i, joint] and 0.0 <= place <= x.shape[0] - 1:
            variance = sigma[i, joint] * sigma[i, joint]
            _add_picture(band, right, x, place, projection, pixels[i, joint], variance, scale2, scratch)


@compiled
def _add_differences(band: Float, x: Float, order: int, strength: float, freedom: float, held: float) -> None:
    """Penalty on differences, heavy-tailed: Student's t of this freedom, so that a throw is not ironed out (reweighted)."""
    knots = x.shape[0]
    stencil = np.array([-1.0, 3.0, -3.0, 1.0]) if order == 3 else np.array([1.0, -2.0, 1.0, 0.0])
    for first in range(knots - order):
        size2 = 0.0
        for k in range(3):
            difference = 0.0
            for a in range(order + 1):
                difference += stencil[a] * x[first + a, k]
            size2 += difference * difference
        weight = strength
        if freedom < np.inf:
            weight *= max((freedom + 3.0) / (freedom + strength * size2), _LEAST_SHARE)
            if first + order > held:
                weight = min(weight, _OPEN_SHARE * strength)
        for a in range(order + 1):
            for b in range(a + 1):
                for k in range(3):
                    band[3 * (first + a) + k, 3 * (a - b)] += weight * stencil[a] * stencil[b]


@compiled
def _add_limb(
    band: Float, right: Float, x: Float, other: Float, known: Bool, length: float, sigma: float, spread: Float, scale2: float
) -> None:
    """Pull every position onto the limb's length from its other end, along the limb only."""
    direction = np.empty(3)
    for knot in range(x.shape[0]):
        if not known[knot]:
            continue
        distance = 0.0
        for k in range(3):
            direction[k] = x[knot, k] - other[knot, k]
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
            along += direction[k] * other[knot, k]
        for k in range(3):
            right[3 * knot + k] += direction[k] * along / variance
            for m in range(3):
                if m <= k:
                    band[3 * knot + k, k - m] += direction[k] * direction[m] / variance


@compiled
def _factor(band: Float) -> None:
    """Banded Cholesky in place: band[i, d] becomes L[i, i - d]."""
    size, width = band.shape
    for i in range(size):
        for j in range(max(0, i - width + 1), i + 1):
            total = band[i, i - j]
            for k in range(max(0, i - width + 1), j):
                total -= band[i, i - k] * band[j, j - k]
            band[i, i - j] = np.sqrt(max(total, 1e-9)) if i == j else total / band[j, 0]


@compiled
def _solve(band: Float, right: Float, first: int) -> None:
    """Solve in place with a factored band, for a right side that is zero before `first`; what comes before it is left out."""
    size, width = band.shape
    for i in range(first, size):
        total = right[i]
        for k in range(max(first, i - width + 1), i):
            total -= band[i, i - k] * right[k]
        right[i] = total / band[i, 0]
    for i in range(size - 1, first - 1, -1):
        total = right[i]
        for k in range(i + 1, min(size, i + width)):
            total -= band[k, k - i] * right[k]
        right[i] = total / band[i, 0]


@compiled
def _agreeing(
    x: Float,
    start: float,
    frame: float,
    projections: Float,
    times: Float,
    counts: Counts,
    pixels: Float,
    sigma: Float,
    usable: Bool,
    joint: int,
    instant: float,
    memory: float,
) -> int:
    """Bits of the cameras with a picture near the instant whose residual is within chi-square's 99 %."""
    point, bits = np.empty(3), 0
    for camera in range(projections.shape[0]):
        for i in range(counts[camera]):
            place = (times[camera, i] - start) / frame
            if not usable[camera, i, joint] or abs(times[camera, i] - instant) > memory or place < 0.0 or place > x.shape[0] - 1:
                continue
            _read(x, place, point)
            p = projections[camera]
            w = p[2, 0] * point[0] + p[2, 1] * point[1] + p[2, 2] * point[2] + p[2, 3]
            if w > 1e-6:
                du = pixels[camera, i, joint, 0] - (p[0, 0] * point[0] + p[0, 1] * point[1] + p[0, 2] * point[2] + p[0, 3]) / w
                dv = pixels[camera, i, joint, 1] - (p[1, 0] * point[0] + p[1, 1] * point[1] + p[1, 2] * point[2] + p[1, 3]) / w
                if du * du + dv * dv <= 9.21 * sigma[camera, i, joint] ** 2:
                    bits |= 1 << camera
                    break
    return bits


@compiled
def _read(x: Float, place: float, out: Float) -> None:
    """Position at a place of the window, in knots."""
    weights = np.empty(4)
    base = min(max(int(place) - 1, 0), x.shape[0] - 4)
    _cubic(place - base, weights)
    for k in range(3):
        out[k] = weights[0] * x[base, k] + weights[1] * x[base + 1, k] + weights[2] * x[base + 2, k] + weights[3] * x[base + 3, k]


@compiled
def _read_carried(x: Float, place: float, held: float, carry: float, out: Float) -> None:
    """As `_read`, but beyond what pictures hold, carried on with the velocity there, which dies away."""
    steady = held - 0.5
    if place <= steady or steady < 1.0:
        _read(x, place, out)
        return
    before, after = np.empty(3), np.empty(3)
    _read(x, steady - 0.25, before)
    _read(x, steady + 0.25, after)
    _read(x, steady, out)
    reach = carry * (1.0 - np.exp(-(place - steady) / carry))
    for k in range(3):
        out[k] += 2.0 * (after[k] - before[k]) * reach


@compiled
def smooth_window(
    positions: Float,
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
    iterations: int,
    ends: Counts,
    lengths: Float,
    length_sigmas: Float,
    spread: Float,
    held: float,
    carry: float,
    instants: Float,
    memories: Float,
) -> tuple[Float, Float, UInt32]:
    """The kernel of `Smoother.step`: positions are improved in place; what is read at the instants comes back."""
    joints, knots, reads = positions.shape[0], positions.shape[1], instants.shape[0]
    points, covariance = np.zeros((reads, joints, 3)), np.zeros((reads, joints, 3, 3))
    views = np.zeros((reads, joints), np.uint32)
    band, right, scratch = np.empty((3 * knots, _BAND)), np.empty(3 * knots), np.empty((6, 4))
    for j in range(joints):
        if not known[j].any():
            continue
        x = positions[j]
        for _ in range(iterations):
            band[:] = 0.0
            right[:] = 0.0
            for camera in range(projections.shape[0]):
                pictures = times[camera], counts[camera], pixels[camera], sigma[camera], usable[camera]
                _add_pictures(band, right, x, start, frame, projections[camera], *pictures, scale2, j, scratch)
            _add_differences(band, x, order, strength[j], freedom, held)
            _add_differences(band, x, 2, bend[j], np.inf, held)
            for limb in range(ends.shape[0]):
                if lengths[limb] > 0.0 and (ends[limb, 0] == j or ends[limb, 1] == j):
                    other = ends[limb, 1] if ends[limb, 0] == j else ends[limb, 0]
                    _add_limb(
                        band, right, x, positions[other], known[other], lengths[limb], length_sigmas[limb], spread[other], scale2
                    )
            # A metre of doubt about what was there before keeps what no picture and no neighbour holds in its place.
            for i in range(3 * knots):
                band[i, 0] += 1.0
                right[i] += x[i // 3, i % 3]
            _factor(band)
            _solve(band, right, 0)
            for i in range(3 * knots):
                x[i // 3, i % 3] = right[i]
        known[j] = True
        for read in range(reads):
            place = (instants[read] - start) / frame
            _read_carried(x, place, held, carry, points[read, j])
            # The later of the two positions around the instant is the less certain one.
            knot = min(int(np.ceil(place - 1e-6)), knots - 1)
            for k in range(3):
                right[3 * knot :] = 0.0
                right[3 * knot + k] = 1.0
                _solve(band, right, 3 * knot)
                for m in range(3):
                    covariance[read, j, m, k] = right[3 * knot + m]
            views[read, j] = _agreeing(
                x, start, frame, projections, times, counts, pixels, sigma, usable, j, instants[read], memories[read]
            )
    return points, covariance, views
