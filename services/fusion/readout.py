"""What the smoother's window says about an instant: positions, and the views that agree with them."""

import numpy as np

from models.arrays import Bool, Float, UInt32
from models.compiled import Counts, compiled

_INLIER2 = 9.21
"""Chi-square, 2 degrees of freedom, 99 %."""


@compiled
def _read(x: Float, place: float, out: Float) -> None:
    """(3, J) positions at a place of the window (knots, 3, J), in knots, by cubic interpolation."""
    base = min(max(int(place) - 1, 0), x.shape[0] - 4)
    u = place - base
    w0 = -(u - 1.0) * (u - 2.0) * (u - 3.0) / 6.0
    w1 = u * (u - 2.0) * (u - 3.0) / 2.0
    w2 = -u * (u - 1.0) * (u - 3.0) / 2.0
    w3 = u * (u - 1.0) * (u - 2.0) / 6.0
    for k in range(3):
        for j in range(x.shape[2]):
            out[k, j] = w0 * x[base, k, j] + w1 * x[base + 1, k, j] + w2 * x[base + 2, k, j] + w3 * x[base + 3, k, j]


@compiled
def _read_carried(x: Float, place: float, held: float, carry: float) -> Float:
    """(J, 3) positions at a place; beyond what pictures hold, carried on with the velocity there, which dies away.

    Args:
        x: (knots, 3, J) positions.
        place: in knots.
        held: knots that pictures reach.
        carry: time constant of the velocity, in knots.
    """
    joints = x.shape[2]
    point, steady = np.empty((3, joints)), held - 0.5
    if place <= steady or steady < 1.0:
        _read(x, place, point)
    else:
        before, after = np.empty((3, joints)), np.empty((3, joints))
        _read(x, steady - 0.25, before)
        _read(x, steady + 0.25, after)
        _read(x, steady, point)
        point += 2.0 * (after - before) * carry * (1.0 - np.exp(-(place - steady) / carry))
    out = np.empty((joints, 3))
    for j in range(joints):
        for k in range(3):
            out[j, k] = point[k, j]
    return out


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
    instant: float,
    memory: float,
) -> UInt32:
    """(J,) bits of the cameras with a picture within `memory` of the instant whose residual is within chi-square's 99 %."""
    joints = x.shape[2]
    bits, point = np.zeros(joints, np.uint32), np.empty((3, joints))
    for camera in range(projections.shape[0]):
        p, bit = projections[camera], np.uint32(1 << camera)
        for i in range(counts[camera]):
            place = (times[camera, i] - start) / frame
            if abs(times[camera, i] - instant) > memory or place < 0.0 or place > x.shape[0] - 1:
                continue
            _read(x, place, point)
            for j in range(joints):
                a, b, c = point[0, j], point[1, j], point[2, j]
                w = p[2, 0] * a + p[2, 1] * b + p[2, 2] * c + p[2, 3]
                du = pixels[camera, i, j, 0] * w - (p[0, 0] * a + p[0, 1] * b + p[0, 2] * c + p[0, 3])
                dv = pixels[camera, i, j, 1] * w - (p[1, 0] * a + p[1, 1] * b + p[1, 2] * c + p[1, 3])
                near = du * du + dv * dv <= _INLIER2 * (sigma[camera, i, j] * w) ** 2
                if usable[camera, i, j] and w > 1e-6 and near:
                    bits[j] |= bit
    return bits


@compiled
def read_window(
    x: Float,
    alive: Bool,
    start: float,
    frame: float,
    projections: Float,
    times: Float,
    counts: Counts,
    pixels: Float,
    sigma: Float,
    usable: Bool,
    held: float,
    carry: float,
    instants: Float,
    memories: Float,
) -> tuple[Float, UInt32]:
    """Points (n, J, 3) and agreeing views (n, J) at n instants; zeros for joints that are not `alive`."""
    points = np.zeros((instants.shape[0], x.shape[2], 3))
    views = np.zeros((instants.shape[0], x.shape[2]), np.uint32)
    for n in range(instants.shape[0]):
        point = _read_carried(x, (instants[n] - start) / frame, held, carry)
        bits = _agreeing(x, start, frame, projections, times, counts, pixels, sigma, usable, instants[n], memories[n])
        for j in range(x.shape[2]):
            if alive[j]:
                points[n, j], views[n, j] = point[j], bits[j]
    return points, views
