"""Values between frames."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.interpolation import between


def test_between_two_frames_values_lie_in_a_straight_line_and_beyond_the_ends_they_stay() -> None:
    values = np.array([[0.0, 10.0], [2.0, 20.0], [8.0, 0.0]])
    taken = between(values, np.array([-3.0, 0.0, 0.5, 1.75, 2.0, 9.0]))
    np.testing.assert_allclose(taken, np.array([[0, 10], [0, 10], [1, 15], [6.5, 5], [8, 0], [8, 0]], np.float64))
    np.testing.assert_allclose(between(values, np.array([[0.5, 1.0]])), [[[1, 15], [2, 20]]])
    np.testing.assert_array_equal(between(values[:1], np.array([0.0, 4.0])), values[[0, 0]])


def test_a_frame_beside_an_unknown_one_is_known_and_between_them_nothing_is() -> None:
    values = np.random.default_rng(3).normal(size=(4, 5, 3))
    values[2] = np.nan
    taken = between(values, np.array([-1.0, 1.0, 1.5, 3.0, 9.0]))
    assert np.isnan(taken[2]).all()
    np.testing.assert_array_equal(taken[[0, 1, 3, 4]], values[[0, 1, 3, 3]])


@given(st.integers(1, 9), st.lists(st.floats(-3, 12), min_size=1, max_size=9), st.integers(0, 2**31))
def test_it_is_what_numpy_makes_of_one_dimension(count: int, frames: list[float], seed: int) -> None:
    values = np.random.default_rng(seed).normal(size=count)
    assert between(values, np.array(frames)) == pytest.approx(np.interp(frames, np.arange(count), values))
