"""What is true of a pupil in one camera's pictures, and what the network said of it: what the twin is fitted to."""

from dataclasses import dataclass

import numpy as np

from models.arrays import Bool, Float
from models.camera.pinhole import Camera
from models.skeleton import coco

VELOCITY_SPAN_S = 1 / 30
"""Velocities are central differences over this span to either side, as pictures at 30 Hz allow."""


@dataclass(frozen=True, eq=False)
class Truth:
    """Pupils before one camera, at the n pictures that were inferred.

    Attributes:
        camera: calibration.
        t_s: (n,) mid-exposure of each picture, ascending.
        points_m: (n, P, 17, 3) true COCO points in the world, each as its row was exposed; the pupil who is looked at first.
        velocity_m_s: (n, 17, 3) of the first pupil's points, over `VELOCITY_SPAN_S`.
        statures_m: (P,) standing heights.
    """

    camera: Camera
    t_s: Float
    points_m: Float
    velocity_m_s: Float
    statures_m: Float

    def __post_init__(self) -> None:
        count, pupils = len(self.t_s), len(self.statures_m)
        _require("points_m", self.points_m, (count, pupils, coco.COUNT, 3))
        _require("velocity_m_s", self.velocity_m_s, (count, coco.COUNT, 3))
        if count == 0 or pupils == 0 or not (np.diff(self.t_s) > 0).all():
            raise ValueError("a truth has pictures in ascending order, and a pupil")

    def __len__(self) -> int:
        return len(self.t_s)


@dataclass(frozen=True, eq=False)
class Said:
    """What the network said of the first pupil in these pictures; NaN where it was not found.

    Attributes:
        keypoints_px: (n, 17, 2) as observed.
        sigma_px: (n, 17).
        score: (n, 17).
        side_px: (n,) of the crop.
        renewed: (n,) whether the track has another number than when the pupil was last found.
        delay_s: (n,) from mid-exposure to arrival; zeros where nothing was awaited.
    """

    keypoints_px: Float
    sigma_px: Float
    score: Float
    side_px: Float
    renewed: Bool
    delay_s: Float

    def __post_init__(self) -> None:
        count = len(self.side_px)
        _require("keypoints_px", self.keypoints_px, (count, coco.COUNT, 2))
        _require("sigma_px", self.sigma_px, (count, coco.COUNT))
        _require("score", self.score, (count, coco.COUNT))
        _require("renewed", self.renewed, (count,))
        _require("delay_s", self.delay_s, (count,))

    @property
    def found(self) -> Bool:
        """(n,) whether there are keypoints."""
        return np.asarray(np.isfinite(self.side_px))


@dataclass(frozen=True, eq=False)
class Stream:
    """One camera over one lesson.

    Attributes:
        lesson: its name.
        seed: of the lesson; those of one seed are left out together.
        truth: what was there.
        said: what the network said of it.
    """

    lesson: str
    seed: int
    truth: Truth
    said: Said

    def __post_init__(self) -> None:
        if len(self.truth) != len(self.said.side_px):
            raise ValueError(f"{self.lesson}: {len(self.truth)} pictures, but words on {len(self.said.side_px)}")


def _require(name: str, value: Float | Bool, shape: tuple[int, ...]) -> None:
    if value.shape != shape:
        raise ValueError(f"{name} must have the shape {shape}, not {value.shape}")
