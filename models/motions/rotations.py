"""Rotations of many poses at once: matrices, rotation vectors, frames. All arrays (..., 3) or (..., 3, 3); radians."""

import numpy as np

from models.arrays import Float

_TINY = 1e-9


def matrices(vectors: Float) -> Float:
    """(..., 3, 3) of rotation vectors (..., 3), by Rodrigues' formula."""
    angle = np.linalg.norm(vectors, axis=-1)[..., None, None]
    cross = np.zeros((*vectors.shape, 3))
    cross[..., 0, 1], cross[..., 0, 2], cross[..., 1, 2] = -vectors[..., 2], vectors[..., 1], -vectors[..., 0]
    cross -= cross.swapaxes(-1, -2)
    half = np.sinc(angle / (2 * np.pi))
    return np.asarray(np.eye(3) + np.sinc(angle / np.pi) * cross + 0.5 * half**2 * (cross @ cross))


def vectors(rotations: Float) -> Float:
    """(..., 3) rotation vectors of (..., 3, 3) matrices, by their quaternions, which keeps all digits also near half a turn."""
    quaternion = quaternions(rotations)
    sine = np.linalg.norm(quaternion[..., 1:], axis=-1, keepdims=True)
    angle = 2 * np.arctan2(sine, quaternion[..., :1])
    return np.asarray(quaternion[..., 1:] * np.where(sine > _TINY, angle / np.maximum(sine, _TINY), 2.0))


def quaternions(rotations: Float) -> Float:
    """(..., 4) unit quaternions (w, x, y, z) with w >= 0. Shepperd's method: the largest of the four is divided by."""
    trace = np.trace(rotations, axis1=-2, axis2=-1)
    squares = np.concatenate((trace[..., None], np.diagonal(rotations, axis1=-2, axis2=-1)), axis=-1)
    largest = np.argmax(squares, axis=-1)
    skew = np.stack([rotations[..., b, a] - rotations[..., a, b] for a, b in ((1, 2), (2, 0), (0, 1))], axis=-1)
    symmetric = rotations + rotations.swapaxes(-1, -2)
    table = np.empty((*largest.shape, 4, 4))
    table[..., 0, 0] = 1 + trace
    table[..., 0, 1:] = table[..., 1:, 0] = skew
    table[..., 1:, 1:] = symmetric
    for axis in range(3):
        table[..., axis + 1, axis + 1] = 1 - trace + 2 * rotations[..., axis, axis]
    row = np.take_along_axis(table, largest[..., None, None], axis=-2)[..., 0, :]
    row = row / np.linalg.norm(row, axis=-1, keepdims=True)
    return np.asarray(np.where(row[..., :1] < 0, -row, row))


def about(axis: int, angle: Float) -> Float:
    """(..., 3, 3) turns about x (0), y (1) or z (2)."""
    # `matrices` of an axis along x, y or z, written out: motions are made of a thousand of these each.
    angle = np.asarray(angle, np.float64)
    sine, cosine = np.sin(angle), np.cos(angle)
    turns = np.zeros((*angle.shape, 3, 3))
    first, second = (axis + 1) % 3, (axis + 2) % 3
    turns[..., axis, axis] = 1.0
    turns[..., first, first] = turns[..., second, second] = cosine
    turns[..., second, first], turns[..., first, second] = sine, -sine
    return turns


def unit(vector: Float) -> Float:
    """(..., 3) of length 1."""
    return np.asarray(vector / np.maximum(np.linalg.norm(vector, axis=-1, keepdims=True), _TINY))


def frame(along: Float, towards: Float) -> Float:
    """(..., 3, 3) whose columns are `along` as a unit vector, what of `towards` is square to it, and their cross product."""
    first = unit(along)
    second = unit(towards - np.sum(first * towards, axis=-1, keepdims=True) * first)
    return np.stack(np.broadcast_arrays(first, second, np.cross(first, second)), axis=-1)


def between(start: Float, end: Float, share: Float) -> Float:
    """(..., 3, 3) the shortest turn from one matrix to another, gone by `share` (...) of its way."""
    step = vectors(start.swapaxes(-1, -2) @ end)
    return np.asarray(start @ matrices(step * share[..., None]))


def through(rotation: Float, points: Float) -> Float:
    """(..., 3) points or directions turned by (..., 3, 3) matrices."""
    return np.asarray(np.einsum("...ij,...j->...i", rotation, points))
