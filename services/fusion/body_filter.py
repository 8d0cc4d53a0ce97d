"""The body's centre as a whole (eq. 9): position, velocity and acceleration, from which crops are predicted.

Eq. 9 is linear. What makes the filter an extended one is the measurement: each camera's picture of the centre, at its own time.
"""

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

from models.arrays import Float

_JERK2 = 60.0**2
"""Spectral density of the white jerk that drives the model, m^2/s^5: a jump's take-off changes 20 m/s^2 in a tenth of a second."""
_FADE_S = 0.3
"""Acceleration and velocity die with this time constant and twice this while nothing is measured."""


class BodyFilter:
    """The 9-state filter; frame of reference: the world, SI units."""

    def __init__(self, t_s: float, centre_m: Float) -> None:
        self.t_s = t_s
        self._filter = ExtendedKalmanFilter(dim_x=9, dim_z=2)
        self._filter.x = np.concatenate((centre_m, np.zeros(6)))
        self._filter.P = np.diag(np.repeat((0.05**2, 1.0**2, 5.0**2), 3))

    @property
    def state(self) -> Float:
        """(9,) position, velocity, acceleration at `t_s`."""
        return np.array(self._filter.x)

    def at(self, t_s: float) -> Float:
        """(9,) the state predicted to `t_s`, or carried back to it."""
        state: Float = _transition(t_s - self.t_s) @ self._filter.x
        return state

    def observe(self, t_s: float, projection: Float, centre_px: Float, sigma_px: float) -> None:
        """Correct by where one camera, of (3, 4) projection, sees the centre (2,); older pictures than the newest are ignored."""
        if t_s < self.t_s:
            return
        self._filter.F = _transition(t_s - self.t_s)
        self._filter.Q = _noise(t_s - self.t_s)
        self._filter.predict()
        self.t_s = t_s
        pixel, jacobian = _see(projection, self._filter.x)
        residual = centre_px - pixel
        spread = jacobian @ self._filter.P @ jacobian.T + np.eye(2) * sigma_px**2
        distance2 = float(residual @ np.linalg.solve(spread, residual))
        # A robust weight: the centre seen through an occluder is further off than any sigma says.
        noise = sigma_px**2 * max(1.0, distance2 / 6.0)
        self._filter.update(centre_px, lambda _: jacobian, lambda _: pixel, R=noise)


def _transition(dt: float) -> Float:
    fade = float(np.exp(-max(dt, 0.0) / _FADE_S))
    velocity_fade = float(np.exp(-max(dt, 0.0) / (2 * _FADE_S)))
    one = np.array(((1.0, dt, 0.5 * dt * dt), (0.0, velocity_fade, dt), (0.0, 0.0, fade)))
    transition: Float = np.kron(one, np.eye(3))
    return transition


def _noise(dt: float) -> Float:
    one = np.array(((dt**5 / 20, dt**4 / 8, dt**3 / 6), (dt**4 / 8, dt**3 / 3, dt**2 / 2), (dt**3 / 6, dt**2 / 2, dt)))
    noise: Float = np.kron(_JERK2 * one, np.eye(3)).astype(np.float64)
    return noise


def _see(projection: Float, state: Float) -> tuple[Float, Float]:
    """Pixel (2,) of the centre and its Jacobian (2, 9)."""
    u, v, w = projection[:, :3] @ state[:3] + projection[:, 3]
    pixel = np.array((u / w, v / w))
    jacobian = np.zeros((2, 9))
    jacobian[:, :3] = (projection[:2, :3] - np.outer(pixel, projection[2, :3])) / w
    return pixel, jacobian
