"""What moves, in the graphics library's buffers."""

from typing import TYPE_CHECKING

import numpy as np

from edge.simulation.course import Course
from edge.simulation.meshes import appearance, is_closed, normals, welded
from edge.simulation.scene import Actor
from edge.simulation.shutter import Shutter
from edge.simulation.uniforms import set_surface, texture_of
from models.arrays import Float32

if TYPE_CHECKING:
    import moderngl

_TERMS = 4


class Performer:
    """An actor.

    Attributes:
        actor: the actor.
        faces: (F, 3) its triangles.
        closed: whether its surface has no edge, so that its inner side is never seen.
    """

    def __init__(self, gl: "moderngl.Context", program: "moderngl.Program", actor: Actor) -> None:
        surface = actor.surface
        self.actor = actor
        self.faces = np.ascontiguousarray(surface.faces, np.int32)
        self._welds = welded(np.asarray(surface.vertices_m))
        self.closed = is_closed(self._welds[self.faces])
        self._loaded: Course | None = None
        self._program = program
        count = len(surface.vertices_m)
        self._powers = gl.buffer(reserve=count * _TERMS * 12, dynamic=True)
        self._normals = gl.buffer(reserve=count * 12, dynamic=True)
        self._texture = texture_of(gl, surface)
        layout = [
            (self._powers, "3f 3f 3f 3f", "power_0", "power_1", "power_2", "power_3"),
            (self._normals, "3f", "normal"),
            (gl.buffer(appearance(surface).tobytes()), "3f 2f", "colour", "uv"),
        ]
        self._array = gl.vertex_array(program, layout, index_buffer=gl.buffer(self.faces.tobytes()))

    def load(self, course: Course) -> None:
        """Make it ready to be drawn along a course; kept for the next camera that takes a picture at the same time."""
        if self._loaded is not course:
            self._loaded = course
            self._powers.write(packed(course).tobytes())
            self._normals.write(normals(course.powers[0], self.faces, self._welds).astype(np.float32).tobytes())

    def draw(self, course: Course, shutter: Shutter) -> None:
        """Draw it along the course that was loaded."""
        self._program["readout"] = shutter.readout_s / course.half_s
        set_surface(self._program, self.actor.surface, self._texture)
        self._array.render()


def packed(course: Course) -> Float32:
    """(V, 4, 3) coefficients of each vertex."""
    out = np.zeros((course.powers.shape[1], _TERMS, 3), np.float32)
    out[:, : len(course.powers)] = course.powers.transpose(1, 0, 2)
    return out
