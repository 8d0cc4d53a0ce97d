"""Truth that is known at samples, at any instant between them."""

from collections.abc import Callable
from typing import Final

import numpy as np
from scipy.interpolate import CubicSpline

from models.arrays import Float

_LEAST: Final = 4


def between_samples(times_s: Float, points_m: Float) -> Callable[[Float], Float]:
    """Places (m, J, 3) at (m,) instants by a cubic spline through each joint's samples, wherever they follow one another.

    Args:
        times_s: (n,) instants of the samples, ascending.
        points_m: (n, J, 3); NaN where there is none. A gap stays a gap, and so does what lies beyond the ends.
    """
    step = float(np.diff(times_s).mean()) if len(times_s) > 1 else 0.0
    pieces = [(joint, piece) for joint in range(points_m.shape[1]) for piece in _runs(points_m[:, joint])]
    splines = [(joint, times_s[run], CubicSpline(times_s[run], points_m[run, joint])) for joint, run in pieces]

    def places(instants_s: Float) -> Float:
        out = np.full((len(instants_s), points_m.shape[1], 3), np.nan)
        for joint, known, spline in splines:
            inside = (instants_s >= known[0] - 1e-6 * step) & (instants_s <= known[-1] + 1e-6 * step)
            out[inside, joint] = spline(instants_s[inside])
        return out

    return places


def _runs(points_m: Float) -> list[slice]:
    """Stretches of (n, 3) without a gap that are long enough for a spline."""
    known = np.isfinite(points_m).all(axis=1)
    edges = np.flatnonzero(np.diff(np.concatenate(([False], known, [False])).astype(np.int8)))
    return [slice(int(begin), int(end)) for begin, end in edges.reshape(-1, 2) if end - begin >= _LEAST]
