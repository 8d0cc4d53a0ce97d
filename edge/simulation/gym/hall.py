"""A school gym: hall, walls, windows, wall bars, baskets, benches and what stands about, in colours by seed.

The hall's middle is the world's origin, its length along x. Seed by seed it is about 27 by 15 m and 6 m high; the middle
stays free for who acts. Everything is plain triangles and pictures painted by code, less than 60,000 triangles.
"""

import colorsys
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np

from edge.simulation.gym.court import BASKET_FROM_END_M, Court, paint_floor
from edge.simulation.gym.furniture import ball_cart, bench, mat_pile, rope, vaulting_box
from edge.simulation.gym.solids import Colour, Heap, painted_panel, placed
from edge.simulation.gym.walls import WallStyle, paint_ceiling, paint_sky, paint_wall
from edge.simulation.picture.scene import Lamp
from edge.simulation.split import SPLITS, Split, generator
from edge.simulation.surface import Surface

FREE_RADIUS_M: Final = 6.0
"""Around the origin nothing stands but what a lesson puts there."""
_WHITE: Final = (0.92, 0.92, 0.90)
_STEEL: Final = (0.62, 0.63, 0.65)
_BEECH: Final = (0.80, 0.62, 0.40)
_SHINES: Final = 1.7
"""Colour of windows and lamps: brighter than white paper, so that a camera sees them burnt out."""
_HUES: Final = 6


@dataclass(frozen=True, eq=False)
class Gym:
    """What never moves, and its light.

    Attributes:
        room: for `edge.simulation.picture.scene.Scene`.
        lamps: the ceiling's and the windows' light.
        ambient: what comes from everywhere.
        length_m, width_m, height_m: of the hall, along x, y and z.
    """

    room: tuple[Surface, ...]
    lamps: tuple[Lamp, ...]
    ambient: tuple[float, float, float]
    length_m: float
    width_m: float
    height_m: float


@dataclass(frozen=True)
class _Hall:
    """Sizes and colours that all parts share; `window_side` is the side of y (1 or -1) with the windows."""

    length_m: float
    width_m: float
    height_m: float
    window_side: int
    style: WallStyle
    wood: Colour


def make_gym(split: Split = "development", seed: int = 0) -> Gym:
    """A gym. The hues of pads and doors of test gyms are none of development gyms."""
    random = generator(split, "gym", seed)
    hall = _drawn_hall(split, random)
    parts = [
        _floor(hall, random),
        *_walls(hall, random),
        *_windows(hall, random),
        painted_panel("ceiling", *_ceiling_frame(hall), paint_ceiling(hall.length_m, hall.width_m, random)),
        _lamps(hall),
        _wall_bars(hall),
        *(_basket(hall, side) for side in (1, -1)),
        _doors(hall),
        *_clutter(hall, random),
    ]
    lamps, ambient = _light(hall, random)
    return Gym(tuple(parts), lamps, ambient, hall.length_m, hall.width_m, hall.height_m)


def _drawn_hall(split: Split, random: np.random.Generator) -> _Hall:
    hue = (int(random.integers(_HUES)) + SPLITS.index(split) / len(SPLITS)) / _HUES
    pad = colorsys.hsv_to_rgb(hue, random.uniform(0.35, 0.75), random.uniform(0.35, 0.75))
    wood_tone = random.uniform(0.85, 1.1)
    wood = tuple(np.clip(wood_tone * np.array((0.76, 0.58, 0.38)) * random.uniform(0.94, 1.06, 3), 0, 1))
    upper = float(random.uniform(0.72, 0.9))
    style = WallStyle(
        pad=pad,
        upper=(upper, upper * float(random.uniform(0.95, 1.0)), upper * float(random.uniform(0.82, 0.97))),
        kind=("brick", "slats", "plaster")[int(random.integers(3))],
        pad_height_m=float(random.uniform(1.9, 2.3)),
    )
    return _Hall(
        length_m=float(random.uniform(26.5, 28.0)),
        width_m=float(random.uniform(15.0, 16.0)),
        height_m=float(random.uniform(5.6, 6.5)),
        window_side=1 if random.random() < 0.5 else -1,
        style=style,
        wood=(float(wood[0]), float(wood[1]), float(wood[2])),
    )


