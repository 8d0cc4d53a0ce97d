"""What a camera sees, found without the renderer: rays through pixels, against triangles where they are at the row's time.

Source of the test of a ray against a triangle: Moeller and Trumbore, "Fast, minimum storage ray/triangle intersection", 1997.
"""

from dataclasses import dataclass

import numpy as np

from edge.simulation.picture.scene import Scene
from edge.simulation.picture.shutter import Shutter
from models.arrays import Float
from models.camera.pinhole import Camera

_NEWTON_STEPS = 25
_NUDGE = 1e-6
_SAME_PX = 1e-9


@dataclass(frozen=True)
class Hit:
    """The first surface on a ray: its number (pupils, things, room), its triangle, shares of the corners, depth along the axis."""

    shown: int
    face: int
    shares: Float
    depth_m: float
    place_m: Float


def ray(camera: Camera, pixel: Float) -> Float:
    """(3,) direction in the world of what is seen at a pixel; its part along the camera's axis is 1. Newton on `Camera.project`."""
    normalised = np.zeros(2)

    def seen(at: Float) -> Float:
        return camera.project((np.array((*at, 1.0)) - camera.translation_m) @ camera.rotation)

    for _ in range(_NEWTON_STEPS):
        here = seen(normalised)
        if np.abs(pixel - here).max() < _SAME_PX:
            break
        slope = np.column_stack([(seen(normalised + step) - here) / _NUDGE for step in np.eye(2) * _NUDGE])
        normalised = normalised + np.linalg.solve(slope, pixel - here)
    assert np.allclose(seen(normalised), pixel, atol=1e-6), f"no ray found for {pixel}"
    return np.array((*normalised, 1.0)) @ camera.rotation


class RayCaster:
    """Casts rays into a scene as one row of one picture sees it."""

    def __init__(self, scene: Scene, camera: Camera, shutter: Shutter, t_s: float, row: float) -> None:
        when = t_s + float(shutter.row_delay_s(np.array(row), camera.size_px[1]))
        actors = (*scene.pupils, *scene.things)
        parts = [(actor.vertices_m(when), actor.surface.faces) for actor in actors]
        parts += [(surface.vertices_m, surface.faces) for surface in scene.room]
        self._row = row
        self._camera = camera
        self._triangles = np.concatenate([vertices[faces] for vertices, faces in parts if vertices is not None])
        counts = [len(faces) if vertices is not None else 0 for vertices, faces in parts]
        self._owners = np.repeat(np.arange(len(parts)), counts)
        self._firsts = np.cumsum([0, *counts])
        # Only triangles around a ray need be looked at; those that reach behind the camera are around all.
        local = camera.to_camera(self._triangles)
        with np.errstate(divide="ignore", invalid="ignore"):
            flat = np.where((local[..., 2:] > 0).all(1, keepdims=True), local[..., :2] / local[..., 2:], np.nan)
        self._low, self._high = flat.min(1), flat.max(1)

    def cast(self, column: float) -> Hit | None:
        """The first surface at a column of the row."""
        direction = ray(self._camera, np.array((column, self._row)))
        return self._first(direction, np.inf)

    def nearest_before(self, point_m: Float) -> Hit | None:
        """The first surface on the way to a point in the world."""
        along = self._camera.to_camera(point_m)[2]
        return self._first((point_m - self._camera.centre_m) / along, along)

    def _first(self, direction: Float, before_m: float) -> Hit | None:
        at = (self._camera.rotation @ direction)[:2]
        near = np.nonzero(~((self._low > at + _NUDGE) | (self._high < at - _NUDGE)).any(1))[0]
        start, second, third = self._triangles[near].transpose(1, 0, 2)
        edge1, edge2 = second - start, third - start
        across = np.cross(direction, edge2)
        determinant = (edge1 * across).sum(1)
        with np.errstate(divide="ignore", invalid="ignore"):
            away = self._camera.centre_m - start
            u = (away * across).sum(1) / determinant
            turned = np.cross(away, edge1)
            v = turned @ direction / determinant
            depth = (edge2 * turned).sum(1) / determinant
            hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (depth > 0.05) & (depth < before_m)
        if not hit.any():
            return None
        found = int(np.argmin(np.where(hit, depth, np.inf)))
        number = int(near[found])
        owner = int(self._owners[number])
        shares = np.array((1 - u[found] - v[found], u[found], v[found]))
        place = self._camera.centre_m + depth[found] * direction
        return Hit(owner, number - int(self._firsts[owner]), shares, float(depth[found]), place)
