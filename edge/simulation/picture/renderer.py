"""What a real shutter sees of a scene: linear light in each pixel.

The room does not move: it is drawn once for each camera, finely, with its depth in four samples of each pixel. A picture draws only
what moves, each vertex where it is when the row on which it lands is exposed, four samples a pixel, at several times within the
exposure if it moves fast, and lays that over the room.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from edge.simulation.picture import shaders
from edge.simulation.picture.boxes import Box, joined
from edge.simulation.picture.course import Courses, half_s
from edge.simulation.picture.empty_room import EmptyRoom, RoomPainter
from edge.simulation.picture.graphics import graphics
from edge.simulation.picture.lens import FAR_M, NEAR_M, Lens, lens_of
from edge.simulation.picture.lighting import lamp_numbers
from edge.simulation.picture.performers import Performer, Seen, landing
from edge.simulation.picture.scene import Scene
from edge.simulation.picture.shadows import CELL_M, GroundShadows, Patch, darken
from edge.simulation.picture.shutter import Shutter
from models.arrays import Float32
from models.camera.pinhole import Camera

if TYPE_CHECKING:
    import moderngl

LinearPicture = Float32
"""(H, W, 3) linear red, green, blue; 1 is white in full light."""

_STEP_PX = 1.5
_STEPS = (1, 2, 3, 4, 8, 16)
"""Instants within an exposure."""
_NUDGES = ((0.125, 0.375), (-0.375, 0.125), (0.375, -0.125), (-0.125, -0.375))
"""By how much several instants are drawn beside where they are, one sample at each: together they are as smooth as four."""


class Renderer:
    """Draws one scene through any number of cameras. Belongs to the thread that made it.

    Attributes:
        scene: the scene.
        context: the graphics library's.
        performers: what moves: pupils, then things.
        courses: of the performers.
        shadows: of the performers on the ground.

    Raises:
        UserError: what it needs is not installed; says what to install.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.context = gl = graphics()
        self._painter = RoomPainter(gl, scene)
        self._program = gl.program(shaders.MOVING_VERTEX, shaders.MOVING_FRAGMENT)
        self._lamps, self._ambient = lamp_numbers(scene.lamps), np.array(scene.ambient, np.float64)
        self.performers = [Performer(gl, self._program, actor) for actor in (*scene.pupils, *scene.things)]
        self.courses = Courses([performer.actor for performer in self.performers])
        self.shadows = GroundShadows(scene)
        self._gather = gl.vertex_array(gl.program(shaders.WHOLE_VERTEX, shaders.GATHER_FRAGMENT), [])
        self._gather_single = gl.vertex_array(gl.program(shaders.WHOLE_VERTEX, shaders.GATHER_SINGLE_FRAGMENT), [])
        self._targets: dict[tuple[int, int], _Target] = {}

    def view(self, camera: Camera, shutter: Shutter) -> "View":
        """The scene through a camera. Raises UserError for a camera whose distortion folds the picture."""
        lens = lens_of(camera)
        return View(self, lens, shutter, self._painter.paint(lens))

    def target(self, size_px: tuple[int, int]) -> "_Target":
        """Buffers for pictures of this size, shared by all cameras that have it."""
        if size_px not in self._targets:
            self._targets[size_px] = _Target(self.context, size_px)
        return self._targets[size_px]

    def gather(self, view: "View", cast: Sequence[Seen], box: Box, steps: Sequence[float]) -> Float32:
        """Light and coverage (h, w, 4) of performers within a box of the picture, mean over instants `steps` of their courses."""
        gl, target, program = self.context, self.target(view.camera.size_px), self._program
        many = len(steps) >= len(_NUDGES)
        drawn = target.single if many else target.sampled
        program["size"] = view.camera.size_px
        program["near_far"] = (NEAR_M, FAR_M)
        program["room_depths"] = 1
        for seen in cast:
            seen.performer.light(seen.course, self._lamps, self._ambient, view.camera.centre_m)
        for number, step in enumerate(steps):
            program["nudge"] = _NUDGES[number % len(_NUDGES)] if many else (0.0, 0.0)
            program["only"] = number % len(_NUDGES) if many else -1
            drawn.use()
            drawn.scissor = box.as_viewport
            drawn.clear()
            view.room.depths.use(1)
            for seen in cast:
                seen.performer.draw(seen.landed if len(steps) == 1 else landing(seen.course, view.lens, view.shutter, step))
            target.gathered.use()
            target.gathered.scissor = box.as_viewport
            gl.enable_only(gl.BLEND if number else gl.NOTHING)
            gl.blend_func = gl.ONE, gl.ONE
            gatherer = self._gather_single if many else self._gather
            (target.light if many else target.samples).use(0)
            gatherer.program["samples"] = 0
            gatherer.program["weight"] = 1 / len(steps)
            gatherer.render(vertices=3)
        data = target.gathered.read(viewport=box.as_viewport, components=4, dtype="f4")
        return np.frombuffer(data, np.float32).reshape(box.height, box.width, 4)