def _floor(hall: _Hall, random: np.random.Generator) -> Surface:
    schemes: tuple[tuple[Colour, Colour, Colour], ...] = (
        ((0.10, 0.10, 0.12), (0.12, 0.42, 0.24), (0.80, 0.18, 0.15)),
        ((0.95, 0.95, 0.92), (0.12, 0.25, 0.60), (0.93, 0.78, 0.15)),
        ((0.75, 0.15, 0.12), (0.95, 0.95, 0.92), (0.10, 0.35, 0.22)),
    )
    basketball, volleyball, badminton = schemes[int(random.integers(len(schemes)))]
    court = Court(hall.length_m, hall.width_m, hall.wood, basketball, volleyball, badminton)
    x, y = hall.length_m, hall.width_m
    return painted_panel("floor", (-x / 2, -y / 2, 0), (x, 0, 0), (0, y, 0), paint_floor(court, random), gloss=0.35)


def _walls(hall: _Hall, random: np.random.Generator) -> list[Surface]:
    x, y, z = hall.length_m / 2, hall.width_m / 2, hall.height_m
    sides = (((x, y, 0), (0, -2 * y, 0)), ((-x, -y, 0), (0, 2 * y, 0)), ((-x, y, 0), (2 * x, 0, 0)), ((x, -y, 0), (-2 * x, 0, 0)))
    return [
        painted_panel("wall", corner, across, (0, 0, z), paint_wall(hall.style, float(np.abs(across).sum()), z, random))
        for corner, across in sides
    ]


def _ceiling_frame(hall: _Hall) -> tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]:
    """Corner, across and up of the ceiling, which is seen from below."""
    x, y = hall.length_m, hall.width_m
    return (-x / 2, y / 2, hall.height_m), (x, 0, 0), (0, -y, 0)


def _windows(hall: _Hall, random: np.random.Generator) -> list[Surface]:
    """A band of windows under the ceiling of one long side."""
    side, sill, head = hall.window_side, 3.2, hall.height_m - 0.6
    y, count, gap = side * (hall.width_m / 2 - 0.02), int(random.integers(5, 8)), 0.5
    wide = (hall.length_m - 2 - gap * (count - 1)) / count
    frames, panes = Heap(), []
    for number in range(count):
        left = -hall.length_m / 2 + 1 + number * (wide + gap)
        corner = (left, y, sill) if side == 1 else (left + wide, y, sill)
        pane = painted_panel("window", corner, (side * wide, 0, 0), (0, 0, head - sill), paint_sky(random), gloss=0.2)
        panes.append(_shining(pane))
        inner = y - side * 0.05
        for x in np.linspace(left, left + wide, 4):
            frames.box((x - 0.03, min(inner, y), sill), (x + 0.03, max(inner, y), head), _WHITE)
        for z in (sill, (sill + head) / 2, head):
            frames.box((left, min(inner, y), z - 0.03), (left + wide, max(inner, y), z + 0.03), _WHITE)
    return [*panes, frames.surface("window frames")]


def _shining(surface: Surface) -> Surface:
    return replace(surface, colours=np.full_like(surface.colours, _SHINES))


def _lamps(hall: _Hall) -> Surface:
    """Rows of lamps under the ceiling."""
    heap = Heap()
    z = hall.height_m
    for x in np.linspace(-0.4, 0.4, 6) * hall.length_m:
        for y in (-0.3, 0.0, 0.3):
            at = y * hall.width_m
            heap.box((x - 0.7, at - 0.17, z - 0.14), (x + 0.7, at + 0.17, z - 0.06), _STEEL)
            heap.panel((x - 0.65, at + 0.13, z - 0.145), (1.3, 0, 0), (0, -0.26, 0), (_SHINES, _SHINES, 0.97 * _SHINES))
    return heap.surface("lamps")


