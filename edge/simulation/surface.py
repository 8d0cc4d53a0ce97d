"""What the renderer draws: triangles with colours, that stand still, move as a whole, or follow a body's skin."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from models.arrays import Float, UInt8

Faces = npt.NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class Texture:
    """A painted picture.

    Attributes:
        picture: (H, W, 3) sRGB, first row at v = 0.
        uv: (V, 2) place of each vertex in it; 0 to 1 spans it once, beyond that it repeats.
    """

    picture: UInt8
    uv: Float


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles in some frame, in metres.

    Attributes:
        name: for error messages and masks.
        vertices_m: (V, 3).
        faces: (F, 3) indices, counter-clockwise seen from outside.
        colours: (V, 3) sRGB, 0 to 1, more for what shines by itself; multiplied with the texture where there is one.
        gloss: 0 dull to 1 polished, for the highlights of the lamps.
        texture: None is plain colours.
    """

    name: str
    vertices_m: Float
    faces: Faces
    colours: Float
    gloss: float = 0.0
    texture: Texture | None = None
