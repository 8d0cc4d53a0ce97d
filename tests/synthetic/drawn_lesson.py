"""A lesson whose joints are drawn as dots, each in a colour of its own, and networks that find just these dots.

So everything from the picture to the joints in space runs, but for the networks, and every place is known to a tenth of a pixel.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import cast

import cv2
import numpy as np

from edge.observe import Networks
from models.arrays import Float, UInt8
from models.camera.rig import Rig
from models.messages.control import PoseNetwork as PoseNetworkName
from models.skeleton import coco
from tests.bench.reconstruct.lesson import START_NS, Lesson, PictureTruth, Span
from tests.fake_networks import FakeEstimate
from tests.synthetic.gym import ring_rig
from tests.synthetic.person import Person

RATE_HZ = 30.0
_RADIUS_PX = 6
_STEPS = coco.COUNT + 1
_SHIFT = 4
"""Bits of a pixel in which dots are placed."""


@dataclass(frozen=True, eq=False)
class DrawnFrame:
    """See `edge.cameras.source.Frame`."""

    camera: str
    index: int
    t_mid_ns: int
    size_px: tuple[int, int]
    points_px: Float
    epoch: int = 0

    def image(self, reduction: int = 1) -> UInt8:
        """Blue says that there is a dot, red over blue which joint it is, also where it is blended with the black around it."""
        picture = np.zeros((self.size_px[1], self.size_px[0], 3), np.uint8)
        for joint, place in enumerate(self.points_px):
            centre = tuple(round(float(value) * 2**_SHIFT) for value in place)
            colour = (round(255 * (joint + 1) / _STEPS), 0, 255)
            cv2.circle(picture, centre, _RADIUS_PX * 2**_SHIFT, colour, -1, cv2.LINE_AA, _SHIFT)
        if reduction == 1:
            return picture
        size = (-(-self.size_px[0] // reduction), -(-self.size_px[1] // reduction))
        return cast(UInt8, cv2.resize(picture, size, interpolation=cv2.INTER_AREA))


@dataclass
class DotPose:
    """Finds the dots; where one is hidden, the crop's middle with a low score."""

    name: PoseNetworkName = "thunder"
    size_px: int = 256

    def estimate(self, crop_rgb: UInt8) -> FakeEstimate:
        weight = crop_rgb[..., 2].astype(np.float64)
        rows, columns = np.nonzero(weight > 40)
        strength = weight[rows, columns]
        joints = np.rint(crop_rgb[rows, columns, 0] * (_STEPS / strength)).astype(int) - 1
        known = (joints >= 0) & (joints < coco.COUNT)
        rows, columns, strength, joints = rows[known], columns[known], strength[known], joints[known]
        mass = np.bincount(joints, strength, coco.COUNT)
        safe = np.maximum(mass, 1.0)
        places = [np.bincount(joints, strength * (axis + 0.5), coco.COUNT) / safe for axis in (columns, rows)]
        seen = mass > 255 * 10
        points = np.where(seen[:, None], np.stack(places, axis=1) / self.size_px, 0.5)
        score = np.where(seen, 0.9, 0.05).astype(np.float32)
        return FakeEstimate(points.astype(np.float32), score, np.full(coco.COUNT, 1 / self.size_px, np.float32))


class DotDetector:
    """One box around all dots."""

    def detect(self, image_rgb: UInt8) -> tuple[Float, Float]:
        rows, columns = np.nonzero(image_rgb[..., 2] > 40)
        if not len(rows):
            return np.empty((0, 4)), np.empty(0)
        box = (columns.min(), rows.min(), columns.max(), rows.max())
        return np.array([box], np.float64), np.ones(1)


def dot_networks() -> Networks:
    """Networks for drawn lessons."""
    detector = DotDetector()
    return Networks(DotPose(), lambda: detector)


def drawn_lesson(
    length_s: float = 2.0, cameras: int = 4, phases_s: Sequence[float] = (), person: Person | None = None, seed: int = 0
) -> Lesson:
    """A person who walks and throws, taken for half of the time as one action and for the other as another.

    Args:
        length_s: of the lesson.
        cameras: how many.
        phases_s: by how much each camera exposes later than at whole frames.
        person: who.
        seed: what the lesson says of itself.
    """
    who, rig = person or Person(), ring_rig(cameras, distorted=True)
    phases = tuple(phases_s) or (0.0,) * cameras
    times = {c.name: phase + np.arange(round(length_s * RATE_HZ)) / RATE_HZ for c, phase in zip(rig, phases, strict=True)}

    def truth_m(times_s: Float) -> Float:
        return np.stack([who.joints(float(t)) for t in times_s])

    return Lesson(
        name=f"drawn-{seed}",
        seed=seed,
        pupil="nobody",
        identity=f"drawn {length_s} {cameras} {phases} {who} {seed}",
        rig=rig,
        length_s=length_s,
        spans=(Span("badminton_clear", 0.3, 0.5 * length_s), Span("forward_roll", 0.5 * length_s + 0.05, length_s - 0.05)),
        frames=lambda names: _frames(rig, times, names, truth_m),
        truth_m=truth_m,
        stature_m=who.height_m,
        pictures={camera.name: _truth(rig, camera.name, times[camera.name], truth_m(times[camera.name])) for camera in rig},
    )


def _truth(rig: Rig, name: str, times_s: Float, points_m: Float) -> PictureTruth:
    points_px = rig.cameras[rig.index(name)].project(points_m)
    return PictureTruth(times_s, points_m, points_px, np.ones(points_px.shape[:2], np.bool_))


def _frames(rig: Rig, times: dict[str, Float], names: Sequence[str], truth_m: Callable[[Float], Float]) -> Iterator[DrawnFrame]:
    order = sorted((float(t), name, index) for name in names for index, t in enumerate(times[name]))
    for t_s, name, index in order:
        camera = rig.cameras[rig.index(name)]
        points = camera.project(truth_m(np.array([t_s])))[0]
        yield DrawnFrame(name, index, START_NS + int(np.ceil(t_s * 1e9)), camera.size_px, points)
