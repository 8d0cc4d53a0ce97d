"""Series without holes for formats that allow none: what is unknown keeps its last value, and is said to be held."""

from collections.abc import Mapping

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


def told(flags: Mapping[str, Bool]) -> dict[str, list[list[int]]]:
    """For each name whose flag (T,) is ever set, the frames, counted from 1, from which to which (with it) that is so."""
    found = {}
    for name, flag in flags.items():
        edges = np.flatnonzero(np.diff(np.concatenate(([False], flag, [False])).astype(np.int8)))
        if len(edges):
            found[name] = [[int(first) + 1, int(end)] for first, end in edges.reshape(-1, 2)]
    return found
