"""What fusion asks of one camera (fusion -> edge): how often, with which network, and where to look."""

import math
from typing import Literal

import msgspec

from models.messages.observation import MAX_PX, Crop, require_count

PoseNetwork = Literal["thunder", "lightning"]
MAX_RATE_HZ = 1000.0
CARRIED_S = 0.5
"""A crop is carried no further than this from its own time."""


class CropPrediction(msgspec.Struct, frozen=True):
    """Where fusion expects the pupil, with its motion, so that the edge can carry it to a frame's own time.

    The crop has at least one pixel, and wherever it is carried, the pose that is seen in it and the crop around that stay within
    `MAX_PX`: otherwise looking there would lead to an observation that is none.
    """

    crop: Crop
    t_ns: int
    velocity_x_px_s: float
    velocity_y_px_s: float

    def __post_init__(self) -> None:
        crop = self.crop
        speed_px_s = math.hypot(self.velocity_x_px_s, self.velocity_y_px_s)
        # The crop around a pose in a crop is less than twice as large.
        reach_px = max(abs(crop.centre_x_px), abs(crop.centre_y_px)) + 2 * crop.side_px + CARRIED_S * speed_px_s
        if not (crop.side_px >= 1 and reach_px <= MAX_PX):
            raise ValueError(f"a prediction needs a crop of at least 1 px that stays within +-{MAX_PX:g} px, not {self}")

    def at(self, t_ns: int) -> Crop:
        """The crop carried at constant velocity to `t_ns` (CLOCK_MONOTONIC), at most `CARRIED_S` from its own time."""
        seconds = (t_ns - self.t_ns) * 1e-9
        return Crop(
            self.crop.centre_x_px + self.velocity_x_px_s * seconds,
            self.crop.centre_y_px + self.velocity_y_px_s * seconds,
            self.crop.side_px,
            self.crop.angle_rad,
        )


class ViewControl(msgspec.Struct, frozen=True):
    """The governor's plan and the view selection's for one camera.

    A frame is due for inference when floor((t_mid - offset) * rate) differs from that of the last one inferred, so that
    cameras with different offsets take turns without talking to one another.

    Attributes:
        rate_hz: inferences a second on new frames; 0 leaves the camera idle.
        offset_ns: this camera's place in the turn.
        network: pose network to run.
        search: look at every person found, because the pupil is not chosen yet; otherwise only at `prediction`.
        prediction: None when the pupil's place is not known.
    """

    camera: str
    sequence: int
    t_ns: int
    rate_hz: float
    offset_ns: int
    network: PoseNetwork
    search: bool
    prediction: CropPrediction | None

    def __post_init__(self) -> None:
        for field in ("sequence", "t_ns"):
            require_count(field, getattr(self, field))
        if not abs(self.offset_ns) < 2**63:
            raise ValueError(f"offset_ns must be within +-(2^63 - 1), not {self.offset_ns}")
        if not 0 <= self.rate_hz <= MAX_RATE_HZ:
            raise ValueError(f"rate_hz must be within 0 and {MAX_RATE_HZ:g}, not {self.rate_hz}")
