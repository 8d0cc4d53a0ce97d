"""Boxes, bars, balls and panels with hard edges, heaped into one surface."""

from collections.abc import Sequence
from typing import Final

import numpy as np
import numpy.typing as npt

from edge.simulation.surface import Surface, Texture
from models.arrays import Float, UInt8

Colour = tuple[float, float, float]

_BOX_SIDES: Final = (
    ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    ((-1, 0, 0), (0, -1, 0), (0, 0, 1)),
    ((0, 1, 0), (-1, 0, 0), (0, 0, 1)),
    ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
    ((0, 0, 1), (1, 0, 0), (0, 1, 0)),
    ((0, 0, -1), (-1, 0, 0), (0, 1, 0)),
)
"""Outward normal, across and up of each side; across x up = normal."""


class Heap:
    """Solids, each in one colour, to be drawn as one surface. All are closed and face outwards but for panels."""

    def __init__(self) -> None:
        self._vertices: list[Float] = []
        self._faces: list[npt.NDArray[np.integer]] = []
        self._colours: list[Float] = []
        self._count = 0

    def add(self, vertices_m: Float, faces: npt.NDArray[np.integer], colour: Sequence[float]) -> None:
        """Triangles (F, 3) of vertices (V, 3)."""
        self._vertices.append(np.asarray(vertices_m, np.float64))
        self._faces.append(np.asarray(faces) + self._count)
        self._colours.append(np.tile(np.asarray(colour, np.float64), (len(vertices_m), 1)))
        self._count += len(vertices_m)

    def box(self, low_m: Sequence[float], high_m: Sequence[float], colour: Sequence[float], taper: float = 1.0) -> None:
        """Upright box between two corners; along y its top is `taper` times as wide as its bottom."""
        low, high = np.asarray(low_m, np.float64), np.asarray(high_m, np.float64)
        centre, half = (low + high) / 2, (high - low) / 2
        for normal, across, up in (np.array(side, np.float64) for side in _BOX_SIDES):
            corners = np.stack([normal + a * across + b * up for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
            corners[:, 1] *= np.where(corners[:, 2] > 0, taper, 1.0)
            self.add(centre + half * corners, np.array(((0, 1, 2), (0, 2, 3))), colour)

    def panel(self, corner_m: Sequence[float], across_m: Sequence[float], up_m: Sequence[float], colour: Sequence[float]) -> None:
        """A rectangle that is seen from the side to which across x up points."""
        self.add(_rectangle(corner_m, across_m, up_m), np.array(((0, 1, 2), (0, 2, 3))), colour)

    def bar(
        self, start_m: Sequence[float], end_m: Sequence[float], radius_m: float, colour: Sequence[float], sides: int = 8
    ) -> None:
        """A round bar with flat ends."""
        start, end = np.asarray(start_m, np.float64), np.asarray(end_m, np.float64)
        along = (end - start) / np.linalg.norm(end - start)
        across = np.cross(along, (1.0, 0.0, 0.0) if abs(along[0]) < 0.8 else (0.0, 1.0, 0.0))
        across /= np.linalg.norm(across)
        up = np.cross(along, across)
        angles = np.linspace(0, 2 * np.pi, sides, endpoint=False)
        ring = radius_m * (np.cos(angles)[:, None] * across + np.sin(angles)[:, None] * up)
        place, following = np.arange(sides), (np.arange(sides) + 1) % sides
        mantle = np.concatenate(
            (np.stack((place, following, following + sides), 1), np.stack((place, following + sides, place + sides), 1))
        )
        self.add(np.concatenate((start + ring, end + ring)), mantle, colour)
        fan = np.stack((np.zeros(sides - 2, int), np.arange(1, sides - 1), np.arange(2, sides)), 1)
        self.add(end + ring, fan, colour)
        self.add(start + ring, fan[:, ::-1], colour)

    def ball(self, centre_m: Sequence[float], radius_m: float, colour: Sequence[float], rings: int = 8) -> None:
        """A ball."""
        vertices, faces, _ = sphere(radius_m, rings)
        self.add(vertices + np.asarray(centre_m), faces, colour)

    def surface(self, name: str, gloss: float = 0.0) -> Surface:
        """All of it."""
        faces = np.concatenate(self._faces).astype(np.int32)
        return Surface(name, np.concatenate(self._vertices), faces, np.concatenate(self._colours), gloss)


def painted_panel(
    name: str,
    corner_m: Sequence[float],
    across_m: Sequence[float],
    up_m: Sequence[float],
    picture: UInt8,
    gloss: float = 0.0,
) -> Surface:
    """A rectangle with a picture, its first row at the top; seen from the side to which across x up points."""
    uv = np.array(((0, 1), (1, 1), (1, 0), (0, 0)), np.float64)
    faces = np.array(((0, 1, 2), (0, 2, 3)), np.int32)
    return Surface(name, _rectangle(corner_m, across_m, up_m), faces, np.ones((4, 3)), gloss, Texture(picture, uv))


def sphere(radius_m: float, rings: int) -> tuple[Float, npt.NDArray[np.integer], Float]:
    """Vertices (V, 3), faces (F, 3) and places in a picture (V, 2) of a ball around the origin, poles on z."""
    down, around = np.linspace(0, np.pi, rings + 1), np.linspace(0, 2 * np.pi, 2 * rings + 1)
    polar, azimuth = np.meshgrid(down, around, indexing="ij")
    vertices = radius_m * np.stack((np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)), -1)
    row, column = np.meshgrid(np.arange(rings), np.arange(2 * rings), indexing="ij")
    a = row * (2 * rings + 1) + column
    b = a + 2 * rings + 1
    upper, lower = np.stack((a, b, b + 1), -1)[:-1], np.stack((a, b + 1, a + 1), -1)[1:]
    uv = np.stack((azimuth / (2 * np.pi), polar / np.pi), -1)
    return vertices.reshape(-1, 3), np.concatenate((upper.reshape(-1, 3), lower.reshape(-1, 3))), uv.reshape(-1, 2)


def placed(surface: Surface, at_m: Sequence[float], heading_rad: float) -> Surface:
    """Turned about z and moved."""
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    turn = np.array(((c, -s, 0), (s, c, 0), (0, 0, 1)))
    vertices = surface.vertices_m @ turn.T + np.asarray(at_m, np.float64)
    return Surface(surface.name, vertices, surface.faces, surface.colours, surface.gloss, surface.texture)


def _rectangle(corner_m: Sequence[float], across_m: Sequence[float], up_m: Sequence[float]) -> Float:
    corner, across, up = (np.asarray(vector, np.float64) for vector in (corner_m, across_m, up_m))
    return np.stack((corner, corner + across, corner + across + up, corner + up))
