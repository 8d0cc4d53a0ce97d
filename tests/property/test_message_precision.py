"""What is rounded for the wire stays what it says: near, bounded, and no more certain than it was."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from models.arrays import Float
from models.messages.precision import KEYPOINT_STEP_PX, RELATIVE_ERROR, covariances, keypoints, magnitudes

_SIZES = st.floats(1e-9, 1e6)


@given(arrays(np.float64, (17, 2), elements=st.floats(-1e4, 1e4)))
def test_a_keypoint_moves_by_at_most_half_a_step(values: Float) -> None:
    assert (np.abs(keypoints(values) - values) <= KEYPOINT_STEP_PX / 2).all()


@given(arrays(np.float64, 17, elements=_SIZES | st.just(0.0)))
def test_a_magnitude_keeps_its_first_eight_bits_and_its_zero(values: Float) -> None:
    rounded = magnitudes(values)
    assert (np.abs(rounded - values) <= RELATIVE_ERROR * values * (1 + 1e-6)).all()
    assert not (rounded.view(np.uint32) & 0xFFFF).any(), "digits beyond them would be stored"


@given(arrays(np.float64, 17, elements=st.floats(0, 1)))
def test_a_score_stays_between_zero_and_one(values: Float) -> None:
    rounded = magnitudes(values)
    assert (rounded >= 0).all()
    assert (rounded <= 1).all()


@given(
    arrays(np.float64, (3, 3), elements=st.floats(-1, 1)),
    arrays(np.float64, 3, elements=st.floats(-6, 1)),
)
def test_a_covariance_is_never_more_certain_than_it_was_in_any_direction(mix: Float, exponents: Float) -> None:
    turn, _ = np.linalg.qr(mix + 2 * np.eye(3))
    covariance = turn @ np.diag(10.0**exponents) @ turn.T
    covariance = (covariance + covariance.T) / 2
    rounded = covariances(covariance).astype(np.float64)
    assert (rounded == rounded.T).all()
    assert np.linalg.eigvalsh(rounded - covariance).min() >= -1e-6 * covariance.max()
    assert (np.diagonal(rounded) <= np.diagonal(covariance) * 1.021).all(), "nor is much of its certainty lost"
