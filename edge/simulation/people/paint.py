"""The one picture that a pupil is painted with: face, fabric, hair and the print of the shirt, each in its own corner.

The picture darkens and tints; the ground colours are those of the vertices. Everything is drawn by code from a seed.
"""

from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np

from models.arrays import Float, UInt8

SIDE_PX: Final = 512
GUTTER_PX: Final = 6
"""Around each patch, so that the patches do not run into one another when they are seen from afar."""


@dataclass(frozen=True)
class Patch:
    """A rectangle of the picture.

    Attributes:
        left, top, width, height: in pixels.
    """

    left: int
    top: int
    width: int
    height: int

    def uv(self, across: Float, down: Float) -> Float:
        """(V, 2) places in the picture; 0 to 1 spans the patch without its gutter, beyond is its edge."""
        place = [
            (start + GUTTER_PX + np.clip(share, 0, 1) * (size - 2 * GUTTER_PX)) / SIDE_PX
            for start, size, share in ((self.left, self.width, across), (self.top, self.height, down))
        ]
        return np.stack(place, axis=-1)

    def axes(self) -> tuple[Float, Float]:
        """(height, width) across and down of every pixel, as `uv` takes them."""
        across, down = ((np.arange(size) + 0.5 - GUTTER_PX) / (size - 2 * GUTTER_PX) for size in (self.width, self.height))
        grid = np.meshgrid(np.clip(across, 0, 1), np.clip(down, 0, 1))
        return grid[0], grid[1]


FACE: Final = Patch(0, 0, 256, 256)
EYE: Final = Patch(256, 0, 64, 64)
PLAIN: Final = Patch(320, 0, 64, 64)
HAIR: Final = Patch(384, 0, 128, 128)
CLOTH: Final = Patch(256, 128, 256, 128)
PRINT: Final = Patch(0, 256, 512, 256)


def plain_uv(count: int) -> Float:
    """(V, 2) of what is painted with nothing."""
    return PLAIN.uv(np.full(count, 0.5), np.full(count, 0.5))


def cloth_uv(vertices_m: Float, scale: float) -> Float:
    """(V, 2) of plain fabric: folded to and fro over the patch, so that it has no seam."""
    size = 0.45 * scale
    return CLOTH.uv(_to_and_fro((vertices_m[:, 1] + 0.7 * vertices_m[:, 0]) / size), _to_and_fro(vertices_m[:, 2] / size))


def _to_and_fro(value: Float) -> Float:
    return np.abs(np.mod(value, 2.0) - 1.0)


class Picture:
    """The picture while it is painted."""

    def __init__(self, random: np.random.Generator) -> None:
        self._light = np.ones((SIDE_PX, SIDE_PX, 3))
        self._random = random
        self.tint(CLOTH, _wrinkles(random, CLOTH)[..., None] * np.ones(3))
        self.tint(HAIR, _strands(random, HAIR)[..., None] * np.ones(3))
        self.tint(PRINT, _wrinkles(random, PRINT)[..., None] * np.ones(3))

    def tint(self, patch: Patch, light: Float) -> None:
        """Multiply a patch by (height, width, 3)."""
        self._light[patch.top : patch.top + patch.height, patch.left : patch.left + patch.width] *= light

    def finished(self) -> UInt8:
        """(H, W, 3) sRGB."""
        return np.asarray(np.round(255 * np.clip(self._light, 0, 1)), np.uint8)


def _wrinkles(random: np.random.Generator, patch: Patch) -> Float:
    """(height, width) 0.82 to 1: soft creases, more across than down."""
    out = np.zeros((patch.height, patch.width))
    for sigma, share in ((14, 0.6), (5, 0.3), (1.2, 0.12)):
        noise = cv2.GaussianBlur(random.standard_normal((patch.height, patch.width)), (0, 0), 0.7 * sigma, sigmaY=1.5 * sigma)
        out += share * noise / noise.std()
    return np.asarray(1 - 0.05 * np.clip(out + 0.6, 0, 3))


def _strands(random: np.random.Generator, patch: Patch) -> Float:
    """(height, width) 0.7 to 1: lines from the crown down."""
    noise = cv2.GaussianBlur(random.standard_normal((patch.height, patch.width)), (0, 0), 1.3, sigmaY=24)
    return np.asarray(1 - 0.11 * np.clip(noise / noise.std() + 1, 0, 2.7))
