"""What a pupil looks like, and the triangles that follow from it."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from edge.simulation.people.anatomy import Anatomy
from edge.simulation.people.clothing import Footwear, Legwear, Shirt, sew_bib, sew_footwear, sew_legwear, sew_shirt
from edge.simulation.people.hair import Style, grow, hairline
from edge.simulation.people.paint import Picture
from edge.simulation.people.print import paint_print
from edge.simulation.people.shell import joined
from edge.simulation.people.skin import Colour, paint_face, visible_skin
from edge.simulation.surface import Surface, Texture
from models.arrays import Float
from models.body.model import Body
from models.compiled import Counts

CARRIERS: Final = 4
"""Joints that carry a vertex at most; smaller shares are left out."""
_GLOSS: Final = 0.12


@dataclass(frozen=True)
class Look:
    """Skin, hair and clothes.

    Attributes:
        tone: of the skin, sRGB from 0 to 1, as all colours.
        hair: colour of hair and brows.
        style: of the hair; "scarf" covers it.
        scarf: colour of a scarf.
        iris: colour of the eyes.
        shirt: worn over the legwear.
        legwear: shorts, leggings or trousers.
        footwear: shoes and socks.
        bib: colour of a training bib over the shirt, or None.
        number: on shirt or bib.
        seed: of creases and strands.
    """

    tone: Colour
    hair: Colour
    style: Style
    scarf: Colour
    iris: Colour
    shirt: Shirt
    legwear: Legwear
    footwear: Footwear
    bib: Colour | None = None
    number: int = 7
    seed: int = 0


@dataclass(frozen=True, eq=False)
class Dressed:
    """A clothed body: its surface in the T-pose, and what moves it.

    Attributes:
        surface: skin, hair and clothes, in the T-pose.
        joints: (V, `CARRIERS`) the joints that carry each vertex.
        weights: (V, `CARRIERS`) how much; rows sum to 1.
    """

    surface: Surface
    joints: Counts
    weights: Float


def dress(body: Body, look: Look, detail: int = 1) -> Dressed:
    """Put a look on a body.

    Args:
        body: on the model or off it.
        look: what to wear.
        detail: how often cloth and hair are subdivided: 1 for whom a lesson is about, 0 for who stands far away.
    """
    anatomy = Anatomy(body)
    random = np.random.default_rng((look.seed, 1))
    shirt = sew_shirt(anatomy, look.shirt, detail, random)
    worn = [shirt, sew_legwear(anatomy, look.legwear, detail, random), sew_footwear(anatomy, look.footwear, detail)]
    if look.bib is not None:
        worn.append(sew_bib(anatomy, shirt, look.bib, random))
    worn.append(grow(anatomy, look.style, look.scarf if look.style == "scarf" else look.hair, detail))
    covered = np.max([garment.covered_m for garment in worn], axis=0)
    shell = joined([visible_skin(anatomy, covered, look.tone), *(garment.shell for garment in worn)])
    picture = Picture(random)
    paint_face(picture, anatomy, look.tone, look.hair, look.iris, hairline(look.style))
    paint_print(picture, look.shirt if look.bib is None else None, look.number)
    joints = np.argsort(-shell.weights, axis=1, kind="stable")[:, :CARRIERS]
    weights = np.take_along_axis(shell.weights, joints, axis=1)
    weights /= weights.sum(1, keepdims=True)
    texture = Texture(picture.finished(), shell.uv)
    surface = Surface("pupil", shell.vertices_m, shell.faces, np.clip(shell.colours, 0, 1), _GLOSS, texture)
    return Dressed(surface, np.ascontiguousarray(joints.astype(np.int64)), np.ascontiguousarray(weights))
