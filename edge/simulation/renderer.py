"""What a real shutter sees of a scene: linear light in each pixel.

The room does not move: it is drawn once for each camera, finely, with its depth in four samples of each pixel. A picture draws only
what moves, each vertex where it is when the row on which it lands is exposed, four samples a pixel, at several times within the
exposure if it moves fast, and lays that over the room. Contact shadows darken the room below.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from edge.simulation import shaders
from edge.simulation.boxes import Box, joined
from edge.simulation.course import Course, course_of, half_s
from edge.simulation.graphics import open_context
from edge.simulation.lens import FAR_M, NEAR_M, Lens, land, lens_of
from edge.simulation.meshes import appearance, corners_of, normals, texels, welded
from edge.simulation.scene import Actor, Scene
from edge.simulation.shutter import Shutter
from edge.simulation.surface import Faces, Surface
from edge.simulation.tessellation import tessellate
from models.arrays import Float, Float32
from models.camera.pinhole import Camera
from models.compiled import Counts

if TYPE_CHECKING:
    import moderngl

LinearPicture = Float32
"""(H, W, 3) linear red, green, blue; 1 is white in full light."""

_MOST_LAMPS = 8
_ROOM_SAMPLES = 4
_TILE_PX = 256
_SRGB8_ALPHA8 = 0x8C43
_STEP_PX = 1.5
_MOST_STEPS = 8
_MARGIN_PX = 3


@dataclass(eq=False)
class Performer:
    """An actor on the graphics card, and where it is in the picture that is being taken."""

    actor: Actor
    faces: Faces
    welds: Counts
    powers: "moderngl.Buffer"
    normals: "moderngl.Buffer"
    vertex_array: "moderngl.VertexArray"
    texture: "moderngl.Texture | None"
    taken: tuple[float, Shutter] | None = None
    course: Course | None = None

    def take(self, t_s: float, shutter: Shutter) -> None:
        """Fill the buffers for a picture."""
        self.taken = (t_s, shutter)
        self.course = course = course_of(self.actor.vertices_m, t_s, shutter)
        if course is None:
            return
        packed = np.zeros((course.powers.shape[1], 4, 3), np.float32)
        packed[:, : len(course.powers)] = course.powers.transpose(1, 0, 2)
        self.powers.write(packed.tobytes())
        self.normals.write(normals(course.powers[0], self.faces, self.welds).astype(np.float32).tobytes())


class Renderer:
    """Draws one scene through any number of cameras. Belongs to the thread that made it.

    Raises:
        UserError: what it needs is not installed; says what to install.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.context = open_context()
        gl = self.context
        self._room_program = gl.program(shaders.ROOM_VERTEX, shaders.ROOM_FRAGMENT)
        self._moving_program = gl.program(shaders.MOVING_VERTEX, shaders.MOVING_FRAGMENT)
        self._depths_program = gl.program(shaders.WHOLE_VERTEX, shaders.DEPTHS_FRAGMENT)
        self._gather_program = gl.program(shaders.WHOLE_VERTEX, shaders.GATHER_FRAGMENT)
        self._depths = gl.vertex_array(self._depths_program, [])
        self._gather = gl.vertex_array(self._gather_program, [])
        self._performers = [self._performer(actor) for actor in (*scene.pupils, *scene.things)]
        for program in (self._room_program, self._moving_program):
            _light(program, scene)
        self._targets: dict[tuple[int, int], _Target] = {}

    def view(self, camera: Camera, shutter: Shutter) -> "View":
        """The scene through a camera. Raises UserError for a camera whose distortion folds the picture."""
        return View(self, camera, shutter)

    def _performer(self, actor: Actor) -> Performer:
        gl, surface = self.context, actor.surface
        count = len(surface.vertices_m)
        faces = np.ascontiguousarray(surface.faces, np.int32)
        powers, facing = gl.buffer(reserve=count * 48, dynamic=True), gl.buffer(reserve=count * 12, dynamic=True)
        looks = gl.buffer(appearance(surface).tobytes())
        vertex_array = gl.vertex_array(
            self._moving_program,
            [
                (powers, "3f 3f 3f 3f", "power_0", "power_1", "power_2", "power_3"),
                (facing, "3f", "normal"),
                (looks, "3f 2f", "colour", "uv"),
            ],
            index_buffer=gl.buffer(faces.tobytes()),
        )
        welds = welded(np.asarray(surface.vertices_m))
        return Performer(actor, faces, welds, powers, facing, vertex_array, self.texture(surface))

    def texture(self, surface: Surface) -> "moderngl.Texture | None":
        """A surface's texture with its mip maps."""
        if surface.texture is None:
            return None
        data = texels(surface.texture)
        height, width = data.shape[:2]
        texture = self.context.texture((width, height), 4, data.tobytes(), internal_format=_SRGB8_ALPHA8)
        texture.build_mipmaps()
        texture.filter = (self.context.LINEAR_MIPMAP_LINEAR, self.context.LINEAR)
        texture.anisotropy = 8.0
        return texture

    def performers(self, t_s: float, shutter: Shutter) -> list[tuple[Performer, Course]]:
        """Those that are there, with their courses in their buffers; what another camera needed at the same time is kept."""
        for performer in self._performers:
            if performer.taken != (t_s, shutter):
                performer.take(t_s, shutter)
        return [(performer, performer.course) for performer in self._performers if performer.course is not None]

    def target(self, size_px: tuple[int, int]) -> "_Target":
        """Buffers for pictures of this size, shared by all cameras that have it."""
        if size_px not in self._targets:
            self._targets[size_px] = _Target(self.context, size_px)
        return self._targets[size_px]

    def draw_room(self, lens: Lens, triangles: Sequence[Float]) -> tuple[LinearPicture, "moderngl.Texture"]:
        """The room's light (H, W, 3), and its depths along the axis in the four samples of each pixel."""
        gl = self.context
        width, height = lens.camera.size_px
        drawables = []
        for surface, corners in zip(self.scene.room, triangles, strict=True):
            if len(corners):
                buffer = gl.buffer(corners.astype(np.float32).tobytes())
                layout = [(buffer, "3f 3f 3f 2f", "place", "normal", "colour", "uv")]
                array = gl.vertex_array(self._room_program, layout)
                drawables.append((surface, self.texture(surface), buffer, array))

        def draw() -> None:
            for surface, texture, _, array in drawables:
                _dress(self._room_program, surface, texture)
                array.render()

        _look(self._room_program, lens)
        gl.enable_only(gl.DEPTH_TEST)
        light = np.empty((height, width, 3), np.float32)
        fine = _TILE_PX * _ROOM_SAMPLES
        tile = gl.framebuffer([gl.texture((fine, fine), 4, dtype="f4")], gl.depth_renderbuffer((fine, fine)))
        for top in range(0, height, _TILE_PX):
            for left in range(0, width, _TILE_PX):
                tile.use()
                tile.clear()
                _window(self._room_program, lens, Box(left, top, left + _TILE_PX, top + _TILE_PX))
                draw()
                drawn = np.frombuffer(tile.read(components=3, dtype="f4"), np.float32)
                drawn = drawn.reshape(_TILE_PX, _ROOM_SAMPLES, _TILE_PX, _ROOM_SAMPLES, 3).mean((1, 3))
                light[top : top + _TILE_PX, left : left + _TILE_PX] = drawn[: height - top, : width - left]
        target = self.target(lens.camera.size_px)
        target.sampled.use()
        target.sampled.clear()
        _window(self._room_program, lens, None)
        draw()
        depths = gl.texture(lens.camera.size_px, 4, dtype="f4")
        depths.filter = (gl.NEAREST, gl.NEAREST)
        gl.framebuffer([depths]).use()
        gl.enable_only(gl.NOTHING)
        target.depth_samples.use(0)
        self._depths_program["depths"] = 0
        self._depths_program["near_far"] = (NEAR_M, FAR_M)
        self._depths.render(vertices=3)
        for _, texture, buffer, array in drawables:
            for thing in (texture, buffer, array):
                if thing is not None:
                    thing.release()
        return light, depths

    def draw_moving(
        self, view: "View", performers: Sequence[tuple[Performer, Course]], steps: Sequence[float], boxes: Sequence[Box]
    ) -> None:
        """Gather light and coverage of what moves, at instants `steps` of the course, within boxes of the picture's target."""
        gl, target, program = self.context, self.target(view.camera.size_px), self._moving_program
        _look(program, view.lens)
        _window(program, view.lens, None)
        view.room_depths.use(1)
        program["room_depths"] = 1
        target.samples.use(0)
        self._gather_program["samples"] = 0
        self._gather_program["weight"] = 0.25 / len(steps)
        for number, step in enumerate(steps):
            program["start"] = step
            for box in boxes:
                target.sampled.use()
                gl.enable_only(gl.DEPTH_TEST)
                target.sampled.scissor = box.as_viewport
                target.sampled.clear()
                for performer, course in performers:
                    program["readout"] = view.shutter.readout_s / course.half_s
                    _dress(program, performer.actor.surface, performer.texture)
                    performer.vertex_array.render()
                target.gathered.use()
                target.gathered.scissor = box.as_viewport
                gl.enable_only(gl.BLEND if number else gl.NOTHING)
                gl.blend_func = gl.ONE, gl.ONE
                target.samples.use(0)
                self._gather.render(vertices=3)