class _Target:
    """Buffers to draw into: four samples a pixel, or one, and their mean over the exposure."""

    def __init__(self, gl: "moderngl.Context", size_px: tuple[int, int]) -> None:
        self.samples = gl.texture(size_px, 4, samples=4, dtype="f2")
        self.sampled = gl.framebuffer([self.samples], gl.depth_texture(size_px, samples=4))
        self.light = gl.texture(size_px, 4, dtype="f2")
        self.single = gl.framebuffer([self.light], gl.depth_renderbuffer(size_px))
        self.gathered = gl.framebuffer([gl.texture(size_px, 4, dtype="f4")])


class View:
    """A scene through one camera.

    Attributes:
        renderer: of the scene.
        camera: the camera.
        lens: its lens.
        shutter: its shutter.
        room: what it shows of the empty room.
    """

    def __init__(self, renderer: Renderer, lens: Lens, shutter: Shutter, room: EmptyRoom) -> None:
        self.renderer = renderer
        self.camera = lens.camera
        self.lens = lens
        self.shutter = shutter
        self.room = room

    def picture(self, t_s: float) -> LinearPicture:
        """The picture whose middle row is exposed around `t_s`, in the scene's time."""
        picture = self.room.light.copy()
        self._lay_shadows(picture, t_s)
        cast = []
        for performer, course in zip(self.renderer.performers, self.renderer.courses.at(t_s, self.shutter), strict=True):
            if course is not None:
                seen = Seen(performer, course, self.lens, self.shutter)
                cast += [] if seen.box.empty else [seen]
        for box in joined(seen.box for seen in cast):
            here = [seen for seen in cast if seen.box.touches(box)]
            drawn = self.renderer.gather(self, here, box, self._steps(max(seen.moved_px for seen in here)))
            part = picture[box.top : box.bottom, box.left : box.right]
            part *= 1 - drawn[..., 3:]
            part += drawn[..., :3]
        return picture

    def _lay_shadows(self, picture: LinearPicture, t_s: float) -> None:
        shadows = self.renderer.shadows
        for patch in shadows.cast(t_s):
            box = self._around(patch)
            part = (slice(box.top, box.bottom), slice(box.left, box.right))
            light = shadows.light[patch.row : patch.end_row, patch.column : patch.end_column]
            darken(picture[part], self.room.ground[part], light, shadows.start_m(patch), CELL_M)

    def _around(self, patch: Patch) -> Box:
        """The box of pixels in which a patch of ground may be seen."""
        width, height = self.camera.size_px
        corners = self.renderer.shadows.corners_m(patch)
        pixels = self.lens.project(corners)
        if not np.isfinite(pixels).all():
            return Box(0, 0, width, height)
        left, top = np.clip(np.floor(pixels.min(0)), 0, (width, height)).astype(int).tolist()
        right, bottom = np.clip(np.ceil(pixels.max(0)) + 1, 0, (width, height)).astype(int).tolist()
        return Box(left, top, right, bottom)

    def _steps(self, moved_px: float) -> list[float]:
        """Instants of the exposure, evenly, so close that what moves leaves no gaps."""
        wanted = moved_px / _STEP_PX
        count = next((number for number in _STEPS if number >= wanted), _STEPS[-1])
        even = (np.arange(count) + 0.5) / count - 0.5
        return [float(step) for step in even * self.shutter.exposure_s / half_s(self.shutter)]
