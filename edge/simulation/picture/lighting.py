"""Light on what moves, in each vertex: its triangles are hardly larger than pixels. The room's is in `shaders`."""

from collections.abc import Sequence

import numpy as np

from edge.simulation.picture.scene import Lamp
from models.arrays import Float, Float32
from models.compiled import compiled


def lamp_numbers(lamps: Sequence[Lamp]) -> Float:
    """(L, 6) directions and colours."""
    return np.array([(*lamp.direction, *lamp.colour) for lamp in lamps], np.float64).reshape(-1, 6)


@compiled
def lit(places: Float, normals: Float, colours: Float, lamps: Float, ambient: Float, eye: Float, gloss: float) -> Float32:
    """Light that the two sides of a surface send to a camera.

    Args:
        places: (V, 3) in the world.
        normals: (V, 3) unit, outwards.
        colours: (V, 3) linear.
        lamps: (L, 6) as `lamp_numbers` gives them.
        ambient: (3,) light from everywhere: a quarter less from below than from the side, since floors are darker than walls.
        eye: (3,) the camera's place.
        gloss: 0 dull to 1 polished.

    Returns:
        (V, 8) colour times light and highlight of the outer side, then of the inner.
    """
    out = np.zeros((places.shape[0], 8), np.float32)
    squarings = round(2.0 + 7.0 * gloss)
    strength = gloss * (2.0**squarings + 8.0) / 160.0
    light = np.empty(3)
    for vertex in range(places.shape[0]):
        ex, ey, ez = eye[0] - places[vertex, 0], eye[1] - places[vertex, 1], eye[2] - places[vertex, 2]
        away = np.sqrt(ex * ex + ey * ey + ez * ez)
        for side in range(2):
            sign = 1.0 - 2.0 * side
            nx, ny, nz = sign * normals[vertex, 0], sign * normals[vertex, 1], sign * normals[vertex, 2]
            highlight = 0.0
            for channel in range(3):
                light[channel] = ambient[channel] * (0.8 + 0.2 * nz)
            for lamp in range(lamps.shape[0]):
                lx, ly, lz = lamps[lamp, 0], lamps[lamp, 1], lamps[lamp, 2]
                falls = nx * lx + ny * ly + nz * lz
                if falls <= 0:
                    continue
                for channel in range(3):
                    light[channel] += lamps[lamp, 3 + channel] * falls
                if gloss > 0:
                    hx, hy, hz = ex + away * lx, ey + away * ly, ez + away * lz
                    shine = max(nx * hx + ny * hy + nz * hz, 0.0) / np.sqrt(hx * hx + hy * hy + hz * hz)
                    for _ in range(squarings):
                        shine *= shine
                    highlight += shine * strength * (lamps[lamp, 3] + lamps[lamp, 4] + lamps[lamp, 5]) / 3
            for channel in range(3):
                out[vertex, 4 * side + channel] = colours[vertex, channel] * light[channel]
            out[vertex, 4 * side + 3] = highlight
    return out
