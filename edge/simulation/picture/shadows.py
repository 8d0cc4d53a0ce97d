"""Shadows that pupils and balls cast on the ground, so that they are seen to stand on it: soft, as a gym's many lamps make them.

A body is a few dozen spheres along its limbs. Of the light that comes from everywhere, a sphere takes from a patch of ground its
solid angle weighted with the cosine; of a lamp's, a share that falls off over a half-shade, which grows with the distance. The
ground is a grid of heights, taken once from the room: floor, mats, boxes.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from edge.simulation.picture.scene import Actor, Pupil, Scene
from edge.simulation.truth.visibility import first_surfaces
from models.arrays import Float, Float32
from models.compiled import compiled
from models.skeleton.smpl import INDEX

CELL_M = 0.04
HIGHEST_M = 1.3
"""What is higher is no ground to throw a shadow on."""
Millimetres = npt.NDArray[np.int16]
MOST_MM = 32000
NO_GROUND = -32768
_ABOVE_M = 10.0
_REACH_M = 0.8
_LAMP_WIDTH = 0.12
"""Of the half-shade, per metre of distance: lamps that are as large as a gym's panels seem from the floor."""
_ROUND = 0.1

_LIMBS: Final[tuple[tuple[str, str, float, float], ...]] = (
    ("pelvis", "pelvis", 0.0, 0.13), ("spine1", "spine1", 0.0, 0.12), ("spine2", "spine2", 0.0, 0.125),
    ("spine3", "neck", 0.3, 0.13), ("neck", "head", 0.5, 0.06), ("neck", "head", 2.0, 0.10),
    *((f"{side}_{a}", f"{side}_{b}", share, radius) for side in ("left", "right") for a, b, share, radius in (
        ("hip", "knee", 0.0, 0.095), ("hip", "knee", 0.35, 0.085), ("hip", "knee", 0.7, 0.07), ("knee", "ankle", 0.0, 0.06),
        ("knee", "ankle", 0.4, 0.055), ("knee", "ankle", 0.75, 0.045), ("ankle", "foot", 0.0, 0.045), ("ankle", "foot", 0.6, 0.042),
        ("ankle", "foot", 1.3, 0.035), ("shoulder", "elbow", 0.0, 0.06), ("shoulder", "elbow", 0.5, 0.048),
        ("elbow", "wrist", 0.0, 0.042), ("elbow", "wrist", 0.5, 0.038), ("wrist", "hand", 0.0, 0.03), ("wrist", "hand", 1.0, 0.045),
    )),
)  # fmt: skip
"""(from, to, share of the way, radius in metres of a person 1.7 m tall)."""
_FROM = [INDEX[a] for a, _, _, _ in _LIMBS]
_TO = [INDEX[b] for _, b, _, _ in _LIMBS]
_SHARES = np.array([[share] for _, _, share, _ in _LIMBS])
_RADII = np.array([radius for _, _, _, radius in _LIMBS])
_USUAL_M = 1.7


@dataclass(frozen=True)
class Patch:
    """Cells of the ground, from (row, column) to before (end_row, end_column)."""

    row: int
    column: int
    end_row: int
    end_column: int


class GroundShadows:
    """The shadows of a scene on its ground.

    Attributes:
        origin_m: (2,) x and y of the middle of the first cell.
        light: (rows along y, columns along x) share of the light that is left in each cell, at the time asked for last.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._heights_m, self.origin_m = _ground(scene)
        self.light: Float32 = np.ones(self._heights_m.shape, np.float32)
        self._patches: list[Patch] = []
        self._t_s: float | None = None
        lamps = [(*lamp.direction, float(np.mean(lamp.colour))) for lamp in scene.lamps if lamp.direction[2] > 0]
        self._lamps = np.array(lamps, np.float64).reshape(-1, 4)
        self._ambient = float(np.mean(scene.ambient))
        self._balls = [(thing, radius) for thing in scene.things if (radius := _ball_radius_m(thing)) is not None]

    def cast(self, t_s: float) -> list[Patch]:
        """Cast the shadows of an instant; returns the patches of `light` in which there may be any."""
        if t_s == self._t_s:
            return self._patches
        for patch in self._patches:
            self.light[patch.row : patch.end_row, patch.column : patch.end_column] = 1.0
        self._patches = []
        self._t_s = t_s
        for pupil in self._scene.pupils:
            if pupil.vertices_m(t_s) is not None:
                self._throw(_spheres(pupil, t_s))
        for ball, radius in self._balls:
            vertices = ball.vertices_m(t_s)
            if vertices is not None:
                self._throw(np.array(((*vertices.mean(0), radius),)))
        return self._patches

    def start_m(self, patch: Patch) -> Float:
        """(2,) x and y of the middle of a patch's first cell."""
        return np.asarray(self.origin_m + CELL_M * np.array((patch.column, patch.row)))

    def corners_m(self, patch: Patch) -> Float:
        """(8, 3) corners of a box that holds the ground of a patch."""
        left, low = self.start_m(patch)
        right, high = self.origin_m + CELL_M * np.array((patch.end_column, patch.end_row))
        return np.array([(x, y, z) for x in (left, right) for y in (low, high) for z in (0.0, HIGHEST_M)])

    def _throw(self, spheres: Float) -> None:
        low, high = spheres[:, :2].min(0) - _REACH_M, spheres[:, :2].max(0) + _REACH_M
        rows, columns = self.light.shape
        column, row = np.clip(np.floor((low - self.origin_m) / CELL_M).astype(int), 0, (columns, rows)).tolist()
        end_column, end_row = np.clip(np.ceil((high - self.origin_m) / CELL_M).astype(int), 0, (columns, rows)).tolist()
        if row < end_row and column < end_column:
            part = (slice(row, end_row), slice(column, end_column))
            patch = Patch(row, column, end_row, end_column)
            _shade(self.light[part], self._heights_m[part], self.start_m(patch), CELL_M, spheres, self._lamps, self._ambient)
            self._patches.append(patch)


