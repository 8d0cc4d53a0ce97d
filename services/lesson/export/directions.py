"""Directions and axes of bodies that are only partly known: what does not follow from the points is NaN."""

import numpy as np

from models.arrays import Bool, Float

_SHORTEST = 1e-6
"""What is shorter points nowhere."""


def unit(vectors: Float) -> Float:
    """(..., 3) of length 1; NaN where a vector has no length."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.where(length > _SHORTEST, length, np.nan))


def pair(exact: Float, near: Float) -> tuple[Float, Float]:
    """Two directions (..., 3) at right angles: the first, and the second as near as can be; NaN where they are one line."""
    first = unit(exact)
    second = unit(near)
    return first, unit(second - np.sum(first * second, axis=-1, keepdims=True) * first)


def complete(axes: Float) -> Bool:
    """(T,) where all of (T, 3, 3) is known."""
    return np.asarray(np.isfinite(axes).all(axis=(1, 2)))
