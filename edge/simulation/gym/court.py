"""The floor of a school gym: wood, and on it the lines of basketball, volleyball and badminton in their real sizes.

Sources: FIBA, "Official Basketball Rules", article 2 (court, free-throw line 5.80 m from the end line, restricted area 4.90 m
wide, three-point line 6.75 m from the point below the ring, which is 1.575 m from the end line, circles of 1.80 m, lines of
5 cm); FIVB, "Official Volleyball Rules", rule 1 (18 by 9 m, attack lines 3 m from the centre line, lines of 5 cm); BWF, "Laws of
Badminton", law 1 (13.40 by 6.10 m, singles 5.18 m, short service lines 1.98 m from the net, long service line of doubles 0.76 m
inside, lines of 4 cm). A hall that is shorter than a basketball court has a shorter one, as halls of schools do; all else on it
keeps its size. Lines are measured as those rules do: to their outer edges, but the border of the basketball court to its inner one.
"""

from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np

from edge.simulation.gym.solids import Colour
from models.arrays import Float, UInt8

PX_PER_M: Final = 100
BASKET_FROM_END_M: Final = 1.575
_SHIFT: Final = 4
_STRIP_M: Final = 0.07
_PLANK_M: Final = 0.45


@dataclass(frozen=True)
class Court:
    """What a floor looks like.

    Attributes:
        length_m: of the hall, along x.
        width_m: along y.
        wood: colour of the floor.
        basketball, volleyball, badminton: colours of the lines.
    """

    length_m: float
    width_m: float
    wood: Colour
    basketball: Colour
    volleyball: Colour
    badminton: Colour

    @property
    def basketball_half_m(self) -> tuple[float, float]:
        """Half length and half width of the basketball court."""
        return min(28.0, self.length_m - 2.0) / 2, min(15.0, self.width_m - 1.4) / 2


def paint_floor(court: Court, random: np.random.Generator) -> UInt8:
    """(H, W, 3) sRGB picture of the floor from above: x to the right, y up, `PX_PER_M`."""
    lines = np.zeros((round(court.width_m * PX_PER_M), round(court.length_m * PX_PER_M)), np.uint8)
    floor = _wood(lines.shape, court.wood, random)
    for draw, colour in ((_volleyball, court.volleyball), (_badminton, court.badminton), (_basketball, court.basketball)):
        lines[:] = 0
        pen = _Pen(lines, court)
        draw(pen, court)
        share = np.asarray(lines[..., None] * np.float32(0.88 / 255))
        floor = floor * (1 - share) + share * np.asarray(colour, np.float32)
    floor *= _dim_at_walls(lines.shape)[..., None]
    return np.asarray(np.clip(np.round(255 * floor), 0, 255), np.uint8)


class _Pen:
    """Draws lines whose middle is given in metres of the world."""

    def __init__(self, canvas: UInt8, court: Court) -> None:
        self._canvas = canvas
        self._corner = np.array((-court.length_m / 2, court.width_m / 2))

    def line(self, start_m: tuple[float, float], end_m: tuple[float, float], wide_m: float) -> None:
        """A straight line with square ends that reach over its own half width."""
        start, end = np.array(start_m), np.array(end_m)
        along = (end - start) / np.linalg.norm(end - start) * wide_m / 2
        aside = np.array((-along[1], along[0]))
        corners = np.stack((start - along - aside, end + along - aside, end + along + aside, start - along + aside))
        cv2.fillConvexPoly(self._canvas, self._fixed(corners), 255, cv2.LINE_AA, _SHIFT)

    def rectangle(self, low_m: tuple[float, float], high_m: tuple[float, float], wide_m: float) -> None:
        """Four lines, their outer edges on the rectangle."""
        (x0, y0), (x1, y1), half = low_m, high_m, wide_m / 2
        x0, y0, x1, y1 = x0 + half, y0 + half, x1 - half, y1 - half
        for start, end in (((x0, y0), (x1, y0)), ((x1, y0), (x1, y1)), ((x1, y1), (x0, y1)), ((x0, y1), (x0, y0))):
            self.line(start, end, wide_m)

    def arc(self, centre_m: tuple[float, float], radius_m: float, from_deg: float, to_deg: float, wide_m: float) -> None:
        """Part of a circle; `radius_m` to the middle of the line."""
        reach = radius_m + wide_m
        left, top = np.floor(self._pixels(np.array((centre_m[0] - reach, centre_m[1] + reach)))).astype(int).clip(0)
        right, bottom = np.ceil(self._pixels(np.array((centre_m[0] + reach, centre_m[1] - reach)))).astype(int) + 1
        window = self._canvas[top:bottom, left:right]
        x0, y0 = self._pixels(np.asarray(centre_m))
        x, y = np.arange(left, left + window.shape[1]) - x0, y0 - np.arange(top, top + window.shape[0])
        off = np.abs(np.hypot(x[None], y[:, None]) - radius_m * PX_PER_M)
        ink = np.clip(wide_m / 2 * PX_PER_M - off + 0.5, 0, 1)
        angle = np.degrees(np.arctan2(y[:, None], x[None]))
        ink[np.mod(angle - from_deg, 360) > to_deg - from_deg] = 0
        np.maximum(window, np.round(255 * ink).astype(np.uint8), out=window)

    def _fixed(self, points_m: Float) -> np.ndarray:
        return np.asarray(np.round(self._pixels(points_m) * 2**_SHIFT), np.int32)

    def _pixels(self, points_m: Float) -> Float:
        return np.asarray((points_m - self._corner) * (PX_PER_M, -PX_PER_M) - 0.5)


