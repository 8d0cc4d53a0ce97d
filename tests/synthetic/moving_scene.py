"""A small scene that is hard on a renderer: bodies that fling arms and legs, one before the other, a ball, a screen in the way."""

from dataclasses import dataclass, field

import numpy as np

from edge.simulation.picture.scene import Lamp, Scene
from edge.simulation.surface import Surface, Texture
from models.arrays import Float
from models.body.model import Body
from models.body.pose import Pose
from models.camera.pinhole import Camera
from models.motions.motion import Motion
from models.skeleton.smpl import INDEX
from tests.bodies import body_model, someone

BARREL = (-0.32, 0.11, 0.002, -0.0015, -0.01)
"""A strong lens: 120 px off in the corners."""


@dataclass(frozen=True, eq=False)
class Flinger:
    """A pupil who runs on the spot and swings arms and legs."""

    body: Body
    name: str
    place_m: tuple[float, float]
    colour: tuple[float, float, float]
    rate_rad_s: float = 15.0
    surface: Surface = field(init=False)

    def __post_init__(self) -> None:
        skin = self.body.rest_vertices_m
        colours = np.tile(self.colour, (len(skin), 1))
        object.__setattr__(self, "surface", Surface(self.name, skin, self.body.model.faces.astype(np.int32), colours, gloss=0.2))

    def pose(self, t_s: float) -> Pose:
        swing = np.sin(self.rate_rad_s * t_s)
        turns = np.zeros((24, 3))
        turns[INDEX["left_shoulder"]] = (0.4, 0.0, 1.4 * swing)
        turns[INDEX["right_shoulder"]] = (0.0, -1.5 * swing, 0.6)
        turns[INDEX["right_elbow"]] = (0.0, 0.0, 1.1 + 0.9 * swing)
        turns[INDEX["left_hip"]] = (0.0, -0.9 * swing, 0.0)
        turns[INDEX["left_knee"]] = (0.0, 0.6 + 0.5 * swing, 0.0)
        turns[INDEX["pelvis"]] = (0.0, 0.0, 0.8 * t_s)
        up = -float(self.body.rest_vertices_m[:, 2].min()) + 0.1 * swing**2
        return Pose(np.array((self.place_m[0] + 0.3 * swing, self.place_m[1], up)), turns)

    def vertices_m(self, t_s: float) -> Float:
        return self.body.vertices_m(self.pose(t_s))

    def joints_m(self, t_s: float) -> Float:
        return self.body.joints_m(self.pose(t_s))

    def coco_m(self, t_s: float) -> Float:
        return self.body.coco_m(self.pose(t_s))


@dataclass(frozen=True, eq=False)
class Moved:
    """A pupil without clothes who performs a motion and keeps still before and after it."""

    body: Body
    motion: Motion
    name: str = "M"

    @property
    def surface(self) -> Surface:
        skin = self.body.rest_vertices_m
        return Surface(self.name, skin, self.body.model.faces.astype(np.int32), np.full((len(skin), 3), 0.6))

    def pose(self, t_s: float) -> Pose:
        return self.motion.pose_at(min(max(t_s, 0.0), self.motion.duration_s))

    def vertices_m(self, t_s: float) -> Float:
        return self.body.vertices_m(self.pose(t_s))

    def joints_m(self, t_s: float) -> Float:
        return self.body.joints_m(self.pose(t_s))

    def coco_m(self, t_s: float) -> Float:
        return self.body.coco_m(self.pose(t_s))


@dataclass(frozen=True, eq=False)
class Flying:
    """A ball that flies past at 15 m/s, or stands still."""

    surface: Surface
    start_m: Float
    velocity_m_s: Float

    def vertices_m(self, t_s: float) -> Float:
        return self.surface.vertices_m + self.start_m + t_s * self.velocity_m_s


def sphere(name: str, radius_m: float, colour: tuple[float, float, float], rings: int = 12) -> Surface:
    """A ball around the origin."""
    polar = np.linspace(0, np.pi, rings + 1)
    around = np.arange(2 * rings) * np.pi / rings
    grid = np.stack(
        (
            np.outer(np.sin(polar), np.cos(around)),
            np.outer(np.sin(polar), np.sin(around)),
            np.outer(np.cos(polar), np.ones(2 * rings)),
        ),
        axis=-1,
    )
    number = np.arange(grid.shape[0] * grid.shape[1]).reshape(grid.shape[:2])
    a, b, c, d = number[:-1], np.roll(number, -1, 1)[:-1], np.roll(number, -1, 1)[1:], number[1:]
    faces = np.concatenate((np.stack((a, d, c), -1).reshape(-1, 3), np.stack((a, c, b), -1).reshape(-1, 3)))
    vertices = radius_m * grid.reshape(-1, 3)
    return Surface(name, vertices, faces.astype(np.int32), np.tile(colour, (len(vertices), 1)))


