"""The room through one camera: its light in each pixel, its depths, and where its ground is. Drawn once, finely."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from edge.simulation.picture import shaders
from edge.simulation.picture.boxes import Box
from edge.simulation.picture.lens import FAR_M, NEAR_M, Lens
from edge.simulation.picture.meshes import corners_of
from edge.simulation.picture.scene import Scene
from edge.simulation.picture.shadows import HIGHEST_M, MOST_MM, NO_GROUND, Millimetres
from edge.simulation.picture.tessellation import tessellate
from edge.simulation.picture.uniforms import set_lamps, set_lens, set_texture, texture_of
from edge.simulation.surface import Surface
from models.arrays import Float32

if TYPE_CHECKING:
    import moderngl

_SAMPLES = 4
"""Across and down in each pixel."""
_TILE_PX = 256
_ANISOTROPY = 8.0


@dataclass(frozen=True, eq=False)
class EmptyRoom:
    """A room through one camera.

    Attributes:
        light: (H, W, 3) linear.
        depths: in metres along the axis, in the four samples of each pixel.
        ground: (H, W, 2) x and y of level ground in each pixel, in millimetres; `NO_GROUND` where there is other than that.
    """

    light: Float32
    depths: "moderngl.Texture"
    ground: Millimetres


@dataclass(frozen=True, eq=False)
class _Piece:
    surface: Surface
    texture: "moderngl.Texture | None"
    buffer: "moderngl.Buffer"
    array: "moderngl.VertexArray"


class RoomPainter:
    """Paints a scene's room for any camera."""

    def __init__(self, gl: "moderngl.Context", scene: Scene) -> None:
        self._gl = gl
        self._room = [(surface, corners_of(surface), texture_of(gl, surface, _ANISOTROPY)) for surface in scene.room]
        self._program = gl.program(shaders.ROOM_VERTEX, shaders.ROOM_FRAGMENT)
        set_lamps(self._program, scene.lamps, scene.ambient)
        self._depths_program = gl.program(shaders.WHOLE_VERTEX, shaders.DEPTHS_FRAGMENT)
        self._depths_program["near_far"] = (NEAR_M, FAR_M)
        self._depths = gl.vertex_array(self._depths_program, [])
        fine = _TILE_PX * _SAMPLES
        self._fine = gl.texture((fine, fine), 4, dtype="f2")
        self._fine_tile = gl.framebuffer([self._fine], gl.depth_renderbuffer((fine, fine)))
        self._tile = gl.framebuffer([gl.texture((_TILE_PX, _TILE_PX), 4, dtype="f4")])
        self._ground_program = gl.program(shaders.ROOM_VERTEX, shaders.GROUND_FRAGMENT)
        self._ground_program["highest"] = HIGHEST_M
        self._average_program = gl.program(shaders.WHOLE_VERTEX, shaders.AVERAGE_FRAGMENT)
        self._average_program["samples"] = _SAMPLES
        self._average = gl.vertex_array(self._average_program, [])

    def paint(self, lens: Lens) -> "EmptyRoom":
        """The room through a lens."""
        with self._pieces(lens) as pieces:
            return EmptyRoom(self._light(lens, pieces), self._sample_depths(lens, pieces), self._ground(lens, pieces))

    @contextmanager
    def _pieces(self, lens: Lens) -> Iterator["list[_Piece]"]:
        """Surfaces cut for the camera."""
        gl, pieces = self._gl, []
        for surface, corners, texture in self._room:
            cut = tessellate(corners, lens)
            if len(cut):
                buffer = gl.buffer(cut.astype(np.float32).tobytes())
                layout = [(buffer, "3f 3f 3f 2f", "place", "normal", "colour", "uv")]
                pieces.append(_Piece(surface, texture, buffer, gl.vertex_array(self._program, layout)))
        try:
            yield pieces
        finally:
            for piece in pieces:
                piece.array.release()
                piece.buffer.release()

    def _draw(self, pieces: "list[_Piece]") -> None:
        self._gl.enable_only(self._gl.DEPTH_TEST)
        for piece in pieces:
            self._program["gloss"] = piece.surface.gloss
            set_texture(self._program, piece.texture)
            piece.array.render()

    def _light(self, lens: Lens, pieces: "list[_Piece]") -> Float32:
        width, height = lens.camera.size_px
        light = np.zeros((height, width, 3), np.float32)
        if not pieces:
            return light
        for top in range(0, height, _TILE_PX):
            for left in range(0, width, _TILE_PX):
                self._fine_tile.use()
                self._fine_tile.clear()
                set_lens(self._program, lens, Box(left, top, left + _TILE_PX, top + _TILE_PX))
                self._draw(pieces)
                self._tile.use()
                self._gl.enable_only(self._gl.NOTHING)
                self._fine.use(0)
                self._average_program["fine"] = 0
                self._average.render(vertices=3)
                drawn = np.frombuffer(self._tile.read(components=3, dtype="f4"), np.float32).reshape(_TILE_PX, _TILE_PX, 3)
                light[top : top + _TILE_PX, left : left + _TILE_PX] = drawn[: height - top, : width - left]
        return light

    def _sample_depths(self, lens: Lens, pieces: "list[_Piece]") -> "moderngl.Texture":
        gl, size = self._gl, lens.camera.size_px
        samples = gl.depth_texture(size, samples=4)
        target = gl.framebuffer([], samples)
        target.use()
        target.clear()
        set_lens(self._program, lens)
        self._draw(pieces)
        # Half precision: 2 mm at 4 m.
        depths = gl.texture(size, 4, dtype="f2")
        depths.filter = (gl.NEAREST, gl.NEAREST)
        out = gl.framebuffer([depths])
        out.use()
        gl.enable_only(gl.NOTHING)
        samples.use(0)
        self._depths_program["depths"] = 0
        self._depths.render(vertices=3)
        for spent in (out, target, samples):
            spent.release()
        return depths

    def _ground(self, lens: Lens, pieces: "list[_Piece]") -> Millimetres:
        gl, (width, height) = self._gl, lens.camera.size_px
        places = gl.texture((width, height), 4, dtype="f4")
        depths = gl.depth_renderbuffer((width, height))
        target = gl.framebuffer([places], depths)
        target.use()
        target.clear(np.nan, np.nan)
        gl.enable_only(gl.DEPTH_TEST)
        set_lens(self._ground_program, lens)
        for piece in pieces:
            array = gl.vertex_array(self._ground_program, [(piece.buffer, "3f 3f 20x", "place", "normal")])
            array.render()
            array.release()
        ground = np.frombuffer(target.read(components=2, dtype="f4"), np.float32).reshape(height, width, 2)
        inside = np.abs(ground) < MOST_MM / 1e3
        millimetres = np.where(inside, 1e3 * np.where(inside, ground, 0.0), NO_GROUND).astype(np.int16)
        for spent in (target, depths, places):
            spent.release()
        return millimetres
