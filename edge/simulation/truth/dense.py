"""What is known about each pixel of a picture: which surface it shows, which point of it, how far away, and where that goes.

It is drawn again from the scene whenever it is asked for, by the same course and lens as the picture, one sample in the middle of
each pixel, at mid-exposure of its row.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from edge.simulation.picture import shaders
from edge.simulation.picture.course import Course, course_of, places_at
from edge.simulation.picture.lens import FAR_M, NEAR_M, Lens, land
from edge.simulation.picture.meshes import corners_of
from edge.simulation.picture.performers import landing
from edge.simulation.picture.renderer import View
from edge.simulation.picture.scene import Scene
from edge.simulation.picture.tessellation import tessellate
from edge.simulation.picture.uniforms import set_lens
from edge.simulation.surface import Surface
from models.arrays import Bool, Float, Float32

if TYPE_CHECKING:
    import moderngl

NOTHING = -1


@dataclass(frozen=True, eq=False)
class Dense:
    """A picture's dense truth.

    Attributes:
        shown: (H, W) index into `surfaces_of` the scene: pupils, things, the room; `NOTHING` where no surface is.
        faces: (H, W) index of the surface's triangle; `NOTHING` where there is none.
        shares: (H, W, 3) barycentric coordinates in that triangle; NaN where there is none.
        places_m: (H, W, 3) the point in the world at mid-exposure of the row; NaN where there is none.
        depths_m: (H, W) along the camera's axis; infinite where there is none.
    """

    shown: npt.NDArray[np.int16]
    faces: npt.NDArray[np.int32]
    shares: Float32
    places_m: Float32
    depths_m: Float32


def surfaces_of(scene: Scene) -> list[Surface]:
    """All surfaces in the order in which `Dense.shown` counts them: pupils, things, the room."""
    return [*(actor.surface for actor in (*scene.pupils, *scene.things)), *scene.room]


def rest_places_m(scene: Scene, dense: Dense) -> Float:
    """(H, W, 3) the same point on the surface at rest, as `Surface.vertices_m` has it: its identity over time and cameras."""
    places = np.full((*dense.shown.shape, 3), np.nan)
    for index, surface in enumerate(surfaces_of(scene)):
        here = dense.shown == index
        corners = surface.vertices_m[surface.faces[dense.faces[here]]]
        places[here] = (dense.shares[here][..., None] * corners).sum(1)
    return places


def flow_px(view: View, dense: Dense, next_t_s: float) -> Float:
    """(H, W, 2) from each pixel to where its point of the surface lands in the picture at `next_t_s`, seen or hidden there.

    NaN where there is no surface, or where it is gone by then.
    """
    height, width = dense.shown.shape
    flow = np.full((height, width, 2), np.nan)
    actors = (*view.renderer.scene.pupils, *view.renderer.scene.things)
    flow[dense.shown >= len(actors)] = 0.0
    for index, actor in enumerate(actors):
        rows, columns = np.nonzero(dense.shown == index)
        course = course_of(actor, next_t_s, view.shutter) if len(rows) else None
        if course is None:
            continue
        corners = actor.surface.faces[dense.faces[rows, columns]]
        shares = dense.shares[rows, columns].astype(np.float64)
        powers = np.einsum("kpca,pc->kpa", course.powers[:, corners], shares)
        readout = view.shutter.readout_s / course.half_s
        landed = land(np.ascontiguousarray(powers), view.lens.numbers, 0.0, readout, height)[0]
        flow[rows, columns] = landed - np.column_stack((columns, rows))
    return flow


class DensePainter:
    """Draws dense truth for the views of one renderer."""

    def __init__(self, view: View) -> None:
        self._view = view
        self._gl = gl = view.renderer.context
        self._room_program = gl.program(shaders.ROOM_TRUTH_VERTEX, shaders.TRUTH_FRAGMENT)
        self._moving_program = gl.program(shaders.MOVING_TRUTH_VERTEX, shaders.TRUTH_FRAGMENT)
        size = view.camera.size_px
        self._target = gl.framebuffer([gl.texture(size, 4, dtype="f4") for _ in range(2)], gl.depth_renderbuffer(size))
        first = len(view.renderer.performers)
        cuts = [_room_corners(surface, view.lens) for surface in view.renderer.scene.room]
        self._room = [(first + number, gl.buffer(cut.tobytes())) for number, cut in enumerate(cuts) if len(cut)]

    def draw(self, t_s: float) -> Dense:
        """The dense truth of the picture at `t_s`."""
        gl, view = self._gl, self._view
        self._target.use()
        gl.enable_only(gl.DEPTH_TEST)
        self._target.clear(-1.0, -1.0, -1.0, -1.0)
        set_lens(self._room_program, view.lens)
        self._moving_program["size"] = view.camera.size_px
        self._moving_program["near_far"] = (NEAR_M, FAR_M)
        for number, buffer in self._room:
            self._room_program["shown"] = number
            _draw_once(gl, self._room_program, [(buffer, "3f 2f 1f", "place", "weights", "number")])
        for number, course in enumerate(view.renderer.courses.at(t_s, view.shutter)):
            if course is None:
                continue
            self._moving_program["shown"] = number
            corners = view.renderer.performers[number].faces.ravel()
            buffer = gl.buffer(_landed_and_places(course, view)[corners].tobytes())
            _draw_once(gl, self._moving_program, [(buffer, "3f 3f", "landed", "place")])
            buffer.release()
        return self._read()

    def _read(self) -> Dense:
        width, height = self._view.camera.size_px
        surface, where = (
            np.frombuffer(self._target.read(components=4, attachment=number, dtype="f4"), np.float32).reshape(height, width, 4)
            for number in range(2)
        )
        empty = surface[..., 0] < 0
        shares = np.dstack((1 - surface[..., 2] - surface[..., 3], surface[..., 2], surface[..., 3]))
        return Dense(
            shown=np.round(surface[..., 0]).astype(np.int16),
            faces=np.round(surface[..., 1]).astype(np.int32),
            shares=_where(empty, np.nan, shares),
            places_m=_where(empty, np.nan, where[..., :3]),
            depths_m=np.where(empty, np.float32(np.inf), where[..., 3]),
        )


def _where(empty: Bool, value: float, otherwise: Float32) -> Float32:
    return np.where(empty[..., None], np.float32(value), otherwise)


def _draw_once(gl: "moderngl.Context", program: "moderngl.Program", layout: Sequence[tuple[object, ...]]) -> None:
    array = gl.vertex_array(program, list(layout))
    array.render()
    array.release()


def _room_corners(surface: Surface, lens: Lens) -> Float32:
    """Place, shares of corners 1 and 2, and number of the face, for each corner of the pieces that a camera sees."""
    places = corners_of(surface)[..., :3]
    count = len(places)
    shares = np.broadcast_to(np.array(((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))), (count, 3, 2))
    numbers = np.broadcast_to(np.arange(count, dtype=np.float64)[:, None, None], (count, 3, 1))
    return tessellate(np.concatenate((places, shares, numbers), axis=2), lens).astype(np.float32)


def _landed_and_places(course: Course, view: View) -> Float32:
    """(V, 6) pixels, depth, and place in the world when the row is exposed."""
    times = land(course.powers, view.lens.numbers, 0.0, view.shutter.readout_s / course.half_s, view.camera.size_px[1])[2]
    return np.hstack((landing(course, view.lens, view.shutter), places_at(course, times))).astype(np.float32)
