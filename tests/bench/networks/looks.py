"""Each network on each picture of a lesson, in crops that the truth tells: upright, and turned with the trunk as the box does."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

import cv2
import numpy as np

from edge.perception.crop import cut, reduction_for
from edge.perception.network_file import read_network_file
from edge.perception.networks import load_network
from edge.perception.pose import load_pose_network
from models.arrays import Float, UInt8
from models.camera.pinhole import Camera
from models.messages.observation import Crop
from models.skeleton import coco
from models.skeleton.trunk import lean_rad
from services.fusion.prediction import CROP_MARGIN, SHORT_TRUNK
from tests.bench.kept import keep_arrays
from tests.bench.reconstruct.lesson import Lesson

Name = Literal["thunder", "lightning", "blazepose"]
NETWORKS: Final[tuple[Name, ...]] = ("thunder", "lightning", "blazepose")
FILES: Final = {"thunder": "movenet-thunder", "lightning": "movenet-lightning", "blazepose": "blazepose-full"}
Turn = Literal["upright", "rotated"]
TURNS: Final[tuple[Turn, ...]] = ("upright", "rotated")
_BLAZEPOSE_REACH: Final = 2.5
"""Side of the crop that BlazePose was trained on over the distance from the middle of the hips to the farthest point."""
_BLAZEPOSE_TO_COCO: Final = [0, 2, 5, 7, 8, 11, 12, 13, 14, 15, 16, 23, 24, 25, 26, 27, 28]
_ROOT: Final = Path(__file__).parents[3]
_CODE: Final = (Path(__file__), *(_ROOT / name for name in (
    "edge/cameras/jpeg.py", "edge/perception/crop.py", "edge/perception/networks.py", "edge/perception/pose.py",
    "models/messages/observation.py", "models/skeleton/trunk.py",
)))  # fmt: skip

Estimate = Callable[[UInt8], tuple[Float, Float]]
"""(17, 2) points in crop coordinates 0 to 1 and (17,) scores from a crop."""


@dataclass(frozen=True, eq=False)
class Looked:
    """What a network said of one camera's pictures.

    Attributes:
        points_px: (n, 17, 2), NaN for a picture in which the pupil is not.
        scores: (n, 17).
    """

    points_px: Float
    scores: Float


def look(lesson: Lesson, network: Name, turn: Turn, data: Path) -> dict[str, Looked]:
    """A network on all pictures, by camera; kept in `DATA/keypoints` by everything that it depends on.

    Raises:
        UserError: the network is not installed, or the file cannot be written.
    """
    digest = hashlib.sha256(f"{lesson.identity} {network} {turn} {CROP_MARGIN} {SHORT_TRUNK}".encode())
    for part in (read_network_file(FILES[network], data), *(path.read_bytes() for path in _CODE)):
        digest.update(hashlib.sha256(part).digest())
    path = data / "keypoints" / f"looks-{digest.hexdigest()[:40]}.npz"
    if path.is_file():
        with np.load(path) as kept:
            return {name: Looked(kept[f"{name}.points"], kept[f"{name}.scores"]) for name in lesson.rig.names}
    cv2.setNumThreads(1)
    size_px, estimate = _network(network, data)
    found = {name: _look_at(lesson, name, network, turn, size_px, estimate) for name in lesson.rig.names}
    points = {f"{name}.points": each.points_px for name, each in found.items()}
    keep_arrays(path, points | {f"{name}.scores": each.scores for name, each in found.items()})
    return found


def _look_at(lesson: Lesson, name: str, network: Name, turn: Turn, size_px: int, estimate: Estimate) -> Looked:
    truth = lesson.pictures[name]
    points, scores = np.full((len(truth.points_px), coco.COUNT, 2), np.nan), np.full((len(truth.points_px), coco.COUNT), np.nan)
    for frame in lesson.frames([name]):
        crop = crop_of(truth.points_px[frame.index], frame.size_px, network, turn)
        if crop is None:
            continue
        reduction = reduction_for(crop.side_px, size_px)
        places, score = estimate(cut(frame.image(reduction), reduction, crop, size_px))
        points[frame.index], scores[frame.index] = crop.to_image(places), score
    return Looked(points, scores)


def crop_of(points_px: Float, size_px: tuple[int, int], network: Name, turn: Turn) -> Crop | None:
    """Where a network that knew the truth would look; None if the pupil is not wholly before the camera, or out of the picture."""
    if not np.isfinite(points_px).all():
        return None
    extent_px = float(np.ptp(points_px, axis=0).max())
    lean = lean_rad(points_px, np.ones(coco.COUNT, np.bool_), SHORT_TRUNK * extent_px) if turn == "rotated" else 0.0
    crop = Crop.around(points_px, lean or 0.0, CROP_MARGIN)
    if network == "blazepose":
        hips = points_px[list(coco.TRUNK[2:])].mean(axis=0)
        reach = float(np.linalg.norm(points_px - hips, axis=1).max())
        crop = Crop(float(hips[0]), float(hips[1]), _BLAZEPOSE_REACH * reach, crop.angle_rad)
    inside = (points_px >= 0).all(axis=1) & (points_px < size_px).all(axis=1)
    return crop if inside.mean() >= 0.5 else None


def _network(name: Name, data: Path) -> tuple[int, Estimate]:
    if name == "blazepose":
        return _blazepose(data)
    pose = load_pose_network(name, data)

    def estimate(crop_rgb: UInt8) -> tuple[Float, Float]:
        found = pose.estimate(crop_rgb)
        return found.points.astype(np.float64), found.score.astype(np.float64)

    return pose.size_px, estimate


def _blazepose(data: Path) -> tuple[int, Estimate]:
    network = load_network(FILES["blazepose"], data)
    size_px = network.size_px[0]

    def estimate(crop_rgb: UInt8) -> tuple[Float, Float]:
        return blazepose_points(network(crop_rgb[None])["landmarks"][0].astype(np.float64).ravel(), size_px)

    return size_px, estimate


def blazepose_points(landmarks: Float, size_px: int) -> tuple[Float, Float]:
    """COCO's points from BlazePose's 39 landmarks (x, y, z in the crop's pixels, visibility and presence as logits)."""
    table = landmarks.reshape(39, 5)[_BLAZEPOSE_TO_COCO]
    return table[:, :2] / size_px, 1 / (1 + np.exp(-np.minimum(table[:, 3], table[:, 4])))


def errors_of_height(lesson: Lesson, camera: Camera, looked: Looked) -> Float:
    """(n, 17) distance of each point from the truth, at the truth's depth, over the pupil's standing height."""
    truth = lesson.pictures[camera.name]
    depth_m = camera.to_camera(truth.points_m)[..., 2]
    focal_px = np.sqrt(camera.matrix_px[0, 0] * camera.matrix_px[1, 1])
    apart = camera.undistort(looked.points_px) - camera.undistort(truth.points_px)
    return np.asarray(np.linalg.norm(apart, axis=-1) * depth_m / focal_px / lesson.stature_m)
