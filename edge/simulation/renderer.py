"""What a real shutter sees of a scene: linear light in each pixel.

The room does not move: it is drawn once for each camera, finely, with its depth in four samples of each pixel. A picture draws only
what moves, each vertex where it is when the row on which it lands is exposed, four samples a pixel, at several times within the
exposure if it moves fast, and lays that over the room.
"""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from edge.simulation import shaders
from edge.simulation.boxes import Box, joined
from edge.simulation.course import Course, Courses, half_s
from edge.simulation.empty_room import RoomPainter
from edge.simulation.graphics import open_context
from edge.simulation.lens import Lens, land, lens_of
from edge.simulation.performers import Performer
from edge.simulation.scene import Scene
from edge.simulation.shutter import Shutter
from edge.simulation.uniforms import set_lamps, set_lens
from models.arrays import Float32
from models.camera.pinhole import Camera

if TYPE_CHECKING:
    import moderngl

LinearPicture = Float32
"""(H, W, 3) linear red, green, blue; 1 is white in full light."""

_STEP_PX = 1.5
_MOST_STEPS = 8
_MARGIN_PX = 3


class Renderer:
    """Draws one scene through any number of cameras. Belongs to the thread that made it.

    Attributes:
        scene: the scene.
        context: the graphics library's.
        performers: what moves: pupils, then things.
        courses: of the performers.

    Raises:
        UserError: what it needs is not installed; says what to install.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.context = gl = open_context()
        self._painter = RoomPainter(gl, scene)
        self._program = gl.program(shaders.MOVING_VERTEX, shaders.MOVING_FRAGMENT)
        set_lamps(self._program, scene.lamps, scene.ambient)
        self.performers = [Performer(gl, self._program, actor) for actor in (*scene.pupils, *scene.things)]
        self.courses = Courses([performer.actor for performer in self.performers])
        self._gather_program = gl.program(shaders.WHOLE_VERTEX, shaders.GATHER_FRAGMENT)
        self._gather = gl.vertex_array(self._gather_program, [])
        self._targets: dict[tuple[int, int], _Target] = {}
        # Row 0 is drawn at the bottom: what goes round counter-clockwise in the world goes round clockwise here.
        gl.front_face = "cw"

    def view(self, camera: Camera, shutter: Shutter) -> "View":
        """The scene through a camera. Raises UserError for a camera whose distortion folds the picture."""
        lens = lens_of(camera)
        return View(self, lens, shutter, *self._painter.paint(lens))

    def target(self, size_px: tuple[int, int]) -> "_Target":
        """Buffers for pictures of this size, shared by all cameras that have it."""
        if size_px not in self._targets:
            self._targets[size_px] = _Target(self.context, size_px)
        return self._targets[size_px]

    def gather(self, view: "View", cast: "Sequence[_Seen]", box: Box, steps: Sequence[float]) -> Float32:
        """Light and coverage (h, w, 4) of performers within a box of the picture, mean over instants `steps` of their courses."""
        gl, target, program = self.context, self.target(view.camera.size_px), self._program
        set_lens(program, view.lens)
        view.room_depths.use(1)
        program["room_depths"] = 1
        self._gather_program["samples"] = 0
        self._gather_program["weight"] = 0.25 / len(steps)
        for number, step in enumerate(steps):
            program["start"] = step
            target.sampled.use()
            target.sampled.scissor = box.as_viewport
            target.sampled.clear()
            for seen in cast:
                seen.performer.load(seen.course)
                gl.enable_only(gl.DEPTH_TEST | gl.CULL_FACE if seen.performer.closed else gl.DEPTH_TEST)
                seen.performer.draw(seen.course, view.shutter)
            target.gathered.use()
            target.gathered.scissor = box.as_viewport
            gl.enable_only(gl.BLEND if number else gl.NOTHING)
            gl.blend_func = gl.ONE, gl.ONE
            target.samples.use(0)
            self._gather.render(vertices=3)
        data = target.gathered.read(viewport=box.as_viewport, components=4, dtype="f4")
        return np.frombuffer(data, np.float32).reshape(box.height, box.width, 4)


class _Target:
    """Buffers to draw into: four samples a pixel, and their mean over the exposure."""

    def __init__(self, gl: "moderngl.Context", size_px: tuple[int, int]) -> None:
        self.samples = gl.texture(size_px, 4, samples=4, dtype="f2")
        self.sampled = gl.framebuffer([self.samples], gl.depth_texture(size_px, samples=4))
        self.gathered = gl.framebuffer([gl.texture(size_px, 4, dtype="f4")])


class _Seen:
    """A performer in one picture: the box that it covers, and how far its fastest vertex moves during the exposure."""

    def __init__(self, performer: Performer, course: Course, lens: Lens, shutter: Shutter) -> None:
        self.performer = performer
        self.course = course
        width, height = lens.camera.size_px
        readout = shutter.readout_s / course.half_s
        edge = 0.5 * shutter.exposure_s / course.half_s
        first, last = (land(course.powers, lens.numbers, start, readout, height)[0] for start in (-edge, edge))
        inside = ((first > -_MARGIN_PX) & (first < np.array((width, height)) + _MARGIN_PX)).all(1)
        self.moved_px = float(np.sqrt(((last - first)[inside] ** 2).sum(1)).max(initial=0.0))
        every = np.concatenate((first, last))
        every = every[np.isfinite(every).all(1)]
        if not len(every):
            self.box = Box(0, 0, 0, 0)
            return
        left, top = np.clip(np.floor(every.min(0)) - _MARGIN_PX, 0, (width, height)).astype(int).tolist()
        right, bottom = np.clip(np.ceil(every.max(0)) + _MARGIN_PX + 1, 0, (width, height)).astype(int).tolist()
        self.box = Box(left, top, right, bottom)


class View:
    """A scene through one camera.

    Attributes:
        renderer: of the scene.
        camera: the camera.
        lens: its lens.
        shutter: its shutter.
        room: (H, W, 3) linear light of the empty room.
        room_depths: its depths in the four samples of each pixel.
    """

    def __init__(self, renderer: Renderer, lens: Lens, shutter: Shutter, room: LinearPicture, depths: "moderngl.Texture") -> None:
        self.renderer = renderer
        self.camera = lens.camera
        self.lens = lens
        self.shutter = shutter
        self.room = room
        self.room_depths = depths

    def picture(self, t_s: float) -> LinearPicture:
        """The picture whose middle row is exposed around `t_s`, in the scene's time."""
        picture = self.room.copy()
        cast = []
        for performer, course in zip(self.renderer.performers, self.renderer.courses.at(t_s, self.shutter), strict=True):
            if course is not None:
                seen = _Seen(performer, course, self.lens, self.shutter)
                cast += [] if seen.box.empty else [seen]
        for box in joined(seen.box for seen in cast):
            here = [seen for seen in cast if seen.box.touches(box)]
            drawn = self.renderer.gather(self, here, box, self._steps(max(seen.moved_px for seen in here)))
            part = picture[box.top : box.bottom, box.left : box.right]
            part *= 1 - drawn[..., 3:]
            part += drawn[..., :3]
        return picture

    def _steps(self, moved_px: float) -> list[float]:
        """Instants of the exposure, evenly, so close that what moves leaves no gaps."""
        count = min(max(math.ceil(moved_px / _STEP_PX), 1), _MOST_STEPS)
        even = (np.arange(count) + 0.5) / count - 0.5
        return [float(step) for step in even * self.shutter.exposure_s / half_s(self.shutter)]
