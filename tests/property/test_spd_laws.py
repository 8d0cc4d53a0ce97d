"""Laws of the small closed forms in place of LAPACK: as exact as numpy, however flat the matrix, and never without an answer."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.arrays import Float
from services.fusion.singer import distance2
from services.fusion.triangulation import invert

EPSILON = float(np.finfo(float).eps)


def positive_definite(seed: int, flatness: float, scale: float) -> Float:
    """A random (3, 3) whose largest eigenvalue is `scale` and whose smallest is 10^-`flatness` of it."""
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    values = scale * 10.0 ** -np.array((0.0, rng.uniform(0.0, flatness), flatness))
    matrix: Float = (turn * values) @ turn.T
    return 0.5 * (matrix + matrix.T)


def exactly_inverted(matrix: Float) -> Float:
    """By cofactors in rational numbers."""
    a = [[Fraction(float(value)) for value in row] for row in matrix]
    minors = [
        [
            a[(i + 1) % 3][(j + 1) % 3] * a[(i + 2) % 3][(j + 2) % 3] - a[(i + 1) % 3][(j + 2) % 3] * a[(i + 2) % 3][(j + 1) % 3]
            for i in range(3)
        ]
        for j in range(3)
    ]
    determinant = sum(a[0][j] * minors[j][0] for j in range(3))
    return np.array([[float(value / determinant) for value in row] for row in minors])


def inverted(matrix: Float) -> Float:
    inverse = np.empty((3, 3))
    invert(matrix, inverse)
    return inverse


matrices = st.builds(positive_definite, st.integers(0, 2**32 - 1), st.floats(0.0, 13.0), st.sampled_from([1e-6, 1.0, 1e8]))
vectors = st.integers(0, 2**32 - 1).map(lambda seed: np.random.default_rng(seed).normal(size=3))


@settings(max_examples=300, deadline=None)
@given(matrix=matrices)
def test_the_inverse_is_as_near_the_exact_one_as_numpys_and_symmetric(matrix: Float) -> None:
    exact, ours = exactly_inverted(matrix), inverted(matrix)
    size = np.linalg.norm(exact)
    allowed = 16 * EPSILON * np.linalg.cond(matrix)
    assert np.linalg.norm(ours - exact) / size <= allowed
    assert np.linalg.norm(ours - np.linalg.inv(matrix)) / size <= 2 * allowed
    assert np.array_equal(ours, ours.T)


@settings(max_examples=300, deadline=None)
@given(matrix=matrices, vector=vectors)
def test_the_distance_is_as_near_the_exact_one_as_numpys(matrix: Float, vector: Float) -> None:
    exact = float(vector @ exactly_inverted(matrix) @ vector)
    allowed = 64 * EPSILON * np.linalg.cond(matrix)
    assert distance2(matrix, vector) == pytest.approx(exact, rel=allowed)
    assert distance2(matrix, vector) == pytest.approx(float(vector @ np.linalg.solve(matrix, vector)), rel=2 * allowed)


@settings(max_examples=300, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), rank=st.sampled_from([1, 2]), vector=vectors)
def test_a_matrix_that_rounding_made_singular_has_a_finite_positive_answer(seed: int, rank: int, vector: Float) -> None:
    rows = np.random.default_rng(seed).normal(size=(rank, 3))
    flat = rows.T @ rows
    inverse = inverted(flat)
    assert np.isfinite(inverse).all()
    assert (np.diag(inverse) > 0).all()
    assert 0 <= distance2(flat, vector) < np.inf
