"""What the shaders are told: camera, part of the picture, lamps, and the surface that is drawn."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from edge.simulation.picture.boxes import Box
from edge.simulation.picture.lens import FAR_M, NEAR_M, Lens
from edge.simulation.picture.meshes import texels
from edge.simulation.picture.scene import Lamp
from edge.simulation.surface import Surface

if TYPE_CHECKING:
    import moderngl

_MOST_LAMPS = 8
_SRGB8_ALPHA8 = 0x8C43
_PICTURE_UNIT = 2


def set_lamps(program: "moderngl.Program", lamps: Sequence[Lamp], ambient: tuple[float, float, float]) -> None:
    """Where light comes from.

    Raises:
        ValueError: there are more lamps than a shader takes.
    """
    if len(lamps) > _MOST_LAMPS:
        raise ValueError(f"a scene has at most {_MOST_LAMPS} lamps, not {len(lamps)}")
    spare = [(0.0, 0.0, 0.0)] * (_MOST_LAMPS - len(lamps))
    program["lamps"] = len(lamps)
    program["lamp_directions"] = [lamp.direction for lamp in lamps] + spare
    program["lamp_colours"] = [lamp.colour for lamp in lamps] + spare
    program["ambient"] = ambient


def set_lens(program: "moderngl.Program", lens: Lens, box: Box | None = None) -> None:
    """The camera, and which part of its picture fills the target; None is all of it."""
    numbers = lens.numbers.tolist()
    width, height = lens.camera.size_px
    values = {
        "rotation": lens.camera.rotation.T.ravel().tolist(),
        "translation": numbers[9:12],
        "focal": numbers[12:17],
        "distortion": numbers[17:22],
        "field_limit": lens.limit,
        "near_far": (NEAR_M, FAR_M),
        "eye": lens.camera.centre_m.tolist(),
        "size": (width, height),
        "window": (0, 0, width, height) if box is None else box.as_viewport,
    }
    for name, value in values.items():
        if name in program:
            program[name] = value


def set_texture(program: "moderngl.Program", texture: "moderngl.Texture | None") -> None:
    """The texture of what is drawn next, if it has one."""
    program["textured"] = texture is not None
    program["picture"] = _PICTURE_UNIT
    if texture is not None:
        texture.use(_PICTURE_UNIT)


def texture_of(gl: "moderngl.Context", surface: Surface, anisotropy: float) -> "moderngl.Texture | None":
    """A surface's texture with its mip maps; `anisotropy` for floors that are seen aslant."""
    if surface.texture is None:
        return None
    data = texels(surface.texture)
    height, width = data.shape[:2]
    texture = gl.texture((width, height), 4, data.tobytes(), internal_format=_SRGB8_ALPHA8)
    texture.build_mipmaps()
    texture.filter = (gl.LINEAR_MIPMAP_LINEAR if anisotropy > 1 else gl.LINEAR_MIPMAP_NEAREST, gl.LINEAR)
    texture.anisotropy = anisotropy
    return texture
