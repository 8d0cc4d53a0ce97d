"""The body's centre as a whole (eq. 9): position, velocity and acceleration, from which crops are predicted.

Eq. 9 is linear. What makes the filter an extended one is the measurement: each camera's picture of the centre, at its own time. It
is the joints' filter with one joint, compiled.
"""

import numpy as np

from models.arrays import Bool, Float
from models.compiled import Counts, compiled
from services.fusion.singer import advance_joints, update_joints

_ACCELERATION_M_S2 = np.array([5.0])
_ACCELERATION_MEMORY_S = 0.3
_VELOCITY_MEMORY_S = 0.6
_MAX_SPEED_M_S = 12.0
_SOFT_GATE = 6.0


@compiled
def centre_in_picture(
    points: Float, sigma: Float, usable: Bool, expected: Float, known: Bool, trunk: Counts
) -> tuple[float, float, float]:
    """Pixel and sigma of the trunk's centre; a hidden corner is taken to be where it is expected.

    Args:
        points, sigma, usable: (J, 2), (J,), (J,) of one picture.
        expected, known: (J, 2) and (J,) where the joints should be.
        trunk: its corners.

    Returns:
        The sigma is infinite if a corner is neither seen nor expected, or if only one is seen.
    """
    u, v, largest, seen = 0.0, 0.0, 1.0, 0
    for joint in trunk:
        if usable[joint]:
            u, v = u + points[joint, 0], v + points[joint, 1]
            largest = max(largest, sigma[joint])
            seen += 1
        elif known[joint]:
            u, v = u + expected[joint, 0], v + expected[joint, 1]
        else:
            return 0.0, 0.0, np.inf
    return u / trunk.shape[0], v / trunk.shape[0], largest if seen >= 2 else np.inf


class BodyFilter:
    """The 9-state filter; frame of reference: the world, SI units."""

    def __init__(self, t_s: float, centre_m: Float) -> None:
        self.t_s = t_s
        self._state: Float = np.concatenate((centre_m, np.zeros(6)))[None]
        self._covariance: Float = np.diag(np.repeat((0.05**2, 1.0**2, 5.0**2), 3))[None]
        self._alive: Bool = np.ones(1, np.bool_)

    def at(self, t_s: float) -> Float:
        """(9,) position, velocity and acceleration predicted to `t_s`, or carried back to it at constant velocity."""
        state: Float = self._state[0].copy()
        if t_s <= self.t_s:
            state[:3] += (t_s - self.t_s) * state[3:6]
            return state
        ahead, covariance = self._state.copy(), self._covariance.copy()
        self._advance(ahead, covariance, t_s - self.t_s)
        moved: Float = ahead[0]
        return moved

    def observe(self, t_s: float, projection: Float, centre_px: Float, sigma_px: float) -> None:
        """Correct by where one camera, of (3, 4) projection, sees the centre (2,); older pictures than the newest are ignored.

        No gate is hard: the centre may be half hidden, and loses weight in proportion to how far off it is.
        """
        if t_s < self.t_s:
            return
        self._advance(self._state, self._covariance, t_s - self.t_s)
        self.t_s = t_s
        measured = centre_px[None], np.array([sigma_px]), np.ones(1, np.bool_)
        update_joints(self._state, self._covariance, self._alive, projection, *measured, _SOFT_GATE, np.inf, _MAX_SPEED_M_S)

    def _advance(self, state: Float, covariance: Float, dt_s: float) -> None:
        advance_joints(state, covariance, self._alive, dt_s, _ACCELERATION_M_S2, _ACCELERATION_MEMORY_S, _VELOCITY_MEMORY_S)