def _wall_bars(hall: _Hall) -> Surface:
    """Fields of wall bars along the long side without windows."""
    heap = Heap()
    y, towards = -hall.window_side * hall.width_m / 2, hall.window_side
    for field in range(6):
        left = -0.36 * hall.length_m + field * 1.02 + (0.0 if field < 3 else 0.5 * hall.length_m)
        for x in (left, left + 0.96):
            heap.box((x - 0.02, min(y, y + towards * 0.12), 0.1), (x + 0.02, max(y, y + towards * 0.12), 2.6), _BEECH)
        for z in np.linspace(0.25, 2.5, 14):
            heap.bar((left, y + towards * 0.09, z), (left + 0.96, y + towards * 0.09, z), 0.019, _BEECH, sides=6)
    return heap.surface("wall bars", gloss=0.25)


def _basket(hall: _Hall, side: int) -> Surface:
    """Backboard, ring and net at an end wall; ring at 3.05 m, board 1.80 by 1.05 m (FIBA, articles 3 and 2 of its equipment)."""
    heap = Heap()
    wall = side * hall.length_m / 2
    court_end = Court(hall.length_m, hall.width_m, hall.wood, _WHITE, _WHITE, _WHITE).basketball_half_m[0]
    ring_x, board_x = side * (court_end - BASKET_FROM_END_M), side * (court_end - 1.2)
    heap.box((min(board_x, board_x + side * 0.03), -0.90, 2.90), (max(board_x, board_x + side * 0.03), 0.90, 3.95), _WHITE)
    front = board_x - side * 0.005
    for y0, z0, y1, z1 in (
        (-0.90, 2.90, 0.90, 2.95),
        (-0.90, 3.90, 0.90, 3.95),
        (-0.90, 2.9, -0.85, 3.95),
        (0.85, 2.9, 0.90, 3.95),
    ):
        heap.box((min(front, board_x), y0, z0), (max(front, board_x), y1, z1), (0.12, 0.12, 0.14))
    for y0, z0, y1, z1 in (
        (-0.295, 3.05, 0.295, 3.10),
        (-0.295, 3.45, 0.295, 3.50),
        (-0.295, 3.05, -0.245, 3.5),
        (0.245, 3.05, 0.295, 3.5),
    ):
        heap.box((min(front, board_x), y0, z0), (max(front, board_x), y1, z1), (0.12, 0.12, 0.14))
    for y in (-0.6, 0.6):
        heap.bar((board_x + side * 0.03, y, 3.4), (wall, y, 3.4), 0.03, _STEEL)
        heap.bar((board_x + side * 0.03, y, 3.1), (wall, y, 3.9), 0.02, _STEEL)
    angles = np.linspace(0, 2 * np.pi, 17)
    for start, end in pairwise(np.stack((ring_x + 0.234 * np.cos(angles), 0.234 * np.sin(angles)), -1)):
        heap.bar((*start, 3.05), (*end, 3.05), 0.010, (0.85, 0.30, 0.10), sides=6)
    for angle in angles[:-1:2]:
        top = (ring_x + 0.23 * np.cos(angle), 0.23 * np.sin(angle), 3.05)
        for turn in (0.4, -0.4):
            low = (ring_x + 0.13 * np.cos(angle + turn), 0.13 * np.sin(angle + turn), 2.62)
            heap.bar(top, low, 0.004, _WHITE, sides=4)
    heap.bar((ring_x + side * 0.23, 0, 3.05), (board_x, 0, 3.05), 0.03, (0.85, 0.30, 0.10))
    return heap.surface("basket", gloss=0.2)


