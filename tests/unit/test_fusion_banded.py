"""The banded solver of all joints in lockstep against numpy's dense one."""

import numpy as np
import pytest

from models.arrays import Float
from services.fusion.banded import inverse_blocks, solve_banded

BAND = 12
JOINTS = 17


def _systems(size: int) -> tuple[Float, Float]:
    """(J, size, size) positive definite with the smoother's band, and the same as `solve_banded` takes it."""
    rng = np.random.default_rng(size)
    factors = np.tril(np.triu(rng.normal(size=(JOINTS, size, size)), 1 - BAND))
    dense: Float = factors @ factors.transpose(0, 2, 1) + np.eye(size)
    matrix = np.zeros((size, BAND, JOINTS))
    for row in range(size):
        ahead = min(BAND, size - row)
        matrix[row, :ahead] = dense[:, row, row : row + ahead].T
    return dense, matrix


@pytest.mark.parametrize("size", [12, 54])
def test_each_joint_gets_the_solution_of_its_own_equations(size: int) -> None:
    dense, matrix = _systems(size)
    right = np.random.default_rng(1).normal(size=(size, JOINTS))
    solution, pivots = right.copy(), np.empty((size, JOINTS))
    solve_banded(matrix, solution, pivots)
    assert np.allclose(solution.T, np.linalg.solve(dense, right.T[..., None])[..., 0], rtol=1e-9, atol=1e-9)


def test_blocks_of_the_inverse_are_those_of_the_whole_inverse() -> None:
    dense, matrix = _systems(54)
    pivots = np.empty((54, JOINTS))
    solve_banded(matrix, np.zeros((54, JOINTS)), pivots)
    inverse, rows = np.linalg.inv(dense), np.array([0, 30, 51])
    for row, blocks in zip(rows, inverse_blocks(matrix, pivots, rows), strict=True):
        assert np.allclose(blocks, inverse[:, row : row + 3, row : row + 3], rtol=1e-9, atol=1e-12)