def _ground(scene: Scene) -> tuple[Float, Float]:
    """Heights of the ground in cells, NaN where there is none; and the middle of the first cell."""
    triangles = [surface.vertices_m[surface.faces] for surface in scene.room]
    corners = np.concatenate([np.empty((0, 3, 3)), *triangles])
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    with np.errstate(invalid="ignore"):
        level = np.abs(across[:, 2]) > 0.9 * np.linalg.norm(across, axis=1)
    corners = np.ascontiguousarray(corners[level & (corners[..., 2].max(1) < HIGHEST_M)], np.float64).reshape(-1, 3)
    if not len(corners):
        return np.empty((0, 0)), np.zeros(2)
    origin = corners[:, :2].min(0)
    columns, rows = (np.ceil((corners[:, :2].max(0) - origin) / CELL_M).astype(int) + 1).tolist()
    grid = np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), -1).reshape(-1, 2).astype(np.float64)
    first, found = np.full(len(grid), np.inf), np.full(len(grid), -1)
    cells = (corners[:, :2] - origin) / CELL_M
    faces = np.arange(len(corners)).reshape(-1, 3)
    first_surfaces(cells, _ABOVE_M - corners[:, 2], faces, 0, grid, first, found, columns, rows)
    return np.where(np.isfinite(first), _ABOVE_M - first, np.nan).reshape(rows, columns), origin


def _spheres(pupil: Pupil, t_s: float) -> Float:
    """(N, 4) middles and radii of a body."""
    joints = pupil.joints_m(t_s)
    middles = joints[_FROM] + _SHARES * (joints[_TO] - joints[_FROM])
    return np.column_stack((middles, _RADII * pupil.body.stature_m / _USUAL_M))


def _ball_radius_m(thing: Actor) -> float | None:
    """Radius of a ball; None for what is not round."""
    vertices = thing.surface.vertices_m
    distances = np.linalg.norm(vertices - (vertices.min(0) + vertices.max(0)) / 2, axis=1)
    return float(distances.mean()) if distances.std() < _ROUND * distances.mean() else None


@compiled
def _shade(light: Float32, heights: Float, start: Float, cell: float, spheres: Float, lamps: Float, ambient: float) -> None:
    """Darken cells, whose first is at `start`, by what spheres (N, 4) take from even light and from lamps (L, 4)."""
    whole = ambient
    for lamp in range(lamps.shape[0]):
        whole += lamps[lamp, 2] * lamps[lamp, 3]
    left = np.empty(lamps.shape[0])
    for row in range(light.shape[0]):
        for column in range(light.shape[1]):
            height = heights[row, column]
            even = 1.0
            left[:] = 1.0
            for sphere in range(spheres.shape[0]):
                x = spheres[sphere, 0] - start[0] - column * cell
                y = spheres[sphere, 1] - start[1] - row * cell
                radius = spheres[sphere, 3]
                z = max(spheres[sphere, 2] - height, 0.3 * radius)
                square = x * x + y * y + z * z
                if not square < 4.0:
                    continue
                even *= 1 - min(radius * radius * z / (square * np.sqrt(square)), 0.9)
                for lamp in range(lamps.shape[0]):
                    along = x * lamps[lamp, 0] + y * lamps[lamp, 1] + z * lamps[lamp, 2]
                    soft = 0.02 + _LAMP_WIDTH * max(along, 0.0)
                    off = np.sqrt(max(square - along * along, 0.0))
                    if off < radius + soft:
                        share = min((radius + soft - off) / (2 * soft), 1.0)
                        left[lamp] *= 1 - share * share * (3 - 2 * share) * min(1.0, (radius / soft) ** 2)
            rest = ambient * even
            for lamp in range(lamps.shape[0]):
                rest += lamps[lamp, 2] * lamps[lamp, 3] * left[lamp]
            light[row, column] *= rest / whole


@compiled
def darken(picture: Float32, ground: Millimetres, light: Float32, origin: Float, cell: float) -> None:
    """Darken pixels that show the ground.

    Args:
        picture: (h, w, 3) linear light; is changed.
        ground: (h, w, 2) x and y of the ground in each pixel, millimetres; `NO_GROUND` where there is other than ground.
        light: (rows, columns) share of the light that is left in each cell.
        origin: (2,) middle of the first cell.
        cell: side of a cell, metres.
    """
    rows, columns = light.shape
    for y in range(picture.shape[0]):
        for x in range(picture.shape[1]):
            across = (ground[y, x, 0] / 1e3 - origin[0]) / cell
            down = (ground[y, x, 1] / 1e3 - origin[1]) / cell
            if not (across >= 0 and down >= 0 and across < columns - 1 and down < rows - 1):
                continue
            column, row = np.int64(across), np.int64(down)
            u, v = across - column, down - row
            above = (1 - u) * light[row, column] + u * light[row, column + 1]
            below = (1 - u) * light[row + 1, column] + u * light[row + 1, column + 1]
            share = np.float32((1 - v) * above + v * below)
            for channel in range(3):
                picture[y, x, channel] *= share