def quad(name: str, corner: tuple[float, ...], along: tuple[float, ...], up: tuple[float, ...], grey: float) -> Surface:
    """A parallelogram that is seen from where `along` x `up` points to."""
    a, u, v = np.array(corner), np.array(along), np.array(up)
    return Surface(name, np.array((a, a + u, a + u + v, a + v)), np.array(((0, 1, 2), (0, 2, 3)), np.int32), np.full((4, 3), grey))


def room() -> tuple[Surface, ...]:
    """A floor with a pattern, four walls, and a screen that hides the legs of who stands behind it."""
    pattern = np.kron(np.indices((8, 8)).sum(0) % 2, np.ones((16, 16)))[..., None] * np.array((60, 50, 40)) + 120
    floor = quad("floor", (-8.0, -6.0, 0.0), (16.0, 0.0, 0.0), (0.0, 12.0, 0.0), 1.0)
    uv = np.array(((0.0, 0.0), (2.0, 0.0), (2.0, 1.5), (0.0, 1.5)))
    floor = Surface("floor", floor.vertices_m, floor.faces, floor.colours, 0.3, Texture(pattern.astype(np.uint8), uv))
    return (
        floor,
        quad("north", (8.0, 6.0, 0.0), (-16.0, 0.0, 0.0), (0.0, 0.0, 5.0), 0.8),
        quad("south", (-8.0, -6.0, 0.0), (16.0, 0.0, 0.0), (0.0, 0.0, 5.0), 0.8),
        quad("east", (8.0, -6.0, 0.0), (0.0, 12.0, 0.0), (0.0, 0.0, 5.0), 0.6),
        quad("west", (-8.0, 6.0, 0.0), (0.0, -12.0, 0.0), (0.0, 0.0, 5.0), 0.6),
        quad("screen", (-1.4, -0.9, 0.0), (0.0, -1.2, 0.0), (0.0, 0.0, 0.9), 0.3),
    )


def moving_scene(rate_rad_s: float = 15.0) -> Scene:
    """Two pupils, one of whom crosses before the other, a ball and the room."""
    model = body_model()
    pupils = (
        Flinger(model.shaped(someone(model, 1)), "A", (0.0, 0.0), (0.2, 0.7, 0.3), rate_rad_s),
        Flinger(model.shaped(someone(model, 2)), "B", (0.9, 0.7), (0.8, 0.3, 0.2), 0.8 * rate_rad_s),
        Flinger(model.shaped(someone(model, 3)), "C", (0.2, -1.6), (0.3, 0.3, 0.8), 0.5 * rate_rad_s),
    )
    ball = Flying(sphere("ball", 0.12, (0.9, 0.5, 0.1)), np.array((-1.0, -1.2, 1.6)), np.array((2.0, 15.0, -1.0)))
    return Scene(room(), pupils, (ball,), (Lamp((0.0, 0.0, 1.0), (0.3, 0.3, 0.3)), Lamp((0.6, 0.0, 0.8), (0.3, 0.3, 0.3))))


def look_at(
    eye_m: tuple[float, float, float],
    target_m: tuple[float, float, float] = (0.0, 0.0, 0.9),
    focal_px: float = 480.0,
    size_px: tuple[int, int] = (640, 480),
    distortion: tuple[float, ...] = BARREL,
) -> Camera:
    """A camera with a skew, a principal point off the middle and a shift."""
    eye = np.array(eye_m)
    forward = (np.array(target_m) - eye) / np.linalg.norm(np.array(target_m) - eye)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    rotation = np.stack((right, np.cross(forward, right), forward))
    matrix = np.array(((focal_px, 1.5, size_px[0] / 2 + 9), (0.0, 1.01 * focal_px, size_px[1] / 2 - 6), (0.0, 0.0, 1.0)))
    return Camera("cam", size_px, matrix, np.array(distortion), rotation, -rotation @ eye, np.array((3.0, -2.0)))
