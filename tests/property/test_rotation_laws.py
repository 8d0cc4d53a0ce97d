"""Rotations by whichever way they are made are the same."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from models.motions.rotations import about, matrices


@given(st.integers(0, 2), st.lists(st.floats(-20, 20), max_size=4))
def test_a_turn_about_an_axis_is_that_of_a_rotation_vector_along_it(axis: int, angles: list[float]) -> None:
    vectors = np.array(angles).reshape(-1, 1) * np.eye(3)[axis]
    np.testing.assert_allclose(about(axis, np.array(angles)), matrices(vectors), atol=1e-12)


@given(st.integers(0, 2), st.floats(-20, 20))
def test_one_angle_gives_one_matrix(axis: int, angle: float) -> None:
    np.testing.assert_allclose(about(axis, np.array(angle)), matrices(angle * np.eye(3)[axis]), atol=1e-12)
