"""Series without holes for formats that allow none: what is unknown keeps its last value, and is said to be held."""

import numpy as np

from models.arrays import Bool, Float


def held(values: Float, known: Bool) -> Float:
    """(T, ...) with each unknown frame as the last known one before it; those before the first known one are as that.

    Args:
        values: what is known, and anything where it is not.
        known: (T,) where it is, somewhere.
    """
    frames = np.where(known, np.arange(len(known)), -1)
    last = np.maximum.accumulate(frames)
    return np.asarray(values[np.where(last < 0, np.argmax(known), last)])


def spans(flags: Bool) -> list[tuple[int, int]]:
    """Frames, counted from 0, from which to which (with it) a flag (T,) is set."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], flags, [False])).astype(np.int8)))
    return [(int(first), int(end) - 1) for first, end in edges.reshape(-1, 2)]