def _doors(hall: _Hall) -> Surface:
    """A double door in one end wall and a wide gate of the equipment room in the other."""
    heap, x = Heap(), hall.length_m / 2
    red, green, blue = hall.style.pad
    colour = (0.55 * red + 0.2, 0.55 * green + 0.2, 0.55 * blue + 0.2)
    for left in (-4.6, -3.6):
        heap.box((x - 0.03, left, 0.0), (x, left + 0.96, 2.1), colour)
        heap.box((x - 0.05, left + 0.43, 1.0), (x - 0.03, left + 0.53, 1.15), _STEEL)
    heap.box((x - 0.05, -4.7, 0), (x, -4.61, 2.2), _STEEL)
    heap.box((x - 0.05, -2.63, 0), (x, -2.54, 2.2), _STEEL)
    heap.box((x - 0.05, -4.7, 2.11), (x, -2.54, 2.2), _STEEL)
    for slat in range(12):
        heap.box((-x, 1.8, 0.02 + slat * 0.19), (-x + 0.03, 5.4, 0.19 + slat * 0.19), _BEECH)
    heap.box((x - 0.06, -3.85, 2.45), (x, -3.35, 2.65), (0.10, 0.52, 0.22))
    heap.box((-x, -2.6, 3.2), (-x + 0.08, -0.8, 4.0), (0.08, 0.08, 0.09))
    for digit in (-2.4, -2.0, -1.4, -1.0):
        heap.box((-x + 0.08, digit - 0.09, 3.45), (-x + 0.085, digit + 0.09, 3.8), (0.9, 0.2, 0.12))
    return heap.surface("doors")


def _clutter(hall: _Hall, random: np.random.Generator) -> list[Surface]:
    """What stands and lies along the walls."""
    x, y = hall.length_m / 2, hall.width_m / 2
    parts = [placed(bench(), (at, side * (y - 0.35), 0), 0.0) for at, side in ((-4.6, 1), (4.2, 1), (-1.0, -1), (7.5, -1))]
    parts.append(placed(vaulting_box(4), (x - 1.2, random.uniform(2.0, 5.0), 0), random.uniform(-0.3, 0.3)))
    parts.append(placed(vaulting_box(3), (-x + 1.3, -random.uniform(4.0, 5.5), 0), random.uniform(-0.3, 0.3)))
    parts.append(placed(mat_pile(int(random.integers(4, 9))), (-x + 1.6, random.uniform(-1.5, 1.0), 0), np.pi / 2))
    parts.append(placed(ball_cart(random), (x - 1.0, random.uniform(-1.5, 0.8), 0), random.uniform(0, np.pi)))
    parts.extend(
        placed(rope(hall.height_m), (x - 2.4 - 0.5 * number, -hall.window_side * (y - 0.5), 0), 0.0) for number in range(4)
    )
    return parts


def _light(hall: _Hall, random: np.random.Generator) -> tuple[tuple[Lamp, ...], tuple[float, float, float]]:
    """Lamps above, daylight from the windows' side, and a little from the opposite wall."""
    day = float(random.uniform(0.15, 0.42))
    side = hall.window_side
    overhead = 0.52 - 0.5 * day
    directions = (
        ((0.25, 0.10 * side, 1.0), overhead, (1.0, 0.97, 0.91)),
        ((-0.45, -0.25 * side, 0.8), 0.5 * overhead, (1.0, 0.97, 0.91)),
        ((0.15, 1.0 * side, 0.45), day, (0.93, 0.97, 1.0)),
        ((-0.1, -1.0 * side, 0.25), 0.25 * day, (1.0, 0.96, 0.9)),
    )
    lamps = []
    for direction, strength, colour in directions:
        x, y, z = (float(value) for value in np.array(direction) / np.linalg.norm(direction))
        red, green, blue = (float(strength * channel) for channel in colour)
        lamps.append(Lamp((x, y, z), (red, green, blue)))
    ambient = float(random.uniform(0.36, 0.46))
    return tuple(lamps), (ambient, ambient, 1.02 * ambient)
