"""A Kalman filter for each joint, fed by single 2D points at their own times.

State of a joint: position, velocity and acceleration in the world. Acceleration is a first-order Markov process (Singer 1970,
"Estimating optimal tracking filter performance for manned maneuvering targets") and velocity dies away as well, so that a joint
that nothing confirms comes to rest: an undamped one was seen to run off by 2.5 m.
"""

from dataclasses import dataclass

import numpy as np

from models.arrays import Bool, Float
from models.skeleton import coco
from services.fusion.config import FilterConfig
from services.fusion.singer import advance_joints, expect_joints, update_joints

STATES = 9
"""Position, velocity, acceleration, three coordinates each."""


@dataclass(frozen=True, eq=False)
class Innovation:
    """What one picture did to the filters.

    Attributes:
        distance2: (17,) squared innovation in sigmas; NaN where there was nothing to compare.
        used: (17,) the measurement passed the gate.
    """

    distance2: Float
    used: Bool


class JointFilter:
    """17 filters that stand at one time.

    Attributes:
        t_s: the time.
        state: (17, 9) metres, m/s, m/s^2.
        covariance: (17, 9, 9).
        alive: (17,) whether the filter holds an estimate.
    """

    def __init__(self, t_s: float) -> None:
        self.t_s = t_s
        self.state: Float = np.zeros((coco.COUNT, STATES))
        self.covariance: Float = np.zeros((coco.COUNT, STATES, STATES))
        self.alive: Bool = np.zeros(coco.COUNT, np.bool_)

    def copy(self) -> "JointFilter":
        """An independent filter in the same state."""
        twin = JointFilter.__new__(JointFilter)
        twin.t_s, twin.state, twin.covariance, twin.alive = self.t_s, self.state.copy(), self.covariance.copy(), self.alive.copy()
        return twin

    def seed(self, joint: int, point_m: Float, covariance_m2: Float, config: FilterConfig) -> None:
        """Start a joint at a position (3,) with covariance (3, 3), of unknown velocity."""
        acceleration = config.acceleration_m_s2[joint]
        self.state[joint] = 0.0
        self.state[joint, :3] = point_m
        self.covariance[joint] = 0.0
        self.covariance[joint, :3, :3] = covariance_m2
        speed_sigma = 0.15 * acceleration
        self.covariance[joint, 3:6, 3:6] = np.eye(3) * speed_sigma**2
        self.covariance[joint, 6:, 6:] = np.eye(3) * acceleration**2
        self.alive[joint] = True

    def exchange(self, mask: Bool) -> None:
        """Exchange left and right of the flagged joints (17,)."""
        order = np.where(mask, coco.MIRROR, np.arange(coco.COUNT))
        self.state, self.covariance, self.alive = self.state[order], self.covariance[order], self.alive[order]

    def advance(self, t_s: float, config: FilterConfig) -> None:
        """Predict to a later time; an earlier one is ignored."""
        if t_s > self.t_s:
            advance_joints(
                self.state,
                self.covariance,
                self.alive,
                t_s - self.t_s,
                config.acceleration_m_s2,
                config.acceleration_memory_s,
                config.velocity_memory_s,
            )
            self.t_s = t_s

    def update(self, projection: Float, points_px: Float, sigma_px: Float, usable: Bool, config: FilterConfig) -> Innovation:
        """Correct by one picture's points (17, 2), taken at this filter's time with the camera's (3, 4) projection."""
        return Innovation(
            *update_joints(
                self.state,
                self.covariance,
                self.alive,
                projection,
                points_px,
                sigma_px,
                usable,
                config.soft_gate,
                config.hard_gate,
                config.max_speed_m_s,
            )
        )

    def expect(self, projection: Float) -> "Expectation":
        """What a camera with this (3, 4) projection should see at this filter's time."""
        return Expectation(*expect_joints(self.state, self.covariance, self.alive, projection))


@dataclass(frozen=True, eq=False)
class Expectation:
    """The joints as one camera should see them.

    Attributes:
        points_px: (17, 2) undistorted pixels.
        variance_px2: (17,) mean variance over the two axes.
        px_per_m: (17,) how large a metre is there, across the line of sight.
        known: (17,) whether the joint is estimated and in front of the camera.
    """

    points_px: Float
    variance_px2: Float
    px_per_m: Float
    known: Bool
