"""What one camera saw in one frame (edge -> fusion)."""

import math

import msgspec
import numpy as np

from models.arrays import Float, Float32
from models.skeleton import coco

MAX_PX = 1e6
"""No picture is larger; what lies beyond is no observation but a mistake."""


class Crop(msgspec.Struct, frozen=True):
    """A square region of a camera's picture that is handed to the pose network.

    `angle_rad` turns the square: 0 is upright, positive turns its up direction clockwise on the screen (towards +x), so that the
    trunk of a person who leans by that angle points up in the crop.
    """

    centre_x_px: float
    centre_y_px: float
    side_px: float
    angle_rad: float = 0.0

    def __post_init__(self) -> None:
        values = (self.centre_x_px, self.centre_y_px, self.side_px, self.angle_rad)
        if not all(math.isfinite(value) and abs(value) <= MAX_PX for value in values) or self.side_px <= 0:
            raise ValueError(f"a crop needs finite numbers within +-{MAX_PX:g} and a positive side, not {values}")

    @classmethod
    def around(cls, points_px: Float, angle_rad: float, margin: float, least_side_px: float = 1.0) -> "Crop":
        """The square turned by `angle_rad` around points (n, 2), its side `margin` times their larger extent along its axes.

        Raises:
            ValueError: as for any crop, if the points lie too far out.
        """
        upright = cls(0.0, 0.0, 1.0, angle_rad)
        local = upright.to_crop(points_px)
        low, high = local.min(axis=0), local.max(axis=0)
        centre = upright.to_image((low + high) / 2)
        return cls(float(centre[0]), float(centre[1]), max(least_side_px, margin * float((high - low).max())), angle_rad)

    def to_image(self, points: Float) -> Float:
        """Crop coordinates (..., 2) in [0, 1] (x right, y down) to image pixels (..., 2)."""
        local = (np.asarray(points, np.float64) - 0.5) * self.side_px
        return local @ self._rotation().T + (self.centre_x_px, self.centre_y_px)

    def to_crop(self, points_px: Float) -> Float:
        """Image pixels (..., 2) to crop coordinates (..., 2) in [0, 1]: the inverse of `to_image`."""
        local = (np.asarray(points_px, np.float64) - (self.centre_x_px, self.centre_y_px)) @ self._rotation()
        return local / self.side_px + 0.5

    def _rotation(self) -> Float:
        c, s = math.cos(self.angle_rad), math.sin(self.angle_rad)
        return np.array(((c, -s), (s, c)))


class Person(msgspec.Struct, frozen=True, eq=False):
    """One person in one picture.

    Attributes:
        track: identity of the person within this camera; a new number when the track was lost.
        crop: the region that the pose network saw.
        keypoints_px: (17, 2) COCO keypoints in image pixels as observed (distorted), pixel centres at whole numbers;
            finite even where the network guesses, so read them together with `score`.
        sigma_px: (17,) one standard deviation per axis in image pixels.
        score: (17,) the network's confidence in [0, 1].
    """

    track: int
    crop: Crop
    keypoints_px: Float32
    sigma_px: Float32
    score: Float32

    def __post_init__(self) -> None:
        require_array("keypoints_px", self.keypoints_px, (coco.COUNT, 2))
        require_array("sigma_px", self.sigma_px, (coco.COUNT,))
        require_array("score", self.score, (coco.COUNT,))
        if np.abs(self.keypoints_px).max() > MAX_PX or self.sigma_px.max() > MAX_PX or self.sigma_px.min() <= 0:
            raise ValueError(f"keypoints_px must be within +-{MAX_PX:g} and sigma_px within (0, {MAX_PX:g}]")
        if self.score.min() < 0 or self.score.max() > 1:
            raise ValueError("score must be within [0, 1]")


class Observation(msgspec.Struct, frozen=True, eq=False):
    """Everything that fusion learns from one inference of one camera.

    Attributes:
        camera: the camera's name.
        epoch: counts the loops of a source; no estimate may be carried over its change.
        sequence: counts the observations of this edge process.
        frame: index of the picture in its source within the epoch.
        t_mid_ns: CLOCK_MONOTONIC at mid-exposure.
        t_published_ns: CLOCK_MONOTONIC when it was handed to the bus.
        network: name of the pose network that ran.
        persons: the people that were looked at, best first; empty if nobody was found.
    """

    camera: str
    epoch: int
    sequence: int
    frame: int
    t_mid_ns: int
    t_published_ns: int
    network: str
    persons: tuple[Person, ...]

    def __post_init__(self) -> None:
        for field in ("epoch", "sequence", "frame", "t_mid_ns", "t_published_ns"):
            require_count(field, getattr(self, field))


def require_count(field: str, value: int) -> None:
    """Raise ValueError unless `value`, a time in nanoseconds or a number that counts, is within 0 and 2^63 - 1."""
    if not 0 <= value < 2**63:
        raise ValueError(f"{field} must be within 0 and 2^63 - 1, not {value}")


def require_array(field: str, value: object, shape: tuple[int, ...], dtype: type[np.generic] = np.float32) -> None:
    """Raise ValueError unless `value` is a finite numpy array of that shape and dtype."""
    if not isinstance(value, np.ndarray) or value.shape != shape or value.dtype != dtype:
        found = f"{value.dtype} {value.shape}" if isinstance(value, np.ndarray) else type(value).__name__
        raise ValueError(f"{field} must be an array of {np.dtype(dtype)} {shape}, not {found}")
    if value.dtype.kind == "f" and not np.isfinite(value).all():
        raise ValueError(f"{field} contains a value that is not finite")
