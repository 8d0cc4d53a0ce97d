"""How exactly numbers travel: as finely as they are known and no finer, for digits that are noise cannot be compressed.

A lesson keeps every message. With all 24 bits of its floats, 45 minutes of four cameras at 30 pictures a second are over 150 MB.
The joints' places keep theirs: by them a replay is compared with what was live, and they are a small part of it.
"""

import numpy as np

from models.arrays import Float, Float32

KEYPOINT_STEP_PX = 2.0**-6
"""The best of the networks errs by more than a pixel."""
RELATIVE_ERROR = 2.0**-8
"""Of a magnitude, at most: it keeps eight significant bits, as bfloat16 does."""
_KEPT = np.uint32(0xFFFF0000)
_HALF_A_STEP = np.uint32(0x8000)


def keypoints(values_px: Float) -> Float32:
    """The nearest multiples of `KEYPOINT_STEP_PX`."""
    return np.asarray(np.round(values_px / KEYPOINT_STEP_PX) * KEYPOINT_STEP_PX, np.float32)


def magnitudes(values: Float | Float32) -> Float32:
    """Values of which only the size matters, each with at most `RELATIVE_ERROR`; zero stays zero."""
    bits = np.array(values, np.float32).view(np.uint32)
    bits += _HALF_A_STEP
    bits &= _KEPT
    return bits.view(np.float32)


def covariances(values: Float) -> Float32:
    """Covariances (..., n, n) as magnitudes that never promise more certainty than they had.

    Rounding alone could make one indefinite whose axes differ by more than a factor of 16. n + 1 times what an element may be off,
    added to the variances, outweighs that: |E x x| <= u (sum |x_i| sqrt(c_ii))^2 <= u n sum x_i^2 c_ii.
    """
    count = values.shape[-1]
    return magnitudes(values * (1 + np.eye(count) * (count + 1) * RELATIVE_ERROR))
