"""What a method makes of a clip, whoever's it is, and the clip itself."""

from dataclasses import dataclass

from models.arrays import Float
from models.camera.rig import Rig


@dataclass(frozen=True, eq=False)
class Keypoints:
    """One person's keypoints in frames of all cameras, as offline systems take them.

    Attributes:
        rig: calibration; the cameras have neither distortion nor shift, so that nobody is charged for undistorting.
        points_px: (frames, cameras, 17, 2); NaN where a camera has nobody.
        scores: (frames, cameras, 17).
        rate_hz: frames a second.
        scale: full resolution over the resolution of the keypoints; the peers' thresholds are in full-resolution pixels.
    """

    rig: Rig
    points_px: Float
    scores: Float
    rate_hz: float
    scale: float = 1.0

    def __len__(self) -> int:
        return len(self.points_px)


@dataclass(frozen=True, eq=False)
class Answer:
    """A method's joints for one clip.

    Attributes:
        method: "<who>.<setting>".
        joints_m: (frames, 17, 3) in the world frame; NaN where the method says nothing.
        cpu_ms, wall_ms: a frame, from keypoints to these joints; reading and writing files for a peer is not counted.
    """

    method: str
    joints_m: Float
    cpu_ms: float
    wall_ms: float