class _Target:
    """Buffers to draw into: four samples a pixel, and their mean over the exposure."""

    def __init__(self, gl: "moderngl.Context", size_px: tuple[int, int]) -> None:
        self.samples = gl.texture(size_px, 4, samples=4, dtype="f2")
        self.depth_samples = gl.depth_texture(size_px, samples=4)
        self.sampled = gl.framebuffer([self.samples], self.depth_samples)
        self.gathered = gl.framebuffer([gl.texture(size_px, 4, dtype="f4")])

    def read(self, box: Box) -> Float32:
        """(h, w, 4) light, premultiplied, and coverage."""
        data = self.gathered.read(viewport=box.as_viewport, components=4, dtype="f4")
        return np.frombuffer(data, np.float32).reshape(box.height, box.width, 4)


class View:
    """A scene through one camera.

    Attributes:
        camera: the camera.
        shutter: its shutter.
        lens: its lens.
        room: (H, W, 3) linear light of the empty room.
    """

    def __init__(self, renderer: Renderer, camera: Camera, shutter: Shutter) -> None:
        self.camera = camera
        self.shutter = shutter
        self.lens = lens_of(camera)
        self._renderer = renderer
        triangles = [tessellate(corners_of(surface), self.lens) for surface in renderer.scene.room]
        self.room, self.room_depths = renderer.draw_room(self.lens, triangles)

    def picture(self, t_s: float) -> LinearPicture:
        """The picture whose middle row is exposed around `t_s`."""
        performers = self._renderer.performers(t_s, self.shutter)
        boxes, fastest_px = [], 0.0
        for _, course in performers:
            box, moved_px = self._covered(course)
            if box is not None:
                boxes.append(box)
                fastest_px = max(fastest_px, moved_px)
        picture = self.room.copy()
        boxes = joined(boxes)
        if not boxes:
            return picture
        half = half_s(self.shutter)
        count = min(max(math.ceil(fastest_px / _STEP_PX), 1), _MOST_STEPS)
        within = ((np.arange(count) + 0.5) / count - 0.5) * self.shutter.exposure_s / half
        self._renderer.draw_moving(self, performers, [float(step) for step in within], boxes)
        target = self._renderer.target(self.camera.size_px)
        for box in boxes:
            drawn = target.read(box)
            part = picture[box.top : box.bottom, box.left : box.right]
            part *= 1 - drawn[..., 3:]
            part += drawn[..., :3]
        return picture

    def _covered(self, course: Course) -> tuple[Box | None, float]:
        """The box that a course covers, and how far its fastest vertex moves during the exposure, in pixels."""
        width, height = self.camera.size_px
        readout = self.shutter.readout_s / course.half_s
        edge = 0.5 * self.shutter.exposure_s / course.half_s
        ends = [land(course.powers, self.lens.numbers, start, readout, height)[0] for start in (-edge, edge)]
        inside = ((ends[0] > -_MARGIN_PX) & (ends[0] < np.array((width, height)) + _MARGIN_PX)).all(1)
        moved = np.sqrt(((ends[1] - ends[0])[inside] ** 2).sum(1)).max(initial=0.0)
        every = np.concatenate(ends)
        every = every[np.isfinite(every).all(1)]
        if not len(every):
            return None, 0.0
        low, high = np.floor(every.min(0)) - _MARGIN_PX, np.ceil(every.max(0)) + _MARGIN_PX + 1
        return Box(int(max(low[0], 0)), int(max(low[1], 0)), int(min(high[0], width)), int(min(high[1], height))), float(moved)


