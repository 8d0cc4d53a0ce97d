"""Bright balls fixed to points of a moving body, alone in the dark, and where a picture shows them."""

from dataclasses import dataclass, field

import numpy as np

from edge.simulation.picture.renderer import LinearPicture
from edge.simulation.picture.scene import Lamp, Pupil, Scene
from edge.simulation.surface import Surface
from models.arrays import Float
from tests.synthetic.moving_scene import sphere

RADIUS_M = 0.02


@dataclass(frozen=True, eq=False)
class Markers:
    """A ball at each COCO point and point of the feet of a pupil."""

    pupil: Pupil
    numbers: tuple[int, ...]
    surface: Surface = field(init=False)

    def __post_init__(self) -> None:
        ball = sphere("marker", RADIUS_M, (1.0, 1.0, 1.0), rings=5)
        count = len(self.numbers)
        vertices = np.tile(ball.vertices_m, (count, 1)) + np.repeat(np.arange(count), len(ball.vertices_m))[:, None] * 1.0
        faces = np.concatenate([ball.faces + number * len(ball.vertices_m) for number in range(count)])
        object.__setattr__(self, "surface", Surface("markers", vertices, faces.astype(np.int32), np.ones((len(vertices), 3))))
        object.__setattr__(self, "_ball", ball.vertices_m)

    def vertices_m(self, t_s: float) -> Float:
        points = self.pupil.coco_m(t_s)[list(self.numbers)]
        ball: Float = self._ball  # type: ignore[attr-defined]
        return (points[:, None] + ball).reshape(-1, 3)


def in_the_dark(pupil: Pupil, numbers: tuple[int, ...]) -> Scene:
    """Nothing but the markers of some of a pupil's points, as bright from below as from above."""
    return Scene((), (), (Markers(pupil, numbers),), (Lamp((0.0, 0.0, -1.0), (0.4, 0.4, 0.4)),), ambient=(1.0, 1.0, 1.0))


def centroids_px(picture: LinearPicture, expected_px: Float, half_px: int, apart_px: int) -> Float:
    """(K, 2) centroids by intensity of the markers that were expected there; NaN for those that others are too near to.

    Each is looked for within `half_px` of where it is expected, or within less, so that others reach within `apart_px` of theirs.
    """
    height, width = picture.shape[:2]
    light = picture[..., 1]
    found = np.full(expected_px.shape, np.nan)
    for number, (x, y) in enumerate(expected_px):
        apart = np.linalg.norm(expected_px - (x, y), axis=1)
        apart[number] = np.inf
        half = int(min(half_px, apart.min() / np.sqrt(2) - apart_px))
        if half < apart_px or not (half < x < width - half - 1 and half < y < height - half - 1):
            continue
        left, top = round(x) - half, round(y) - half
        window = light[top : top + 2 * half + 1, left : left + 2 * half + 1]
        total = window.sum()
        rows, columns = np.indices(window.shape)
        if total > 0:
            found[number] = left + (columns * window).sum() / total, top + (rows * window).sum() / total
    return found
