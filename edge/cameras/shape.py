"""How long a video is and how large its pictures are, which calibration and other cameras must agree with before it is played."""

import math
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from models.errors import UserError

_AVI_HEAD = struct.Struct("<4s4x4s4s4x4s4s4x16xI12xII")
"""RIFF, AVI, LIST, hdrl, avih, number of pictures, width, height: the first 72 bytes (Microsoft, "AVI RIFF File Reference")."""
_AVI_MARKS = (b"RIFF", b"AVI ", b"LIST", b"hdrl", b"avih")
_SAME_LENGTH = 1e-12
"""Relative difference up to which two lengths are one: rates are decimal fractions, rounded to binary ones."""


@dataclass(frozen=True)
class VideoShape:
    """A video without its pictures; `size_px` is (width, height)."""

    path: Path
    pictures: int
    size_px: tuple[int, int]


def read_avi_shape(path: Path) -> VideoShape | None:
    """What the head of an AVI file says; None if the file does not begin as one. The pictures are not looked at.

    Raises:
        OSError: it cannot be read.
    """
    with path.open("rb") as file:
        head = file.read(_AVI_HEAD.size)
    if len(head) < _AVI_HEAD.size:
        return None
    *marks, pictures, width, height = _AVI_HEAD.unpack(head)
    if tuple(marks) != _AVI_MARKS or not pictures:
        return None
    return VideoShape(path, pictures, (width, height))


def require_calibrated_size(camera: str, shape: VideoShape, calibrated_px: tuple[int, int]) -> None:
    """Pictures of another size would be taken for pixels of the calibrated ones, and every joint would be at a wrong place.

    Raises:
        UserError: the sizes differ.
    """
    if shape.size_px != calibrated_px:
        (width, height), (wanted_width, wanted_height) = shape.size_px, calibrated_px
        raise UserError(
            f"camera '{camera}': the pictures of {shape.path} are {width}x{height}, but the calibration is for "
            f"{wanted_width}x{wanted_height}; scale the video or calibrate this camera at its size"
        )


def require_equal_lengths(videos: Mapping[str, tuple[VideoShape, float]]) -> None:
    """Every camera counts its loops by itself, and fusion compares the counts: with unequal files they would drift apart.

    Args:
        videos: shape and rate in Hz by the camera's name.

    Raises:
        UserError: a file lasts longer or shorter than the first one.
    """
    (first, (reference, reference_hz)), *others = videos.items()
    for camera, (shape, rate_hz) in others:
        if not math.isclose(shape.pictures / rate_hz, reference.pictures / reference_hz, rel_tol=_SAME_LENGTH):
            raise UserError(
                f"camera '{camera}': {shape.path} lasts {_length(shape, rate_hz)}, but that of camera '{first}', "
                f"{reference.path}, {_length(reference, reference_hz)}; cut the videos to one length or correct `rate_hz`"
            )


def _length(shape: VideoShape, rate_hz: float) -> str:
    return f"{shape.pictures / rate_hz:.3f} s ({shape.pictures} pictures at {rate_hz:g} Hz)"
