"""The Shelf frames that we may measure on: cameras, candidates, ground truth, and PCP-3D.

Source: Belagiannis et al., "3D Pictorial Structures for Multiple Human Pose Estimation", CVPR 2014. PCP-3D of ten parts: eight
limbs, the torso from the base of the head to the pelvis, and the head.
"""

import gzip
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.camera.pinhole import Camera
from models.camera.rig import Rig
from models.errors import UserError
from models.skeleton import coco
from tests.bench.metrics.correctness import right_parts as right_parts_of
from tests.bench.shelf.openpose import Picture

RATE_HZ: Final = 25.0
PARTS: Final = {
    "right_shank": (0, 1),
    "right_thigh": (1, 2),
    "left_thigh": (3, 4),
    "left_shank": (4, 5),
    "right_forearm": (6, 7),
    "right_upper_arm": (7, 8),
    "left_upper_arm": (9, 10),
    "left_forearm": (10, 11),
    "head": (12, 13),
    "torso": (12, 14),
}
"""Name -> the two ends among the 15 joints of the ground truth."""
LIMB_PARTS: Final = tuple(PARTS)[:8]
_SAME: Final = {
    0: "right_ankle",
    1: "right_knee",
    2: "right_hip",
    3: "left_hip",
    4: "left_knee",
    5: "left_ankle",
    6: "right_wrist",
    7: "right_elbow",
    8: "right_shoulder",
    9: "left_shoulder",
    10: "left_elbow",
    11: "left_wrist",
}
_EARS: Final = [coco.INDEX["left_ear"], coco.INDEX["right_ear"]]
_HEAD: Final = [coco.INDEX[name] for name in ("nose", "left_eye", "right_eye", "left_ear", "right_ear")]
_HEAD_FROM, _HEAD_TO = 0.6, 1.5
"""Where base and top of the head lie on the way from the shoulders' middle to the ears' middle."""
_MISSING_M: Final = 0.5


@dataclass(frozen=True, eq=False)
class Shelf:
    """Five cameras, N frames.

    Attributes:
        rig: the cameras.
        pictures: (N) lists of one picture a camera.
        truth: of each frame, actor -> (15, 3) m.
    """

    rig: Rig
    pictures: list[list[Picture]]
    truth: list[dict[str, Float]]


def load_shelf(folder: Path) -> Shelf:
    """Read the data as its README describes it.

    Raises:
        UserError: it is not there.
    """
    if not (folder / "calibration.json").is_file():
        raise UserError(f"bench-shelf: {folder} holds no Shelf data, which may not be redistributed; name its folder with SHARED=")
    cameras = json.loads((folder / "calibration.json").read_text())
    rig = Rig(tuple(_camera(name, record) for name, record in cameras.items()))
    truth = json.loads((folder / "ground_truth.json").read_text())
    views = [_pictures(folder / f"detection/{camera.name}.json.gz", camera.size_px) for camera in rig]
    frames = [{actor: np.array(joints) for actor, joints in frame.items()} for frame in truth["frames"]]
    return Shelf(rig, [list(pictures) for pictures in zip(*views, strict=True)], frames)


def _camera(name: str, record: dict[str, list[float]]) -> Camera:
    placed = np.array(record["RT"]).reshape(3, 4)
    left, _, right = np.linalg.svd(placed[:, :3])  # the file's few digits leave it no exact rotation
    width, height = record["imgSize"]
    matrix = np.array(record["K"]).reshape(3, 3)
    return Camera(name, (int(width), int(height)), matrix, np.zeros(5), left @ right, placed[:, 3], np.zeros(2))


def _pictures(path: Path, size_px: tuple[int, int]) -> list[Picture]:
    scale = np.array((size_px[0] - 1, size_px[1] - 1, 1.0))
    with gzip.open(path) as file:
        frames = json.load(file)
    pictures = []
    for frame in frames:
        candidates = tuple(np.array(joint).reshape(-1, 3) * scale for joint in frame["candidates"])
        pictures.append(Picture(candidates, tuple(np.array(paf) if paf else np.zeros((0, 0)) for paf in frame["paf"])))
    return pictures


def as_shelf(joints_m: Float) -> Float:
    """(15, 3) the ground truth's joints from COCO's (17, 3); NaN where the ones that they need are missing."""
    out = np.full((15, 3), np.nan)
    for place, name in _SAME.items():
        out[place] = joints_m[coco.INDEX[name]]
    neck = 0.5 * (out[8] + out[9])
    ears = joints_m[_EARS]
    middle = _mean(ears if np.isfinite(ears).all() else joints_m[_HEAD])
    out[12], out[13] = neck + _HEAD_FROM * (middle - neck), neck + _HEAD_TO * (middle - neck)
    out[14] = 0.5 * (out[2] + out[3])
    return out


def _mean(points: Float) -> Float:
    known = points[np.isfinite(points[:, 0])]
    return known.mean(axis=0) if len(known) else np.full(3, np.nan)


def nearest_person(truth_m: Float, persons_m: list[Float]) -> int | None:
    """Which of the persons (15, 3) has the smallest mean distance from an actor (15, 3).

    A missing joint counts for `_MISSING_M`, so that a piece of somebody is not preferred to a whole person.
    """
    means = []
    for person in persons_m:
        distances = np.linalg.norm(person - truth_m, axis=1)
        means.append(np.where(np.isfinite(distances), distances, _MISSING_M).mean() if np.isfinite(distances).any() else np.inf)
    return int(np.argmin(means)) if means and min(means) < np.inf else None


def right_parts(truth_m: Float, persons_m: list[Float]) -> Bool:
    """(10,) which parts of one actor (15, 3) are right on the person nearest to it; a part with a missing end is wrong."""
    nearest = nearest_person(truth_m, persons_m)
    if nearest is None:
        return np.zeros(len(PARTS), np.bool_)
    return right_parts_of(persons_m[nearest], truth_m, np.array(list(PARTS.values())))