def _basketball(pen: _Pen, court: Court) -> None:
    wide = 0.05
    half_x, half_y = court.basketball_half_m
    pen.rectangle((-half_x - wide, -half_y - wide), (half_x + wide, half_y + wide), wide)
    pen.line((0, -half_y), (0, half_y), wide)
    pen.arc((0, 0), 1.80 - wide / 2, 0, 360, wide)
    for side in (1, -1):
        basket, free = half_x - BASKET_FROM_END_M, half_x - 5.80
        pen.rectangle(*_ordered((side * free, -2.45), (side * (half_x + wide), 2.45)), wide)
        turn = 0 if side == 1 else 180
        pen.arc((side * (free + wide / 2), 0), 1.80 - wide / 2, turn + 90, turn + 270, wide)
        straight_y = min(half_y - 0.90, 6.60)
        reach = 6.75 - wide / 2
        bend = float(np.sqrt(max(reach**2 - (straight_y - wide / 2) ** 2, 0.0)))
        for other in (1, -1):
            y = other * (straight_y - wide / 2)
            pen.line((side * half_x, y), (side * (basket - bend), y), wide)
        half_angle = float(np.degrees(np.arctan2(straight_y - wide / 2, bend)))
        pen.arc((side * basket, 0), reach, turn + 180 - half_angle, turn + 180 + half_angle, wide)
        pen.arc((side * basket, 0), 1.25 + wide / 2, turn + 90, turn + 270, wide)


def _volleyball(pen: _Pen, court: Court) -> None:  # noqa: ARG001 - all sports are drawn alike
    wide = 0.05
    pen.rectangle((-9.0, -4.5), (9.0, 4.5), wide)
    pen.line((0, -4.5), (0, 4.5), wide)
    for side in (1, -1):
        pen.line((side * (3.0 - wide / 2), -4.5), (side * (3.0 - wide / 2), 4.5), wide)


def _badminton(pen: _Pen, court: Court) -> None:  # noqa: ARG001 - all sports are drawn alike
    wide, half_x, half_y = 0.04, 6.70, 3.05
    pen.rectangle((-half_x, -half_y), (half_x, half_y), wide)
    for side in (1, -1):
        y = side * (2.59 - wide / 2)
        pen.line((-half_x, y), (half_x, y), wide)
        for x in (1.98 + wide / 2, half_x - 0.76 - wide / 2):
            pen.line((side * x, -half_y), (side * x, half_y), wide)
        pen.line((side * 1.98, 0), (side * half_x, 0), wide)


def _ordered(a: tuple[float, float], b: tuple[float, float]) -> tuple[tuple[float, float], tuple[float, float]]:
    return (min(a[0], b[0]), min(a[1], b[1])), (max(a[0], b[0]), max(a[1], b[1]))


def _wood(shape: tuple[int, ...], colour: Colour, random: np.random.Generator) -> np.ndarray:
    """Strips of planks along x, each with its own tone and grain."""
    height, width = shape[:2]
    strip, plank = round(_STRIP_M * PX_PER_M), round(_PLANK_M * PX_PER_M)
    rows, columns = -(-height // strip), -(-width // plank) + 1
    tones = 1 + 0.045 * random.standard_normal((rows, columns)).astype(np.float32)
    starts = random.integers(plank, size=rows)
    across = np.arange(width)
    field = np.stack([tones[row, (across + starts[row]) // plank] for row in range(rows)])
    field = np.repeat(field, strip, axis=0)[:height]
    grain = cv2.GaussianBlur(random.standard_normal((height, width), np.float32), (0, 0), 9, sigmaY=0.6)
    field = field + 0.02 * grain / grain.std()
    field[::strip] *= 0.93
    return np.asarray(field[..., None] * np.asarray(colour, np.float32), np.float32)


def _dim_at_walls(shape: tuple[int, ...]) -> np.ndarray:
    """Near the walls less light comes down."""
    height, width = shape[:2]
    from_side = np.minimum(np.arange(height), np.arange(height)[::-1]) / PX_PER_M
    from_end = np.minimum(np.arange(width), np.arange(width)[::-1]) / PX_PER_M
    fall = [1 - 0.28 * np.exp(-distance / 0.5) for distance in (from_side, from_end)]
    return np.asarray(fall[0][:, None] * fall[1][None, :], np.float32)
