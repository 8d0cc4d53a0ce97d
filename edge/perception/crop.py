"""The square region of a picture that a pose network sees: chosen from a box or a pose, turned with the trunk, cut out."""

import math
from typing import Final, cast

import cv2
import numpy as np

from models.arrays import Bool, Float, UInt8
from models.messages.observation import Crop
from models.skeleton.trunk import lean_rad

REDUCTIONS: Final = (4, 2, 1)
BOX_MARGIN: Final = 1.25
"""Side of the crop over the longer side of a detected box."""
POSE_MARGIN: Final = 1.25
"""Side of the crop over the longer side of the keypoints' extent; their extent ends at the eyes, ankles and wrists."""
_SHORT_TRUNK: Final = 0.08
"""Trunk length over crop side under which its direction says nothing."""


def crop_from_box(box_px: Float, angle_rad: float = 0.0) -> Crop:
    """Crop around a detected box (x0, y0, x1, y1)."""
    x0, y0, x1, y1 = (float(value) for value in box_px)
    return Crop((x0 + x1) / 2, (y0 + y1) / 2, max(1.0, BOX_MARGIN * max(x1 - x0, y1 - y0)), angle_rad)


def crop_from_pose(keypoints_px: Float, confident: Bool, previous: Crop) -> Crop:
    """Crop for the next look, around the confident keypoints and turned with the trunk.

    Args:
        keypoints_px: (17, 2).
        confident: (17,) which of them to believe; at least two.
        previous: the crop that they were seen in; its angle stays if the trunk's direction cannot be told.
    """
    lean = lean_rad(keypoints_px, confident, _SHORT_TRUNK * previous.side_px)
    return Crop.around(keypoints_px[confident], previous.angle_rad if lean is None else lean, POSE_MARGIN)


def blended(old: Crop, new: Crop, share: float) -> Crop:
    """From `old` to `new` by `share` of the way (0 to 1), the angle along the shorter arc: a calm crop is a calm pose."""
    turn = math.remainder(new.angle_rad - old.angle_rad, math.tau)
    return Crop(
        old.centre_x_px + share * (new.centre_x_px - old.centre_x_px),
        old.centre_y_px + share * (new.centre_y_px - old.centre_y_px),
        old.side_px + share * (new.side_px - old.side_px),
        math.remainder(old.angle_rad + share * turn, math.tau),
    )


def reduction_for(side_px: float, network_px: int) -> int:
    """The strongest reduction (4, 2 or 1) in which a crop of that side still has the network's resolution."""
    return next((reduction for reduction in REDUCTIONS if side_px / reduction >= network_px), 1)


def cut(image: UInt8, reduction: int, crop: Crop, network_px: int) -> UInt8:
    """Warp a crop to (network_px, network_px, 3) in one step; black beyond the picture.

    Args:
        image: the picture with its sides divided by `reduction`.
        reduction: see `Frame.image`.
        crop: in pixels of the whole picture.
        network_px: side of the result; the centre of its pixel i is at crop coordinate (i + 0.5) / network_px.
    """
    origin, right, down = crop.to_image(np.array(((0.0, 0.0), (1.0, 0.0), (0.0, 1.0)))) / reduction
    along_x, along_y = (right - origin) / network_px, (down - origin) / network_px
    # Pixel i of a picture reduced by r has its centre at r i + (r - 1) / 2 of the whole one.
    first = origin + (along_x + along_y) / 2 - (reduction - 1) / (2 * reduction)
    to_image = np.column_stack((along_x, along_y, first))
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    return cast(UInt8, cv2.warpAffine(image, to_image, (network_px, network_px), flags=flags, borderMode=cv2.BORDER_CONSTANT))
