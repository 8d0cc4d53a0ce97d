"""Motion JPEG pictures, as files and UVC cameras deliver them: decoded only when they are looked at."""

from dataclasses import dataclass
from typing import cast

import cv2
import numpy as np

from edge.cameras.source import PictureError
from models.arrays import UInt8

# OpenCV has no name for a reduced RGB picture; its flags combine so.
_FLAGS = {
    1: cv2.IMREAD_COLOR_RGB,
    2: cv2.IMREAD_REDUCED_GRAYSCALE_2 | cv2.IMREAD_COLOR_RGB,
    4: cv2.IMREAD_REDUCED_GRAYSCALE_4 | cv2.IMREAD_COLOR_RGB,
    8: cv2.IMREAD_REDUCED_GRAYSCALE_8 | cv2.IMREAD_COLOR_RGB,
}
_START, _END = b"\xff\xd8", b"\xff\xd9"


@dataclass(frozen=True)
class JpegFrame:
    """A grabbed JPEG picture. See `edge.cameras.source.Frame`."""

    camera: str
    epoch: int
    index: int
    t_mid_ns: int
    size_px: tuple[int, int]
    data: bytes

    def image(self, reduction: int = 1) -> UInt8:
        """The picture as RGB, reduced while it is decoded, which saves up to half the work. See `Frame.image`."""
        width, height = (-(-side // reduction) for side in self.size_px)
        picture = _decoded(self.data, _FLAGS[reduction])
        # Damage to the size goes unnoticed, and a crop would be cut out at the wrong place.
        if picture is None or picture.shape != (height, width, 3):
            raise PictureError(f"camera '{self.camera}': picture {self.index} is damaged")
        return picture


def is_whole(data: bytes) -> bool:
    """Whether a JPEG has its beginning and its end; OpenCV would fill a missing rest with grey and say nothing."""
    # A muxer may pad packets to an even length.
    return data.startswith(_START) and data[-8:].rstrip(b"\x00").endswith(_END)


def _decoded(data: bytes, flags: int) -> UInt8 | None:
    """A picture; None if it is none."""
    if not is_whole(data):
        return None
    try:
        return cast("UInt8 | None", cv2.imdecode(np.frombuffer(data, np.uint8), flags))
    except cv2.error:  # Of a size that was damaged, for which there is no memory.
        return None
