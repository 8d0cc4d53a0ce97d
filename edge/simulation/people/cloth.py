"""How cloth lies on a body: blown up over it, hanging from its widest places, creased, and turned in at its borders."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy import ndimage

from edge.simulation.people.shell import Shell, hemmed, smoothed, subdivided
from models.arrays import Float

_AROUND: Final = 36
_ROW_M: Final = 0.015


@dataclass(frozen=True, eq=False)
class Garment:
    """A piece of clothing.

    Attributes:
        shell: its triangles.
        covered_m: (V,) how far each of the body's vertices is under it, negative beyond its border. What is looser lets one look
            further in, and covers less.
    """

    shell: Shell
    covered_m: Float


def blown_up(on_body: Shell, thickness_m: Float, calm: int) -> Shell:
    """Moved outwards along calmed normals; nowhere nearer to the body than the thickness.

    Args:
        on_body: lies on the skin.
        thickness_m: (V,).
        calm: rounds of smoothing; many for what bridges hollows.
    """
    normals = smoothed(on_body.normals, on_body.faces, 3)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    places = smoothed(on_body.vertices_m, on_body.faces, calm) + thickness_m[:, None] * normals
    missing = thickness_m - ((places - on_body.vertices_m) * normals).sum(1)
    missing = np.maximum(missing, smoothed(np.maximum(missing, 0)[:, None], on_body.faces, 4)[:, 0])
    return on_body.moved(places + np.maximum(missing, 0)[:, None] * normals)


def hanging(shell: Shell, centre_m: Float, top_z: float, share: Float) -> Shell:
    """Moved away from an upright axis to where it hangs straight from the widest place above, by a share of the way.

    Args:
        shell: blown up.
        centre_m: (2,) x, y of the axis.
        top_z: from here downwards.
        share: (V,) 0 follows the body, 1 hangs straight.
    """
    relative = shell.vertices_m[:, :2] - centre_m
    radius, angle = np.hypot(*relative.T), np.arctan2(relative[:, 1], relative[:, 0])
    row = (top_z - shell.vertices_m[:, 2]) / _ROW_M
    column = (angle + np.pi) / (2 * np.pi) * _AROUND
    counts = share > 0
    counts &= row >= -1
    if not counts.any():
        return shell
    widest = np.zeros((int(row[counts].max()) + 2, _AROUND))
    np.maximum.at(widest, (np.maximum(row[counts], 0).astype(int), column[counts].astype(int) % _AROUND), radius[counts])
    for line in widest:
        known = line > 0
        if known.any():
            line[~known] = np.interp(np.where(~known)[0], np.where(known)[0], line[known], period=_AROUND)
    hung = np.maximum.accumulate(widest, axis=0)
    hung = ndimage.gaussian_filter(hung, (1.5, 1.2), mode=("nearest", "wrap"))
    places = np.stack((np.maximum(row, 0), np.mod(column - 0.5, _AROUND)))
    wanted = ndimage.map_coordinates(np.hstack((hung, hung[:, :1])), places, order=1, mode="nearest")
    fade = np.clip(row / 6, 0, 1)
    grown = np.maximum(share * fade * (wanted - radius), 0) / np.maximum(radius, 1e-3)
    vertices = shell.vertices_m.copy()
    vertices[:, :2] += grown[:, None] * relative
    return shell.moved(vertices)


def creased(shell: Shell, depth_m: Float, scale: float, random: np.random.Generator) -> Shell:
    """With folds that run down and slantwise, `depth_m` (V,) deep, outwards only."""
    waves = np.zeros(len(shell.vertices_m))
    for _ in range(7):
        length = scale * random.uniform(0.05, 0.13)
        direction = random.standard_normal(3) * (1, 1, 0.45)
        wave = np.sin(
            shell.vertices_m @ (direction / np.linalg.norm(direction)) * 2 * np.pi / length + random.uniform(0, 2 * np.pi)
        )
        waves += random.uniform(0.3, 1) * wave
    height = np.clip(0.5 + waves / 5, 0, 1)
    return shell.moved(shell.vertices_m + (depth_m * height)[:, None] * shell.normals)


def turned_in(shell: Shell, thickness_m: float) -> Shell:
    """With its borders turned in by the cloth's thickness."""
    return hemmed(shell, -thickness_m * shell.normals)


def refined(shell: Shell, detail: int) -> Shell:
    """Subdivided `detail` times."""
    for _ in range(detail):
        shell = subdivided(shell)
    return shell


def with_channels(shell: Shell, first: Float, second: Float) -> Shell:
    """Carrying two values a vertex through cuts and subdivisions, in place of `uv`."""
    return replace(shell, uv=np.stack((first, second), axis=-1))
