"""What stands in a gym and can stand before a pupil: vaulting box, bench, mats, nets, ropes, balls in their cart.

Each is made around the origin, on the floor; `edge.simulation.gym.solids.placed` puts it in its place. Sizes: vaulting box and
bench as schools have them (DIN EN 916; benches 4 m); nets: FIVB, "Official Volleyball Rules", rule 2, BWF,
"Laws of Badminton", law 1.
"""

from typing import Final, Literal

import numpy as np

from edge.simulation.gym.solids import Colour, Heap
from edge.simulation.surface import Surface
from models.motions import mat as mats

_BEECH: Final = (0.80, 0.62, 0.40)
_LEATHER: Final = (0.45, 0.27, 0.16)
_STEEL: Final = (0.62, 0.63, 0.65)
_MAT_BLUE: Final = (0.13, 0.30, 0.62)
_DARK: Final = (0.14, 0.14, 0.16)
_CART_BALLS: Final[tuple[Colour, ...]] = ((0.82, 0.40, 0.16), (0.93, 0.93, 0.90), (0.92, 0.78, 0.20), (0.20, 0.35, 0.70))

BOX_LENGTH_M: Final = 1.50
BOX_HEIGHT_M: Final = 1.10
_BOX_PARTS: Final = 5


def vaulting_box(parts: int = _BOX_PARTS) -> Surface:
    """A vaulting box of 2 to 5 parts, its length along x; all five are `BOX_HEIGHT_M` high."""
    heap = Heap()
    high = BOX_HEIGHT_M / _BOX_PARTS
    for part in range(parts - 1):
        low_wide, top_wide = (0.80 - 0.30 * (part + share) / _BOX_PARTS for share in (0, 1))
        z, half = part * high, BOX_LENGTH_M / 2
        heap.box((-half, -low_wide / 2, z + 0.004), (half, low_wide / 2, z + high - 0.004), _BEECH, taper=top_wide / low_wide)
        for side in (1, -1):
            heap.box((side * half - 0.002, -0.10, z + 0.09), (side * half + 0.002, 0.10, z + 0.13), _DARK)
    z, wide = (parts - 1) * high, 0.80 - 0.30 * (parts - 1) / _BOX_PARTS
    heap.box((-BOX_LENGTH_M / 2, -wide / 2, z), (BOX_LENGTH_M / 2, wide / 2, z + 0.35 * high), _BEECH)
    heap.box((-BOX_LENGTH_M / 2, -wide / 2, z + 0.35 * high), (BOX_LENGTH_M / 2, wide / 2, z + high), _LEATHER, taper=0.93)
    return heap.surface("vaulting box", gloss=0.2)


def bench() -> Surface:
    """A gymnastics bench, 4 m along x, 35 cm high."""
    heap = Heap()
    heap.box((-2.0, -0.125, 0.31), (2.0, 0.125, 0.35), _BEECH)
    heap.box((-1.95, -0.05, 0.06), (1.95, 0.05, 0.12), _BEECH)
    for x in (-1.7, 0.0, 1.7):
        heap.box((x - 0.04, -0.16, 0.0), (x + 0.04, 0.16, 0.06), _BEECH)
        heap.box((x - 0.03, -0.10, 0.06), (x + 0.03, 0.10, 0.31), _BEECH)
    return heap.surface("bench", gloss=0.25)


def mat(colour: Colour = _MAT_BLUE) -> Surface:
    """A gymnastics mat of the size of `models.motions.mat`, its length along x, its middle at the origin."""
    heap = Heap()
    x, y = mats.LENGTH_M / 2, mats.WIDTH_M / 2
    heap.box((-x, -y, 0.0), (x, y, mats.HEIGHT_M), colour)
    light = tuple(min(1.0, 1.25 * channel) for channel in colour)
    for side in (1, -1):
        heap.panel((side * (x - 0.06) - 0.03, -y, mats.HEIGHT_M + 0.001), (0.06, 0, 0), (0, 2 * y, 0), light)
    for corner_x in (-x, x - 0.12):
        for corner_y in (-y, y - 0.12):
            heap.panel((corner_x, corner_y, mats.HEIGHT_M + 0.002), (0.12, 0, 0), (0, 0.12, 0), _LEATHER)
    return heap.surface("mat", gloss=0.15)


