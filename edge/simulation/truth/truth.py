"""What is true in pictures of a lesson: where the pupils' joints and points are, in world and pictures, and what hides them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from edge.simulation.picture.shutter import Shutter
from edge.simulation.truth.visibility import Seen
from models.arrays import Bool, Float, Float32, UInt8
from models.body.pose import Pose
from models.camera.pinhole import Camera


@dataclass(frozen=True, eq=False)
class Truth:
    """Of n pictures of one camera, in the order of their times, with P pupils. NaN and `Seen.OUTSIDE` for a pupil who is not there.

    Attributes:
        times_s: (n,) mid-exposure of the middle row, from the lesson's beginning.
        cameras: (n, 22) where the camera truly is and how it bends: `edge.simulation.picture.lens.Lens.numbers` without the limit.
        translations_m: (n, P, 3) of the pelvis at the picture's time.
        rotations_rad: (n, P, 24, 3) as `models.body.pose.Pose`, at the picture's time.
        joints_m: (n, P, 24, 3) in the world at the picture's time, in the order of `models.skeleton.smpl`.
        coco_m: (n, P, 23, 3) in the world at the picture's time, in the order of `models.skeleton.coco_feet`.
        coco_exposed_m: (n, P, 23, 3) in the world when the row is exposed on which each lands: what perfect cameras triangulate.
        joints_px: (n, P, 24, 2) and
        coco_px: (n, P, 23, 2) where they land in the picture, each when its row is exposed; NaN behind the camera.
        joints_seen: (n, P, 24) and
        coco_seen: (n, P, 23) `Seen`.
        boxes_px: (n, P, 4) left, top, right, bottom of all that belongs to the pupil, hidden or not; may reach beyond the picture.
    """

    times_s: Float
    cameras: Float
    translations_m: Float32
    rotations_rad: Float32
    joints_m: Float32
    coco_m: Float32
    coco_exposed_m: Float32
    joints_px: Float32
    coco_px: Float32
    joints_seen: UInt8
    coco_seen: UInt8
    boxes_px: Float32

    def __len__(self) -> int:
        return len(self.times_s)

    @property
    def coco_visible(self) -> Bool:
        """(n, P, 23) nothing hides the point from the camera."""
        return np.asarray(self.coco_seen == Seen.VISIBLE)

    def pose(self, picture: int, pupil: int) -> Pose | None:
        """A pupil's pose at a picture's time; None if he is not there."""
        translation = self.translations_m[picture, pupil].astype(np.float64)
        if not np.isfinite(translation).all():
            return None
        return Pose(translation, self.rotations_rad[picture, pupil].astype(np.float64))

    def camera(self, picture: int, name: str, size_px: tuple[int, int]) -> Camera:
        """The camera as it truly was at a picture: not as it was calibrated, if it was knocked since."""
        numbers = self.cameras[picture]
        fx, skew, cx, fy, cy = numbers[12:17]
        matrix = np.array(((fx, skew, cx), (0.0, fy, cy), (0.0, 0.0, 1.0)))
        return Camera(name, size_px, matrix, numbers[17:22], numbers[:9].reshape(3, 3), numbers[9:12], np.zeros(2))


def joined(truths: Sequence[Truth]) -> Truth:
    """One after the other."""
    return Truth(*(np.concatenate([getattr(truth, field.name) for truth in truths]) for field in fields(Truth)))


@dataclass(frozen=True, eq=False)
class LessonTruth:
    """Of a lesson, or of a piece of one.

    Attributes:
        origin: what the pictures were made from, such as the fingerprint of a lesson plan.
        pupils: codes of the P pupils; the first is the one whom the lesson is about.
        shapes: (P, S) shape coefficients of their bodies.
        rest_joints_m: (P, 24, 3) joints of their bodies in the T-pose: off the model, if the body is.
        shutter: of all cameras.
        sizes_px: width and height of each camera's pictures.
        cameras: truth by the camera's name.
    """

    origin: str
    pupils: tuple[str, ...]
    shapes: Float
    rest_joints_m: Float
    shutter: Shutter
    sizes_px: Mapping[str, tuple[int, int]]
    cameras: Mapping[str, Truth]


def joined_lesson(pieces: Sequence[LessonTruth]) -> LessonTruth:
    """Pieces of one lesson one after the other.

    Raises:
        ValueError: they are not of one lesson.
    """
    first = pieces[0]
    if any((piece.origin, piece.pupils, piece.sizes_px) != (first.origin, first.pupils, first.sizes_px) for piece in pieces):
        raise ValueError(f"pieces of several lessons: {sorted({piece.origin for piece in pieces})}")
    cameras = {name: joined([piece.cameras[name] for piece in pieces]) for name in first.cameras}
    return LessonTruth(first.origin, first.pupils, first.shapes, first.rest_joints_m, first.shutter, first.sizes_px, cameras)
