"""Values between frames."""

import numpy as np

from models.arrays import Float


def between(values: Float, frames: Float) -> Float:
    """Values at frames between those that there are, in a straight line; before the first and after the last they stay.

    Args:
        values: (S, ...) one a frame, at least one.
        frames: of any shape, in frames from the first.

    Returns:
        (..., whatever a frame has); NaN where a value that has a part in it is.
    """
    inside = np.clip(frames, 0, len(values) - 1)
    below = inside.astype(np.int64)
    share = (inside - below).reshape(*inside.shape, *[1] * (values.ndim - 1))
    above = values[np.minimum(below + 1, len(values) - 1)]
    return np.asarray(np.where(share > 0, (1 - share) * values[below] + share * above, values[below]))
