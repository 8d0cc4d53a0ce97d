"""Small pictures and videos for tests, drawn by the tests themselves."""

from fractions import Fraction
from pathlib import Path

import numpy as np

from edge.cameras.video import Video
from edge.footage.transcode import encode_jpeg, write_motion_jpeg
from models.arrays import Float, UInt8

SIZE_PX = (160, 96)


def plain_picture(level: int, size_px: tuple[int, int] = SIZE_PX) -> UInt8:
    """A grey picture (h, w, 3)."""
    return np.full((size_px[1], size_px[0], 3), level, np.uint8)


def spot_picture(centre_px: Float, sigma_px: float, size_px: tuple[int, int]) -> UInt8:
    """A bright Gaussian spot on black, (h, w, 3)."""
    y, x = np.mgrid[: size_px[1], : size_px[0]]
    spot = 255 * np.exp(-((x - centre_px[0]) ** 2 + (y - centre_px[1]) ** 2) / (2 * sigma_px**2))
    return np.repeat(spot[..., None], 3, axis=2).round().astype(np.uint8)


def write_video(path: Path, frames: int = 10, size_px: tuple[int, int] = SIZE_PX) -> Path:
    """A Motion JPEG file whose picture k has the grey level 20 k."""
    write_motion_jpeg(path, (plain_picture(20 * k, size_px) for k in range(frames)), Fraction(30))
    return path


def video_of(pictures: list[UInt8], camera: str = "cam01", quality: int = 90) -> Video:
    """Pictures as a loaded video."""
    height, width = pictures[0].shape[:2]
    jpegs = tuple(encode_jpeg(np.ascontiguousarray(picture[..., ::-1]), quality) for picture in pictures)
    return Video(camera, (width, height), jpegs)
