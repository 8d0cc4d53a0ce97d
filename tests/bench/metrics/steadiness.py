"""How a reconstruction moves: acceleration error, jitter, jumps and peak speeds."""

import numpy as np

from models.arrays import Float


def acceleration_error_mm(found_m: Float, truth_m: Float) -> float:
    """Mean norm of the second difference of the error (frames, joints, 3), mm a frame squared, over whole triples of frames."""
    return jitter_mm(found_m - truth_m)


def jitter_mm(joints_m: Float) -> float:
    """Mean norm of the second difference of (frames, joints, 3), mm a frame squared, over whole triples of frames; NaN without any.

    It holds the true movement's own acceleration, so only reconstructions of one movement can be compared by it.
    """
    return _mean_mm(np.diff(joints_m, n=2, axis=0))


def largest_jump_mm(joints_m: Float) -> float:
    """Largest distance of a joint from itself one frame before, mm; of an error, how far the figure itself jumps."""
    steps = np.linalg.norm(np.diff(joints_m, axis=0), axis=-1)
    steps = steps[np.isfinite(steps)]
    return float(1e3 * steps.max()) if steps.size else np.nan


def peak_speed_m_s(positions_m: Float, rate_hz: float, half_span: int = 2) -> float:
    """Largest speed of a point (frames, 3) by a least-squares line over 2 `half_span` + 1 frames; NaN if none of them is whole.

    A longer span than two frames, so that noise of single frames is not taken for speed.
    """
    offsets = np.arange(-half_span, half_span + 1)
    if len(positions_m) < len(offsets):
        return np.nan
    windows = np.lib.stride_tricks.sliding_window_view(positions_m, len(offsets), axis=0)
    velocity = windows @ offsets / (offsets @ offsets) * rate_hz
    speed = np.linalg.norm(velocity, axis=-1)
    speed = speed[np.isfinite(speed)]
    return float(speed.max()) if speed.size else np.nan


def peak_speed_bias_pct(found_m: Float, truth_m: Float, rate_hz: float) -> float:
    """Peak speed of a point (frames, 3) over its true peak, both by the same central difference, as percent of change."""
    return 100 * (peak_speed_m_s(found_m, rate_hz, 1) / peak_speed_m_s(truth_m, rate_hz, 1) - 1)


def _mean_mm(differences_m: Float) -> float:
    norms = np.linalg.norm(differences_m, axis=-1)
    norms = norms[np.isfinite(norms)]
    return float(1e3 * norms.mean()) if norms.size else np.nan