def _light(program: "moderngl.Program", scene: Scene) -> None:
    lamps = scene.lamps[:_MOST_LAMPS]
    spare = [(0.0, 0.0, 0.0)] * (_MOST_LAMPS - len(lamps))
    program["lamps"] = len(lamps)
    program["lamp_directions"] = [lamp.direction for lamp in lamps] + spare
    program["lamp_colours"] = [lamp.colour for lamp in lamps] + spare
    program["ambient"] = scene.ambient


def _look(program: "moderngl.Program", lens: Lens) -> None:
    numbers = lens.numbers.tolist()
    program["rotation"] = lens.camera.rotation.T.ravel().tolist()
    program["translation"] = numbers[9:12]
    program["focal"] = numbers[12:17]
    program["distortion"] = numbers[17:22]
    program["field_limit"] = lens.limit
    program["near_far"] = (NEAR_M, FAR_M)
    program["eye"] = lens.camera.centre_m.tolist()
    if "size" in program:
        program["size"] = lens.camera.size_px


def _window(program: "moderngl.Program", lens: Lens, box: Box | None) -> None:
    width, height = lens.camera.size_px
    program["window"] = (0, 0, width, height) if box is None else (box.left, box.top, box.width, box.height)


def _dress(program: "moderngl.Program", surface: Surface, texture: "moderngl.Texture | None") -> None:
    program["gloss"] = surface.gloss
    program["textured"] = texture is not None
    program["picture"] = 2
    if texture is not None:
        texture.use(2)
