"""Motion energy (equation 17), and the keyframes that it tells by itself: E = sum |v|^2 + eta sum |a|^2, smoothed, its maxima.

Velocity and acceleration are per frame, not per second: in SI units eta = 0.3 would make the acceleration nearly all of the energy,
and the maxima those of noise (0.3 per frame at 30 Hz is 0.3 / 900 in SI units).
"""

from dataclasses import dataclass

import numpy as np

from models.arrays import Float
from models.compiled import Counts


@dataclass(frozen=True)
class EnergyConfig:
    """How keyframes are told from energy.

    Attributes:
        eta: weight of the acceleration, per frame.
        window: frames over which the energy is smoothed (Savitzky and Golay, Anal. Chem. 36(8), 1964); odd.
        order: of the smoothing polynomial.
        apart: of two maxima that are nearer than this many frames, the lower one is suppressed.
        least: maxima below this share of the highest one are none.
    """

    eta: float = 0.3
    window: int = 7
    order: int = 2
    apart: int = 6
    least: float = 0.05


DEFAULT = EnergyConfig()


def motion_energy(joints_m: Float, eta: float = DEFAULT.eta) -> Float:
    """(T,) energy of (T, K, 3) joints, square metres a frame squared; for unknown joints the mean of the known ones is counted.

    Frames in which no joint's velocity and acceleration are known, the first and the last among them, have the energy of the
    nearest one that is known; 0 if none is.
    """
    count = len(joints_m)
    if count < 3:
        return np.zeros(count)
    velocity = (joints_m[2:] - joints_m[:-2]) / 2
    acceleration = joints_m[2:] - 2 * joints_m[1:-1] + joints_m[:-2]
    each = (velocity**2).sum(axis=2) + eta * (acceleration**2).sum(axis=2)
    known = np.isfinite(each)
    some = np.flatnonzero(known.any(axis=1))
    if not len(some):
        return np.zeros(count)
    means = np.where(known[some], each[some], 0.0).sum(axis=1) / known[some].sum(axis=1)
    return np.asarray(np.interp(np.arange(count), some + 1, joints_m.shape[1] * means))


def keyframes_of_energy(joints_m: Float, config: EnergyConfig = DEFAULT) -> Counts:
    """(n,) frames at which the energy has its maxima, in their order: equation 17 and nothing else."""
    if len(joints_m) < config.window:
        return np.zeros(0, np.int64)
    from scipy.signal import savgol_filter  # noqa: PLC0415 - a quarter of a second, and the box asks for energy alone nowhere

    energy = np.asarray(savgol_filter(motion_energy(joints_m, config.eta), config.window, config.order))
    inner = energy[1:-1]
    tops = 1 + np.flatnonzero((inner > energy[:-2]) & (inner >= energy[2:]) & (inner >= config.least * energy.max()))
    kept: list[int] = []
    for top in tops[np.argsort(-energy[tops], kind="stable")].tolist():
        if all(abs(top - other) >= config.apart for other in kept):
            kept.append(top)
    return np.array(sorted(kept), np.int64)
