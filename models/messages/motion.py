"""The reconstructed movement at one instant (fusion -> evaluation, tablet, recorder)."""

from enum import IntEnum
from typing import Literal

import msgspec
import numpy as np

from models.arrays import Float32, UInt8, UInt32
from models.messages.observation import require_array, require_count
from models.skeleton import coco


class JointState(IntEnum):
    """How much a joint's position may be believed. Only `SEEN` may ever be coloured other than grey."""

    UNKNOWN = 0
    """No position: the coordinates are zero and mean nothing."""
    GUESSED = 1
    """Carried by the filter or by fewer than two agreeing views."""
    SEEN = 2
    """Two or more views agreed on it recently enough."""


class CameraUse(msgspec.Struct, frozen=True):
    """What one camera contributed. `age_ms` is the age of its newest observation at the motion's instant; NaN if none."""

    camera: str
    used: bool
    age_ms: float


class Motion(msgspec.Struct, frozen=True, eq=False):
    """The pupil at one instant, in the world frame.

    Attributes:
        kind: "live" (for the eye, lag at most two frames) or "smooth" (fixed lag, for evaluation and recording).
        sequence: counts the messages of this kind.
        epoch: see `Observation.epoch`.
        t_ns: CLOCK_MONOTONIC of the instant described.
        t_newest_ns: mid-exposure of the newest observation used.
        t_published_ns: CLOCK_MONOTONIC when it was handed to the bus.
        joints_m: (17, 3) COCO keypoints, metres.
        covariance_m2: (17, 3, 3) their covariance, square metres.
        states: (17,) `JointState`.
        views: (17,) bit i set if camera i of `cameras` was an inlier for the joint.
        cameras: one entry a camera of the rig, in the rig's order.
    """

    kind: Literal["live", "smooth"]
    sequence: int
    epoch: int
    t_ns: int
    t_newest_ns: int
    t_published_ns: int
    joints_m: Float32
    covariance_m2: Float32
    states: UInt8
    views: UInt32
    cameras: tuple[CameraUse, ...]

    def __post_init__(self) -> None:
        for field in ("sequence", "epoch", "t_ns", "t_newest_ns", "t_published_ns"):
            require_count(field, getattr(self, field))
        require_array("joints_m", self.joints_m, (coco.COUNT, 3))
        require_array("covariance_m2", self.covariance_m2, (coco.COUNT, 3, 3))
        require_array("states", self.states, (coco.COUNT,), np.uint8)
        if self.states.max() > JointState.SEEN:
            raise ValueError(f"states must be within 0 and {JointState.SEEN:d}, not {self.states.max()}")
        require_array("views", self.views, (coco.COUNT,), np.uint32)
