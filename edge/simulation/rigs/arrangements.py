"""Where cameras stand in a school gym: five arrangements, each in as many variants as there are seeds, and Human3.6M's.

The acting area is a circle of `ACTING_RADIUS_M` around the origin. **Every** camera of every rig sees all of a pupil of
up to `TALLEST_M` who stands anywhere in it; a variant in which one does not is drawn again. Pictures are those of a USB camera:
1280x720, a horizontal field of 70 to 90 degrees, the barrel of a cheap lens, 2.2 to 3 m high, never quite upright.
"""

from collections.abc import Callable
from typing import Final

import numpy as np

from edge.simulation.rigs.h36m import h36m_s9
from edge.simulation.split import SPLITS, Split, generator
from models.arrays import Float
from models.camera.pinhole import Camera
from models.camera.rig import Rig
from models.errors import UserError

ACTING_RADIUS_M: Final = 1.5
TALLEST_M: Final = 1.9
_SIZE_PX: Final = (1280, 720)
_MARGIN_PX: Final = 4.0
_REACH_M: Final = 0.25
"""Half the width of a pupil."""
_TRIES: Final = 500

_FIELD_DEG: Final = (70, 90)
_HEIGHT_M: Final = (2.2, 3.0)
_DISTANCE_M: Final = (5.0, 9.0)
_ROLL_DEG: Final = 2.5

_PLACES: Final[dict[str, tuple[tuple[float, float], ...]]] = {
    "corners": ((5.2, 4.6), (-5.2, 4.6), (-5.2, -4.6), (5.2, -4.6)),
    "row": ((-4.2, -6.2), (-1.4, -6.2), (1.4, -6.2), (4.2, -6.2)),
    "three": ((6.2, 0.0), (-3.4, 5.4), (-3.4, -5.4)),
    "two": ((5.0, 4.4), (5.0, -4.4)),
    "long_room": ((-6.6, 4.2), (-2.2, 5.4), (2.2, 5.4), (6.6, 4.2), (6.6, -4.2), (2.2, -5.4), (-2.2, -5.4), (-6.6, -4.2)),
}
"""(x, y) in metres of each camera before the variant moves it."""
_MOVED_M: Final = 0.45

NAMES: Final = (*_PLACES, "h36m_s9")


def make_rig(name: str, split: Split = "development", seed: int = 0) -> Rig:
    """A rig.

    Args:
        name: one of `NAMES`.
        split: no lens of a test rig is one of a development rig: their fields of view differ by construction. Human3.6M's
            rig is one and the same.
        seed: of the variant.

    Raises:
        UserError: no rig has this name.
    """
    if name == "h36m_s9":
        return h36m_s9()
    if name not in _PLACES:
        raise UserError(f"there is no rig '{name}'; there are {', '.join(NAMES)}")
    random = generator(split, f"rig {name}", seed)
    return Rig(tuple(_one_that_sees(f"cam{number:02d}", at, split, random) for number, at in enumerate(_PLACES[name], 1)))


def sees_acting_area(camera: Camera) -> bool:
    """Whether a camera has every pupil of 0 to `TALLEST_M` in the acting area wholly in its picture."""
    angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    ring = (ACTING_RADIUS_M + _REACH_M) * np.stack((np.cos(angle), np.sin(angle)), axis=1)
    points = np.concatenate([np.column_stack((ring, np.full(len(ring), height))) for height in (0.0, TALLEST_M)])
    pixels = camera.project(points)
    size = np.array(camera.size_px)
    return bool((np.isfinite(pixels) & (pixels >= _MARGIN_PX) & (pixels <= size - 1 - _MARGIN_PX)).all())


def _one_that_sees(name: str, at: tuple[float, float], split: Split, random: np.random.Generator) -> Camera:
    for _ in range(_TRIES):
        camera = _camera(name, at, split, random)
        if _DISTANCE_M[0] <= float(np.linalg.norm(camera.centre_m[:2])) <= _DISTANCE_M[1] and sees_acting_area(camera):
            return camera
    raise AssertionError(f"no camera at {at} sees the acting area")


def _camera(name: str, at: tuple[float, float], split: Split, random: np.random.Generator) -> Camera:
    uniform: Callable[[float, float], float] = random.uniform
    centre = np.array((at[0] + uniform(-_MOVED_M, _MOVED_M), at[1] + uniform(-_MOVED_M, _MOVED_M), uniform(*_HEIGHT_M)))
    aim = np.array((uniform(-0.3, 0.3), uniform(-0.3, 0.3), uniform(0.7, 1.1)))
    # Whole degrees belong to the splits in turn, so that no test camera has the field of view of a development camera.
    degrees = _FIELD_DEG[0] + 2 * int(random.integers((_FIELD_DEG[1] - _FIELD_DEG[0]) // 2)) + SPLITS.index(split)
    half_field = np.radians(degrees + uniform(0.1, 0.9)) / 2
    distortion = _cheap_lens(random)
    edge = np.tan(half_field)
    focal = _SIZE_PX[0] / 2 / _bent(edge, distortion)
    rotation = _looking(centre, aim, np.radians(uniform(-_ROLL_DEG, _ROLL_DEG)))
    width, height = _SIZE_PX
    return Camera(
        name=name,
        size_px=_SIZE_PX,
        matrix_px=np.array(
            (
                (focal, 0.0, (width - 1) / 2 + uniform(-12, 12)),
                (0.0, focal * uniform(0.997, 1.003), (height - 1) / 2 + uniform(-12, 12)),
                (0.0, 0.0, 1.0),
            )
        ),
        distortion=distortion,
        rotation=rotation,
        translation_m=-rotation @ centre,
        shift_px=np.zeros(2),
    )


def _cheap_lens(random: np.random.Generator) -> Float:
    """(5,) k1 k2 p1 p2 k3 of a barrel that still grows outwards at the corners of a 90-degree picture."""
    k1 = random.uniform(-0.16, -0.05)
    return np.array((k1, random.uniform(0.5, 0.9) * k1**2, *random.uniform(-0.0012, 0.0012, 2), random.uniform(-0.004, 0.004)))


def _bent(x: float, distortion: Float) -> float:
    """Where the lens puts what is at (x, 0) without it."""
    k1, k2, _, p2, k3 = (float(value) for value in distortion)
    r2 = x * x
    return x * (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) + 3 * p2 * r2


def _looking(centre: Float, aim: Float, roll_rad: float) -> Float:
    """(3, 3) world to camera."""
    forward = (aim - centre) / np.linalg.norm(aim - centre)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    down = np.cross(forward, right)
    c, s = np.cos(roll_rad), np.sin(roll_rad)
    return np.stack((c * right + s * down, c * down - s * right, forward))
