"""PNG with a palette, which OpenCV does not write: a third of the size of a picture in full colour.

Format: W3C, "Portable Network Graphics (PNG) Specification", colour type 3.
"""

import struct
import zlib
from typing import Final

import cv2
import numpy as np

from models.arrays import UInt8

_SIGNATURE: Final = b"\x89PNG\r\n\x1a\n"
_SAMPLES: Final = 40_000
_SEED: Final = 1


def encode_indexed(picture: UInt8, colours: int) -> bytes:
    """The PNG of a picture.

    Args:
        picture: (H, W, 3) blue, green, red.
        colours: size of the palette, 2 to 256; its colours are the picture's means (k-means).
    """
    if picture.ndim != 3 or picture.shape[2] != 3 or not 2 <= colours <= 256:
        raise ValueError(f"a picture of shape {picture.shape} cannot have a palette of {colours} colours")
    flat = picture.reshape(-1, 3)
    known = np.unique(flat, axis=0)
    palette = known if len(known) <= colours else _means(flat, colours)
    height, width = picture.shape[:2]
    rows = np.zeros((height, width + 1), np.uint8)  # each row begins with its filter, 0: none
    rows[:, 1:] = _nearest(flat, palette).reshape(height, width)
    header = struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"PLTE", palette[:, ::-1].tobytes()), (b"IDAT", zlib.compress(rows.tobytes(), 9)), (b"IEND", b""))
    return _SIGNATURE + b"".join(_chunk(kind, data) for kind, data in chunks)


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def _means(flat: UInt8, colours: int) -> UInt8:
    """(K, 3) of some of the pixels; the same for the same picture."""
    some = flat[np.random.default_rng(_SEED).integers(len(flat), size=min(_SAMPLES, len(flat)))].astype(np.float32)
    cv2.setRNGSeed(_SEED)
    until = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 20, 0.5)
    _, _, centres = cv2.kmeans(some, colours, np.empty(0, np.int32), until, 1, cv2.KMEANS_PP_CENTERS)
    return np.round(centres).astype(np.uint8)


def _nearest(flat: UInt8, palette: UInt8) -> UInt8:
    """(N,) number of each pixel's nearest colour."""
    out = np.empty(len(flat), np.uint8)
    known = palette.astype(np.float32)
    for first in range(0, len(flat), 1 << 16):
        part = flat[first : first + (1 << 16)].astype(np.float32)
        out[first : first + (1 << 16)] = np.argmin(-2 * part @ known.T + np.sum(known**2, axis=1), axis=1)
    return out
