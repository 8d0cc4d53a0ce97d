"""Smooth curves through values at given times."""

import numpy as np

from models.arrays import Float


def monotone(times_s: Float, values: Float, at_s: Float) -> Float:
    """Piecewise cubic with continuous velocity that never overshoots: between two knots it stays between their values.

    Fritsch and Butland, "A method for constructing local monotone piecewise cubic interpolants", SIAM J. Sci. Stat. Comput. 5,
    1984 (what is known as PCHIP). Still at both ends; constant before the first knot and after the last.

    Args:
        times_s: (N,) ascending; N may be 1.
        values: (N, ...) at these times.
        at_s: (T,) wanted.
    """
    if len(times_s) == 1:
        return np.broadcast_to(values[0], (len(at_s), *values.shape[1:])).copy()
    return hermite(times_s, values, monotone_slopes(times_s, values), at_s)


def hermite(times_s: Float, values: Float, slopes: Float, at_s: Float) -> Float:
    """Piecewise cubic with these (N, ...) velocities at the knots; constant outside. Arguments as in `monotone`."""
    inside = np.clip(at_s, times_s[0], times_s[-1])
    piece = np.clip(np.searchsorted(times_s, inside, side="right") - 1, 0, len(times_s) - 2)
    length = (times_s[piece + 1] - times_s[piece]).reshape(-1, *(1,) * (values.ndim - 1))
    u = (inside - times_s[piece]).reshape(length.shape) / length
    start, end, leaving, arriving = values[piece], values[piece + 1], slopes[piece] * length, slopes[piece + 1] * length
    return np.asarray(
        (1 + 2 * u) * (1 - u) ** 2 * start
        + u * (1 - u) ** 2 * leaving
        + u**2 * (3 - 2 * u) * end
        - u**2 * (1 - u) * arriving
    )  # fmt: skip


def monotone_slopes(times_s: Float, values: Float) -> Float:
    """(N, ...) velocities at the knots for `hermite`, by which it does not overshoot."""
    gaps = np.diff(times_s).reshape(-1, *(1,) * (values.ndim - 1))
    rises = np.diff(values, axis=0) / gaps
    slopes = np.zeros(values.shape)
    before, after = rises[:-1], rises[1:]
    same = before * after > 0
    first, second = 2 * gaps[1:] + gaps[:-1], gaps[1:] + 2 * gaps[:-1]
    safe = np.where(same, before, 1.0), np.where(same, after, 1.0)
    slopes[1:-1] = np.where(same, (first + second) / (first / safe[0] + second / safe[1]), 0.0)
    return slopes


def minimum_jerk(share: Float) -> Float:
    """From 0 to 1, still at both ends: Flash and Hogan, "The coordination of arm movements", J. Neuroscience 5, 1985."""
    u = np.clip(share, 0.0, 1.0)
    return np.asarray(u**3 * (10 - 15 * u + 6 * u**2))


def lasting(times_s: Float, from_s: float, to_s: float, ease_s: float) -> Float:
    """(T,) 1 between two times, 0 outside, with this much time to go from one to the other."""
    up, down = minimum_jerk((times_s - from_s + ease_s) / ease_s), minimum_jerk((times_s - to_s) / ease_s)
    return np.asarray(up - down)


def softened(values: Float, sigma_samples: float) -> Float:
    """(T, ...) smoothed along time by a Gaussian; the ends are held. It rounds the corners that knots leave in the acceleration."""
    reach = int(np.ceil(4 * sigma_samples))
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma_samples) ** 2)
    padded = np.concatenate((np.repeat(values[:1], reach, axis=0), values, np.repeat(values[-1:], reach, axis=0)))
    flat = padded.reshape(len(padded), -1)
    smooth = np.stack([np.convolve(column, kernel / kernel.sum(), mode="valid") for column in flat.T], axis=-1)
    return np.asarray(smooth.reshape(values.shape))
