"""Where the pupil stands, how he is turned, how tall he is and which side he leads with: taken out, so that motions compare.

What is compared lies in the canonical frame of `models.teaching.standard`: right-handed, x to where the pupil looked as he began,
y to his left, z up from the floor; the middle of the hips always above the origin; as large as the standard; leading with the
right side.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.motions.motion import Handed
from models.skeleton import coco
from services.evaluation.track import Track

_LEFT_SHOULDER, _RIGHT_SHOULDER, _LEFT_HIP, _RIGHT_HIP = coco.TRUNK
_MIRROR: Final = list(coco.MIRROR)
MIRROR_FLIP: Final = np.array((1.0, -1.0, 1.0))
"""What a point is multiplied with to lie in the mirror y = 0."""
UPRIGHT: Final = 0.5
"""How far up the trunk must point, as the cosine of its inclination, for its turn about the vertical to be told."""
BEGINNING_S: Final = 0.3
"""The pupil's heading is that of so much of an attempt, from when it is first seen. Colours need it seen no later than that, too:
nobody knows how far he has turned by then."""
_ROUNDED_S: Final = 1e-6
_CHAIN: Final = (("hip", "shoulder"), ("knee", "hip"), ("ankle", "knee"))
_SIDES: Final = ("left", "right")


class PlacingError(ValueError):
    """Why a motion cannot be brought into the canonical frame, in words that go on after its name."""


@dataclass(frozen=True)
class Placing:
    """How a motion is brought into the canonical frame: turned by -`heading_rad` about the vertical, then scaled.

    Attributes:
        heading_rad: to where the pupil looked in the world, from x to y.
        scale: canonical metres a metre of the world.
        frames: of which the heading is the mean.
    """

    heading_rad: float
    scale: float
    frames: tuple[int, ...]

    @property
    def matrix(self) -> Float:
        """(3, 3) what a difference of places in the world is multiplied with; covariances from both sides."""
        sine, cosine = np.sin(self.heading_rad), np.cos(self.heading_rad)
        return self.scale * np.array(((cosine, sine, 0.0), (-sine, cosine, 0.0), (0.0, 0.0, 1.0)))


def mirrored(joints: Float) -> Float:
    """(..., 17, 3) points in the mirror y = 0: left does what right did."""
    return np.asarray(joints[..., _MIRROR, :] * MIRROR_FLIP)


def lead_right(track: Track, handed: Handed) -> Track:
    """The track, mirrored in the plane y = 0 of the world if the left side leads: then the leading side is the right one."""
    if handed == "right":
        return track
    covariance = track.covariance_m2[:, _MIRROR] * np.outer(MIRROR_FLIP, MIRROR_FLIP)
    return Track(track.t_s, mirrored(track.joints_m), covariance, track.states[:, _MIRROR])


def root_m(joints_m: Float) -> Float:
    """(..., 3) the middle of the hips of (..., 17, 3) points; NaN where one is unknown."""
    return np.asarray((joints_m[..., _LEFT_HIP, :] + joints_m[..., _RIGHT_HIP, :]) / 2)


def facing(joints_m: Float) -> Float:
    """(..., 2) unit vectors in the floor to where a pupil looks, by the lines of shoulders and hips.

    Args:
        joints_m: (..., 17, 3).

    Returns:
        NaN where the trunk is not upright (`UPRIGHT`), or not known.
    """
    left, right = (joints_m[..., pair, :].sum(axis=-2) for pair in ((_LEFT_SHOULDER, _LEFT_HIP), (_RIGHT_SHOULDER, _RIGHT_HIP)))
    across = left - right
    trunk = joints_m[..., (_LEFT_SHOULDER, _RIGHT_SHOULDER), :].sum(axis=-2) - 2 * root_m(joints_m)
    ahead = np.stack((across[..., 1], -across[..., 0]), axis=-1)
    length = np.linalg.norm(ahead, axis=-1, keepdims=True)
    with np.errstate(invalid="ignore", divide="ignore"):
        upright = trunk[..., 2:] > UPRIGHT * np.linalg.norm(trunk, axis=-1, keepdims=True)
        return np.where(upright & (length > 0), ahead / length, np.nan)


def size_m(joints_m: Float) -> float:
    """How large a body is: shoulder to hip to knee to ankle, the median over the frames of (T, 17, 3); NaN if it is not seen."""
    total = 0.0
    for upper, lower in _CHAIN:
        lengths = [
            np.linalg.norm(joints_m[:, coco.INDEX[f"{side}_{upper}"]] - joints_m[:, coco.INDEX[f"{side}_{lower}"]], axis=-1)
            for side in _SIDES
        ]
        known = np.concatenate(lengths)
        known = known[np.isfinite(known)]
        total += float(np.median(known)) if len(known) else np.nan
    return total


def placing_of(
    joints_m: Float, frame_s: float, to_size_m: float, seen_within_s: float = BEGINNING_S, vouched: Bool | None = None
) -> Placing:
    """How to bring (T, 17, 3) joints into the canonical frame of a body of size `to_size_m`.

    Args:
        joints_m: from the beginning of an attempt, or from shortly before it.
        frame_s: from one frame to the next.
        to_size_m: canonical metres from shoulder to ankle.
        seen_within_s: by when it must be seen to where he looks; infinite where it need be known only roughly.
        vouched: (T,) in which frames the trunk was seen, and not only guessed; None for all. The heading is of such frames alone,
            unless there is none by then.

    Raises:
        PlacingError: they do not show how large he is, or not early enough to where he looks.
    """
    size = size_m(joints_m)
    if not size > 0:
        raise PlacingError("does not show how large the pupil is: his trunk, thigh or shank is never seen from end to end")
    times_s = np.arange(len(joints_m)) * frame_s
    early = times_s <= seen_within_s + _ROUNDED_S
    ahead = facing(joints_m)
    known = np.isfinite(ahead[:, 0])
    if not (known & early).any():
        raise PlacingError(_why_it_is_not_known(joints_m[early], seen_within_s))
    if vouched is not None and (known & early & vouched).any():
        known &= vouched
    frames = np.flatnonzero(known & (times_s <= times_s[known.argmax()] + BEGINNING_S + _ROUNDED_S))
    x, y = ahead[frames].mean(axis=0)
    return Placing(float(np.arctan2(y, x)), to_size_m / size, tuple(frames.tolist()))


def _why_it_is_not_known(joints_m: Float, within_s: float) -> str:
    """To where a pupil looks whose (T, 17, 3) joints in the beginning do not show it; see `PlacingError`."""
    when = f" in its first {within_s:g} s" if np.isfinite(within_s) else ""
    if np.isfinite(joints_m[:, coco.TRUNK]).all(axis=(1, 2)).any():
        return f"does not show the pupil standing upright{when}"
    return f"does not show both shoulders and both hips at once{when}, and so not to where the pupil looks"


def placed(joints_m: Float, placing: Placing) -> Float:
    """(T, 17, 3) joints in the canonical frame, the middle of the hips above the origin in every frame."""
    centre = root_m(joints_m) * np.array((1.0, 1.0, 0.0))
    return np.asarray((joints_m - centre[..., None, :]) @ placing.matrix.T)
