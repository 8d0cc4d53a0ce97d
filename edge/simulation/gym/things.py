"""Balls, racket and shuttlecock as they are seen, in the frames and sizes of `models.motions.things`."""

from functools import cached_property
from itertools import pairwise
from typing import Final

import cv2
import numpy as np

from edge.simulation.gym.solids import Heap, sphere
from edge.simulation.surface import Surface, Texture
from models.arrays import Float, UInt8
from models.motions import rotations
from models.motions import things as sizes
from models.motions.motion import RATE_HZ, Thing, ThingKind

_RINGS: Final = 14
_PICTURE_PX: Final = (128, 256)
_ORANGE: Final = (0.80, 0.38, 0.14)
_CORK_RADIUS_M: Final = 0.0135
_SKIRT_RADIUS_M: Final = 0.033
_YELLOW: Final = (0.93, 0.80, 0.10)
"""Of a school's nylon shuttlecocks, which are seen against wall and sky."""
_SHAFT_M: Final = 0.0065
_STRING_M: Final = 0.002
_STRING: Final = (0.60, 0.60, 0.58)
"""Thicker, fewer and greyer than they are: what is thinner than a pixel would flicker between black and white dots, or vanish."""
_HEAD_HALF_M: Final = (0.145, 0.115)
"""Half of the head's length and width (BWF, law 4: at most 29 by 23 cm outside)."""


class PlayedThing:
    """Something that a pupil plays with: an `Actor` of the scene."""

    def __init__(self, thing: Thing) -> None:
        self.thing = thing

    @cached_property
    def surface(self) -> Surface:
        """See `Actor`."""
        return surface_of(self.thing.kind)

    def vertices_m(self, t_s: float) -> Float | None:
        """(V, 3) in the world; None before it comes, after it has gone, and while it is not there."""
        place = t_s * RATE_HZ
        first = min(int(np.floor(place)), len(self.thing.translations_m) - 2)
        if first < 0 or place > len(self.thing.translations_m) - 1:
            return None
        share = place - first
        ends = self.thing.translations_m[first : first + 2]
        if not np.isfinite(ends).all():
            return None
        turned = rotations.matrices(self.thing.rotations_rad[first : first + 2])
        turn = rotations.between(turned[0], turned[1], np.asarray(share))
        return np.asarray(self.surface.vertices_m @ turn.T + (1 - share) * ends[0] + share * ends[1])


def surface_of(kind: ThingKind) -> Surface:
    """The surface of a thing in its own frame."""
    if kind == "racket":
        return _racket()
    if kind == "shuttlecock":
        return _shuttlecock()
    radius, picture, gloss = {
        "basketball": (sizes.BASKETBALL_RADIUS_M, _basketball(), 0.1),
        "volleyball": (sizes.VOLLEYBALL_RADIUS_M, _volleyball(), 0.2),
        "football": (sizes.FOOTBALL_RADIUS_M, _football(), 0.3),
    }[kind]
    vertices, faces, uv = sphere(radius, _RINGS)
    return Surface(kind, vertices, faces.astype(np.int32), np.ones_like(vertices), gloss, Texture(picture, uv))


def _directions() -> Float:
    """(H, W, 3) unit vectors of the pixels of a ball's picture."""
    height, width = _PICTURE_PX
    polar, azimuth = np.meshgrid(
        (np.arange(height) + 0.5) / height * np.pi, (np.arange(width) + 0.5) / width * 2 * np.pi, indexing="ij"
    )
    return np.stack((np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)), -1)


def _basketball() -> UInt8:
    """Eight panels: two great circles and two curved seams."""
    x, y, z = np.moveaxis(_directions(), -1, 0)
    seams = (np.abs(x) < 0.03) | (np.abs(z) < 0.03) | (np.abs(np.abs(y) - 0.62 - 0.25 * x**2) < 0.03)
    return _bytes(np.where(seams[..., None], np.array((0.10, 0.07, 0.06)), np.array(_ORANGE)))


