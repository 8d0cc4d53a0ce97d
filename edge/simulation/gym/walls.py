"""Walls, ceiling and sky of a gym, painted by code."""

from dataclasses import dataclass
from typing import Final, Literal

import cv2
import numpy as np

from edge.simulation.gym.solids import Colour
from models.arrays import Float, UInt8

_PX_PER_M: Final = 40


@dataclass(frozen=True)
class WallStyle:
    """How walls look.

    Attributes:
        pad: colour of the padding that covers the lower wall.
        upper: colour above it.
        kind: what the upper wall is made of.
        pad_height_m: up to where the padding goes.
    """

    pad: Colour
    upper: Colour
    kind: Literal["brick", "slats", "plaster"]
    pad_height_m: float


def paint_wall(style: WallStyle, length_m: float, height_m: float, random: np.random.Generator) -> UInt8:
    """(H, W, 3) sRGB picture of a wall, first row under the ceiling."""
    height, width = round(height_m * _PX_PER_M), round(length_m * _PX_PER_M)
    up = (height - 0.5 - np.arange(height)) / _PX_PER_M
    along = (np.arange(width) + 0.5) / _PX_PER_M
    light = np.ones((height, width))
    if style.kind == "brick":
        light *= _bricks(up, along, random)
    elif style.kind == "slats":
        light *= np.where(np.mod(up, 0.12) < 0.015, 0.75, 1.0)[:, None] * (1 + 0.03 * random.standard_normal((height, 1)))
    else:
        noise = cv2.GaussianBlur(random.standard_normal((height, width)), (0, 0), 6)
        light *= 1 + 0.02 * noise / noise.std()
    picture = light[..., None] * np.array(style.upper)
    padded = up < style.pad_height_m
    pads = np.ones((height, width))
    pads *= (
        np.where(np.mod(along, 1.2) < 0.03, 0.6, 1.0)[None, :]
        * np.where(np.abs(up - style.pad_height_m / 2) < 0.012, 0.75, 1.0)[:, None]
    )
    pads *= 1 + 0.03 * np.repeat(random.standard_normal(-(-width // 48)), 48)[None, :width]
    picture[padded] = (pads[..., None] * np.array(style.pad))[padded]
    picture[(up >= style.pad_height_m) & (up < style.pad_height_m + 0.08)] = np.array(style.upper) * 0.6
    picture[up < 0.09] = (0.35, 0.30, 0.26)
    corners = 1 - 0.22 * np.exp(-np.minimum(along, along[::-1]) / 0.6)
    heights = (1 - 0.20 * np.exp(-up / 0.4)) * (1 - 0.18 * np.exp(-(height_m - up) / 0.5))
    _posters(picture, style, random)
    picture *= (heights[:, None] * corners[None, :])[..., None]
    return _bytes(picture)


def paint_ceiling(length_m: float, width_m: float, random: np.random.Generator) -> UInt8:
    """(H, W, 3) sRGB picture of a ceiling of boards and beams."""
    scale = 24
    height, width = round(width_m * scale), round(length_m * scale)
    light = np.full((height, width), 0.80)
    light *= 1 + 0.02 * np.repeat(random.standard_normal(-(-height // 4)), 4)[:height, None]
    light[::12] *= 0.85
    light[:, np.mod(np.arange(width), 3 * scale) < 6] *= 0.7
    return _bytes(light[..., None] * np.array((1.0, 0.99, 0.96)))


def paint_sky(random: np.random.Generator) -> UInt8:
    """(H, W, 3) sRGB picture of what is behind a window: clouds above, tree tops below."""
    height, width = 128, 192
    share = np.linspace(0, 1, height)[:, None, None]
    clouds = cv2.GaussianBlur(random.standard_normal((height, width)), (0, 0), 18, sigmaY=8)
    clouds = np.clip(0.5 + clouds / clouds.std() / 3, 0, 1)[..., None]
    sky = (1 - clouds) * np.array((0.72, 0.84, 0.97)) + clouds * np.array((0.97, 0.98, 0.99))
    trees = cv2.GaussianBlur(random.standard_normal((1, width)), (0, 0), 9)[0]
    edge = 0.86 + 0.05 * trees / trees.std()
    trees_there = np.clip((share - edge[None, :, None]) * 40 + 0.5, 0, 1)
    return _bytes((1 - trees_there) * sky + trees_there * np.array((0.42, 0.52, 0.40)))


def _bricks(up: Float, along: Float, random: np.random.Generator) -> Float:
    high, long = 0.115, 0.25
    row = np.floor(up / high).astype(int)
    place = along[None, :] + 0.5 * long * (row % 2)[:, None]
    column = np.floor(place / long).astype(int)
    tones = 1 + 0.035 * random.standard_normal((int(row.max()) + 1, int(column.max()) + 1))
    joint = (np.mod(up, high) < 0.013)[:, None] | (np.mod(place, long) < 0.013)
    return np.where(joint, 0.90, tones[row[:, None], column])


def _posters(picture: Float, style: WallStyle, random: np.random.Generator) -> None:
    """Sheets with coloured blocks over the padding, where people look."""
    height, width = picture.shape[:2]
    for _ in range(int(random.integers(1, 5))):
        wide, high = int(random.integers(20, 44)), int(random.integers(24, 40))
        left = int(random.integers(60, max(width - 60 - wide, 61)))
        top = height - round((style.pad_height_m + 0.25) * _PX_PER_M) - high
        sheet = picture[max(top, 0) : top + high, left : left + wide]
        sheet[:] = random.uniform(0.8, 0.97)
        for _ in range(4):
            y, x = int(random.integers(max(len(sheet) - 8, 1))), int(random.integers(wide - 10))
            sheet[y : y + int(random.integers(3, 9)), x : x + int(random.integers(6, 20))] = random.uniform(0.1, 0.9, 3)


def _bytes(picture: Float) -> UInt8:
    return np.asarray(np.clip(np.round(255 * picture), 0, 255), np.uint8)
