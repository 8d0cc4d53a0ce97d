"""What stands and moves before the cameras, at any instant."""

from dataclasses import dataclass
from typing import Protocol

from edge.simulation.surface import Surface
from models.arrays import Float
from models.body.model import Body
from models.body.pose import Pose


class Actor(Protocol):
    """Something that moves: a pupil in his clothes, a ball, a racket."""

    @property
    def surface(self) -> Surface:
        """Triangles, colours and textures; they stay the same while the vertices move."""

    def vertices_m(self, t_s: float) -> Float | None:
        """(V, 3) the surface's vertices in the world, `t_s` seconds from the scene's beginning; None while it is not there."""


class Pupil(Actor, Protocol):
    """A person, of whom more is known than where the skin is."""

    @property
    def name(self) -> str:
        """Code of the pupil, unique in the scene."""

    @property
    def body(self) -> Body:
        """The shape. It may be off the model that fusion fits: see `edge.simulation.people.avatar`."""

    def pose(self, t_s: float) -> Pose:
        """The pose."""

    def joints_m(self, t_s: float) -> Float:
        """(24, 3) the true joints, in the order of `models.skeleton.smpl`."""

    def coco_m(self, t_s: float) -> Float:
        """(23, 3) the true COCO points and points of the feet, in the order of `models.skeleton.coco_feet`."""


@dataclass(frozen=True)
class Lamp:
    """A light.

    Attributes:
        direction: (x, y, z) unit vector towards the light.
        colour: (r, g, b) linear, 1 being as bright as all others together should be.
    """

    direction: tuple[float, float, float]
    colour: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Scene:
    """All that a camera can see.

    Attributes:
        room: what never moves.
        pupils: the persons; the first is the one whom the lesson is about.
        things: balls, rackets.
        lamps: several; `ambient` is what comes from everywhere, linear.
    """

    room: tuple[Surface, ...]
    pupils: tuple[Pupil, ...]
    things: tuple[Actor, ...]
    lamps: tuple[Lamp, ...]
    ambient: tuple[float, float, float] = (0.35, 0.35, 0.35)
