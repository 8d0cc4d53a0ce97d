"""What moves, in the graphics library's buffers."""

from typing import TYPE_CHECKING

import numpy as np

from edge.simulation.picture.boxes import Box
from edge.simulation.picture.course import Course
from edge.simulation.picture.lens import Lens, land
from edge.simulation.picture.lighting import lit
from edge.simulation.picture.meshes import linear, near_rim, normals, texture_places, welded
from edge.simulation.picture.scene import Actor
from edge.simulation.picture.shutter import Shutter
from edge.simulation.picture.uniforms import set_texture, texture_of
from models.arrays import Float, Float32

if TYPE_CHECKING:
    import moderngl

_SLEEVE_M = 0.08
"""How deep one looks into a sleeve."""
_MARGIN_PX = 3
_EVERY = 11
"""Of the vertices, whose motion is looked at to know how fast an actor is."""
_BEHIND = (0.0, 0.0, -1.0)


class Performer:
    """An actor.

    Attributes:
        actor: the actor.
        faces: (F, 3) its triangles.
    """

    def __init__(self, gl: "moderngl.Context", program: "moderngl.Program", actor: Actor) -> None:
        surface = actor.surface
        self.actor = actor
        self.faces = np.ascontiguousarray(surface.faces, np.int32)
        self._gl = gl
        self._program = program
        self._welds = welded(np.asarray(surface.vertices_m))
        self._colours = linear(np.asarray(surface.colours, np.float64))
        self._normals: tuple[Course, Float] | None = None
        count = len(surface.vertices_m)
        self._landed = gl.buffer(reserve=count * 12, dynamic=True)
        self._lit = gl.buffer(reserve=count * 32, dynamic=True)
        self._texture = texture_of(gl, surface, anisotropy=1.0)
        layout = [
            (self._landed, "3f", "landed"),
            (self._lit, "4f 4f", "outer_light", "inner_light"),
            (gl.buffer(texture_places(surface).tobytes()), "2f", "uv"),
        ]
        self._outside = gl.vertex_array(program, layout, index_buffer=gl.buffer(self.faces.tobytes()))
        rim = self.faces[near_rim(np.asarray(surface.vertices_m), self._welds[self.faces], _SLEEVE_M)]
        self._rim = gl.vertex_array(program, layout, index_buffer=gl.buffer(rim.tobytes())) if len(rim) else None

    def light(self, course: Course, lamps: Float, ambient: Float, eye_m: Float) -> None:
        """Light it as it stands in the middle of a picture."""
        if self._normals is None or self._normals[0] is not course:
            self._normals = course, normals(course.powers[0], self.faces, self._welds)
        gloss = float(self.actor.surface.gloss)
        self._lit.write(lit(course.powers[0], self._normals[1], self._colours, lamps, ambient, eye_m, gloss).tobytes())

    def draw(self, landed: Float32) -> None:
        """Draw it where its vertices have landed, as `landing` gives them."""
        gl = self._gl
        self._landed.write(landed.tobytes())
        set_texture(self._program, self._texture)
        gl.enable_only(gl.DEPTH_TEST | gl.CULL_FACE)
        self._outside.render()
        if self._rim is not None:
            gl.enable_only(gl.DEPTH_TEST)
            self._rim.render()


def landing(course: Course, lens: Lens, shutter: Shutter, start: float = 0.0) -> Float32:
    """(V, 3) pixels and depth at which vertices are exposed, `start` (in s of the course) away from mid-exposure."""
    pixels, depths, _ = land(course.powers, lens.numbers, start, shutter.readout_s / course.half_s, lens.camera.size_px[1])
    landed = np.column_stack((pixels, depths)).astype(np.float32)
    landed[np.isnan(pixels[:, 0])] = _BEHIND
    return landed


class Seen:
    """A performer in one picture.

    Attributes:
        performer: who.
        course: of its vertices.
        landed: (V, 3) pixels and depth at mid-exposure.
        moved_px: how far its fastest vertices move in the picture during the exposure.
        box: what it covers, blur included; empty if it is not in the picture.
    """

    def __init__(self, performer: Performer, course: Course, lens: Lens, shutter: Shutter) -> None:
        self.performer = performer
        self.course = course
        self.landed = landing(course, lens, shutter)
        self.moved_px = 0.0
        self.box = Box(0, 0, 0, 0)
        width, height = lens.camera.size_px
        before = self.landed[:, 2] > 0
        if not before.any():
            return
        low, high = self.landed[before, :2].min(0), self.landed[before, :2].max(0)
        some = Course(course.mid_s, course.half_s, np.ascontiguousarray(course.powers[:, ::_EVERY]))
        half = 0.5 * shutter.exposure_s / course.half_s
        first, last = (landing(some, lens, shutter, start) for start in (-half, half))
        inside = ((first[:, :2] >= 0) & (first[:, :2] < (width, height))).all(1) & (first[:, 2] > 0) & (last[:, 2] > 0)
        self.moved_px = float(np.sqrt(((last - first)[inside, :2] ** 2).sum(1)).max(initial=0.0))
        margin = _MARGIN_PX + 0.75 * self.moved_px
        left, top = np.clip(np.floor(low - margin), 0, (width, height)).astype(int).tolist()
        right, bottom = np.clip(np.ceil(high + margin) + 1, 0, (width, height)).astype(int).tolist()
        self.box = Box(left, top, right, bottom)