def mat_pile(count: int) -> Surface:
    """Mats on top of one another."""
    heap = Heap()
    for number in range(count):
        z, off = number * (mats.HEIGHT_M + 0.006), 0.03 * np.sin(2.1 * number)
        heap.box((-1.0 + off, -0.5 - off, z), (1.0 + off, 0.5 - off, z + mats.HEIGHT_M), _MAT_BLUE)
    return heap.surface("mats", gloss=0.15)


def net(kind: Literal["volleyball", "badminton"], high_m: float | None = None) -> Surface:
    """A net on its posts, along y, its middle at the origin.

    Args:
        kind: volleyball (9.5 m long, 1 m deep, meshes of 10 cm) or badminton (6.1 m long, 0.76 m deep; its meshes of 2 cm are drawn
            as meshes of 6 cm, whose cords are thicker).
        high_m: upper edge; 2.24 m or 1.55 m at the posts if None.
    """
    half, deep, mesh, cord, usual = (4.75, 1.0, 0.10, 0.0015, 2.24) if kind == "volleyball" else (3.05, 0.76, 0.06, 0.0012, 1.55)
    top = usual if high_m is None else high_m
    heap = Heap()
    for y in np.arange(-half, half + 1e-9, mesh):
        heap.box((-cord, y - cord, top - deep), (cord, y + cord, top), _DARK)
    for z in np.arange(top - deep, top + 1e-9, mesh):
        heap.box((-cord, -half, z - cord), (cord, half, z + cord), _DARK)
    band = 0.07 if kind == "volleyball" else 0.075
    heap.box((-0.004, -half, top - band), (0.004, half, top), (0.95, 0.95, 0.93))
    for side in (1, -1):
        heap.bar((0, side * (half + 0.5), 0), (0, side * (half + 0.5), top + 0.05), 0.045, _STEEL, sides=12)
        heap.box((-0.25, side * (half + 0.5) - 0.2, 0), (0.25, side * (half + 0.5) + 0.2, 0.03), _STEEL)
        for z in (top - 0.03, top - deep + 0.03):
            heap.bar((0, side * half, z), (0, side * (half + 0.5), z), 0.003, _DARK, sides=4)
    return heap.surface(f"{kind} net")


def rope(high_m: float) -> Surface:
    """A climbing rope that hangs from the ceiling."""
    heap = Heap()
    heap.bar((0, 0, 0.35), (0, 0, high_m), 0.017, (0.72, 0.62, 0.44), sides=6)
    heap.bar((0, 0, 0.25), (0, 0, 0.36), 0.03, _LEATHER, sides=6)
    return heap.surface("rope")


def ball_cart(random: np.random.Generator) -> Surface:
    """A cart of steel bars full of balls."""
    heap = Heap()
    for x in (-0.5, 0.5):
        for y in (-0.3, 0.3):
            heap.bar((x, y, 0.1), (x, y, 0.95), 0.015, _STEEL, sides=6)
            heap.ball((x, y, 0.05), 0.05, _DARK, rings=4)
    for z in (0.3, 0.55, 0.95):
        for start, end in (
            ((-0.5, -0.3), (0.5, -0.3)),
            ((0.5, -0.3), (0.5, 0.3)),
            ((0.5, 0.3), (-0.5, 0.3)),
            ((-0.5, 0.3), (-0.5, -0.3)),
        ):
            heap.bar((*start, z), (*end, z), 0.008, _STEEL, sides=4)
    for x in (-0.36, -0.12, 0.12, 0.36):
        for y in (-0.14, 0.14):
            for z in (0.42, 0.64, 0.85):
                colour = _CART_BALLS[int(random.integers(len(_CART_BALLS)))]
                heap.ball((x + random.uniform(-0.02, 0.02), y + random.uniform(-0.02, 0.02), z), 0.108, colour, rings=6)
    return heap.surface("ball cart", gloss=0.2)
