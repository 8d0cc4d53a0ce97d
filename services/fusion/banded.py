"""Banded symmetric systems, one for each joint, solved in lockstep.

All joints have the same band, so that the joint is the innermost index of every array: one instruction then works on several
joints. `matrix[i, d]` is the element at row i and column i + d; the factorisation is L D L', without square roots.
"""

import numpy as np

from models.arrays import Float
from models.compiled import Counts, compiled

_LEAST_PIVOT = 1e-9


@compiled
def _factor(matrix: Float, right: Float, pivots: Float) -> None:
    """L' without its diagonal into `matrix`, the inverse of D into `pivots`, and L's inverse times `right` into it."""
    size, band, joints = matrix.shape
    factor = np.empty(joints)
    for i in range(size):
        for j in range(joints):
            pivots[i, j] = 1.0 / max(matrix[i, 0, j], _LEAST_PIVOT)
        for below in range(1, min(band, size - i)):
            for j in range(joints):
                factor[j] = matrix[i, below, j] * pivots[i, j]
                right[i + below, j] -= factor[j] * right[i, j]
            for d in range(band - below):
                for j in range(joints):
                    matrix[i + below, d, j] -= factor[j] * matrix[i, below + d, j]
        for below in range(1, band):
            for j in range(joints):
                matrix[i, below, j] *= pivots[i, j]


@compiled
def solve_banded(matrix: Float, right: Float, pivots: Float) -> None:
    """Factor and solve in place.

    Args:
        matrix: (size, band, J), upper part; becomes L' without its diagonal of ones, which is not written.
        right: (size, J), becomes the solution.
        pivots: (size, J), becomes the inverse of D.
    """
    size, band, joints = matrix.shape
    _factor(matrix, right, pivots)
    for i in range(size - 1, -1, -1):
        for j in range(joints):
            right[i, j] *= pivots[i, j]
        for beyond in range(1, min(band, size - i)):
            for j in range(joints):
                right[i, j] -= matrix[i, beyond, j] * right[i + beyond, j]


@compiled
def _inverse_block(matrix: Float, pivots: Float, first: int, columns: Float, out: Float) -> None:
    """The lower half of one block (3, 3, J) into `out`; `columns` (size, 3, J) is room to work in."""
    size, band, joints = matrix.shape
    columns[first:] = 0.0
    out[:] = 0.0
    for k in range(3):
        columns[first + k, k] = 1.0
    for i in range(first, size):
        for below in range(1, min(band, size - i)):
            for k in range(3):
                for j in range(joints):
                    columns[i + below, k, j] -= matrix[i, below, j] * columns[i, k, j]
        for k in range(3):
            for m in range(k + 1):
                for j in range(joints):
                    out[k, m, j] += columns[i, k, j] * pivots[i, j] * columns[i, m, j]


@compiled
def inverse_blocks(matrix: Float, pivots: Float, first_rows: Counts) -> Float:
    """(n, J, 3, 3) blocks on the diagonal of the inverse that begin at each of the rows (n,), of what `solve_banded` leaves.

    With L Y = E for three unit vectors E, a block is Y' D^-1 Y, and Y is zero before its first row.
    """
    size, joints = pivots.shape
    out = np.empty((first_rows.shape[0], joints, 3, 3))
    columns, half = np.empty((size, 3, joints)), np.empty((3, 3, joints))
    for n in range(first_rows.shape[0]):
        _inverse_block(matrix, pivots, first_rows[n], columns, half)
        for j in range(joints):
            for k in range(3):
                for m in range(3):
                    out[n, j, k, m] = half[max(k, m), min(k, m), j]
    return out