def _volleyball() -> UInt8:
    """Six fields of three stripes, in yellow, blue and white."""
    along = _directions()
    axis = np.abs(along).argmax(-1)
    across = np.take_along_axis(along, ((axis + 1) % 3)[..., None], -1)[..., 0]
    main = np.abs(np.take_along_axis(along, axis[..., None], -1)[..., 0])
    stripe = np.clip((across / main + 1) * 1.5, 0, 2.999).astype(int)
    colours = np.array(((0.95, 0.80, 0.15), (0.93, 0.93, 0.93), (0.13, 0.25, 0.62)))
    picture = colours[(stripe + axis) % 3]
    picture[np.abs(np.mod((across / main + 1) * 1.5 + 0.5, 1) - 0.5) < 0.04] *= 0.6
    return _bytes(picture)


def _football() -> UInt8:
    """White, with twelve dark pentagons where the corners of an icosahedron are."""
    golden = (1 + np.sqrt(5)) / 2
    corners = np.array([np.roll((0, a, b * golden), turn) for turn in range(3) for a in (-1, 1) for b in (-1, 1)])
    corners /= np.linalg.norm(corners, axis=1, keepdims=True)
    nearness = (_directions() @ corners.T).max(-1)
    picture = np.where((nearness > np.cos(0.36))[..., None], 0.10, 0.94) * np.ones(3)
    return _bytes(np.asarray(cv2.GaussianBlur(picture, (0, 0), 0.7), np.float64))


def _racket() -> Surface:
    heap = Heap()
    butt, length = -sizes.RACKET_GRIP_M, sizes.RACKET_LENGTH_M
    heap.bar((0, 0, butt), (0, 0, butt + 0.17), 0.0145, (0.15, 0.15, 0.17))
    top = butt + length
    half_length, half_width = _HEAD_HALF_M
    middle = top - half_length
    heap.bar((0, 0, butt + 0.17), (0, 0, middle - half_length), _SHAFT_M, (0.13, 0.14, 0.18))
    angles = np.linspace(0, 2 * np.pi, 25)
    rim = np.column_stack((np.zeros(25), half_width * np.sin(angles), middle - half_length * np.cos(angles)))
    for start, end in pairwise(rim):
        heap.bar(start, end, 0.007, (0.75, 0.12, 0.14), sides=6)
    for share in np.linspace(-0.75, 0.75, 5):
        y, z = half_width * share, half_length * float(np.sqrt(1 - share**2))
        heap.bar((0, y, middle - z), (0, y, middle + z), _STRING_M, _STRING, sides=3)
        y, z = half_width * float(np.sqrt(1 - share**2)), half_length * share
        heap.bar((0, -y, middle + z), (0, y, middle + z), _STRING_M, _STRING, sides=3)
    return heap.surface("racket", gloss=0.3)


def _shuttlecock() -> Surface:
    """The origin is the cork's tip, the feathers are at the end of z."""
    heap = Heap()
    vertices, faces, _ = sphere(_CORK_RADIUS_M, 6)
    heap.add(vertices + np.array((0, 0, _CORK_RADIUS_M)), faces, (0.94, 0.93, 0.88))
    low, high = 1.6 * _CORK_RADIUS_M, sizes.SHUTTLECOCK_LENGTH_M
    angles = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    ring = np.column_stack((np.cos(angles), np.sin(angles)))
    skirt = np.concatenate(
        (
            np.column_stack((0.9 * _CORK_RADIUS_M * ring, np.full(16, low))),
            np.column_stack((_SKIRT_RADIUS_M * ring, np.full(16, high))),
        )
    )
    place, following = np.arange(16), (np.arange(16) + 1) % 16
    outside = np.concatenate((np.stack((place, following, following + 16), 1), np.stack((place, following + 16, place + 16), 1)))
    heap.add(skirt, outside, _YELLOW)
    heap.add(skirt, outside[:, ::-1], tuple(0.85 * value for value in _YELLOW))
    return heap.surface("shuttlecock")


def _bytes(picture: Float) -> UInt8:
    return np.asarray(np.round(255 * np.clip(picture, 0, 1)), np.uint8)
