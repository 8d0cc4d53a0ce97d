"""One sequence of the CMU Panoptic Studio, as its scripts download and unpack it.

- `calibration_NAME.json`: cameras with `type`, `panel`, `node`, `resolution`, `K`, `distCoef`, `R`, `t` (cm).
- `hdPose3d_stage1_coco19/body3DScene_00000000.json` ...: `bodies` with `id` and `joints19` (x, y, z in cm, confidence).
- `hdVideos/hd_00_00.mp4` ...: at 29.97 Hz; picture k belongs to scene k.

The studio's y axis points down; here z points up. Thirteen joints are COCO's: which of the eyes and ears is left is told
differently by those who use the data, so they are left out. If several people are there, the one in most scenes counts: choose a
sequence of one person, since the box follows one.

Source: Joo et al., "Panoptic Studio", ICCV 2015 and TPAMI 2017.
"""

import json
from collections import Counter
from pathlib import Path
from typing import Any, Final

import numpy as np

from models.arrays import Float
from models.camera.pinhole import Camera
from models.camera.rig import Rig
from models.errors import UserError
from models.skeleton import coco
from tests.bench.datasets.film import Film, open_film, opener
from tests.bench.datasets.track import between_samples
from tests.bench.reconstruct.lesson import Lesson, Span

RATE_HZ: Final = 30000 / 1001
PREFERRED: Final = (12, 6, 23, 13, 3)
"""Nodes of the five high-definition cameras that most people evaluate with."""
MAX_CAMERAS: Final = 5
JOINTS: Final = {
    "nose": 1, "left_shoulder": 3, "left_elbow": 4, "left_wrist": 5, "left_hip": 6, "left_knee": 7, "left_ankle": 8,
    "right_shoulder": 9, "right_elbow": 10, "right_wrist": 11, "right_hip": 12, "right_knee": 13, "right_ankle": 14,
}  # fmt: skip
_MIN_CONFIDENCE: Final = 0.1
_SETTLING_S: Final = 0.5
_TO_OURS: Final = np.array(((1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, -1.0, 0.0)))
"""The studio's world (y down) to ours (z up)."""


def load(folder: Path, seconds: float) -> list[Lesson]:
    """The sequence in a folder, from the first scene with somebody in it.

    Args:
        folder: see this file's head.
        seconds: how much of it.

    Raises:
        UserError: a file is missing or foreign; says which.
    """
    calibration = sorted(folder.glob("calibration_*.json"))
    if len(calibration) != 1:
        raise UserError(f"{folder} holds {len(calibration)} files calibration_*.json, needed is the one of one sequence")
    records = {_name(camera): camera for camera in _cameras(calibration[0])}
    scenes = sorted((folder / "hdPose3d_stage1_coco19").glob("body3DScene_*.json"))
    if not scenes:
        raise UserError(f"{folder}/hdPose3d_stage1_coco19 holds no body3DScene_*.json; unpack hdPose3d_stage1_coco19.tar")
    first, points = _person(scenes, round(seconds * RATE_HZ))
    there = [name for name in records if (folder / "hdVideos" / f"hd_{name}.mp4").is_file()]
    chosen = [name for name in (f"00_{node:02d}" for node in PREFERRED) if name in there]
    chosen = sorted(chosen + [name for name in there if name not in chosen][: max(0, MAX_CAMERAS - len(chosen))])
    if len(chosen) < 2:
        raise UserError(
            f"{folder}/hdVideos holds {len(chosen)} films of calibrated cameras (hd_00_00.mp4 ...), needed are two or more"
        )
    films = {name: open_film(folder / "hdVideos" / f"hd_{name}.mp4", name, RATE_HZ, first, len(points)) for name in chosen}
    count = min(film.count for film in films.values())
    if count < 1:
        raise UserError(f"{folder}/hdVideos: the films end before scene {first}, the first with somebody in it")
    length_s = (count - 1) / RATE_HZ
    return [
        Lesson(
            name=folder.name,
            seed=0,
            pupil="unknown",
            identity=f"panoptic {folder.name} {first} {count} {[film.path.stat().st_size for film in films.values()]}",
            rig=Rig(tuple(_camera(records[name], films[name], calibration[0]) for name in chosen)),
            length_s=length_s,
            spans=(Span("sequence", _SETTLING_S, length_s),),
            frames=opener(films),
            truth_m=between_samples(np.arange(count) / RATE_HZ, points[:count]),
        )
    ]


def _cameras(path: Path) -> list[dict[str, Any]]:
    content = _read_json(path)
    cameras = content.get("cameras") if isinstance(content, dict) else None
    if not isinstance(cameras, list) or not all(isinstance(camera, dict) for camera in cameras):
        raise UserError(f"{path} is no calibration of the Panoptic Studio: it has no list of cameras")
    return [camera for camera in cameras if camera.get("type", "hd") == "hd"]


def _name(camera: dict[str, Any]) -> str:
    return f"{int(camera.get('panel', 0)):02d}_{int(camera.get('node', 0)):02d}"


def _camera(record: dict[str, Any], film: Film, path: Path) -> Camera:
    def array(key: str, *shape: int) -> Float:
        try:
            return np.asarray(record[key], np.float64).reshape(shape)
        except (KeyError, ValueError, TypeError) as error:
            raise UserError(f"{path}: camera {film.camera} has no {key} of {shape} numbers") from error

    matrix = array("K", 3, 3)
    left, _, right = np.linalg.svd(array("R", 3, 3))
    return Camera(
        name=film.camera,
        size_px=film.size_px,
        matrix_px=matrix / matrix[2, 2],
        distortion=array("distCoef", 5),
        rotation=left @ right @ _TO_OURS.T,
        translation_m=array("t", 3) / 100,
        shift_px=np.zeros(2),
    )


def _person(scenes: list[Path], count: int) -> tuple[int, Float]:
    """Number of the first scene that counts, and (n, 17, 3) of the person who is in most scenes from there on."""
    people: list[tuple[int, dict[int, Float]]] = []
    for path in scenes:
        bodies = _bodies(path)
        if people or bodies:
            people.append((_number(path), bodies))
        if len(people) == count:
            break
    presence = Counter(person for _, bodies in people for person in bodies)
    if not presence:
        raise UserError(f"{scenes[0].parent}: nobody is in any scene")
    pupil, first = presence.most_common(1)[0][0], people[0][0]
    points = np.full((people[-1][0] - first + 1, coco.COUNT, 3), np.nan)
    for number, bodies in people:
        if pupil in bodies:
            points[number - first] = bodies[pupil]
    return first, points


def _bodies(path: Path) -> dict[int, Float]:
    content = _read_json(path)
    found = {}
    try:
        for body in content["bodies"]:
            joints = np.asarray(body["joints19"], np.float64).reshape(19, 4)
            points = np.full((coco.COUNT, 3), np.nan)
            for name, joint in JOINTS.items():
                if joints[joint, 3] > _MIN_CONFIDENCE:
                    points[coco.INDEX[name]] = _TO_OURS @ joints[joint, :3] / 100
            found[int(body["id"])] = points
    except (KeyError, TypeError, ValueError) as error:
        raise UserError(f"{path} is no scene of hdPose3d_stage1_coco19 ({error!r})") from error
    return found


def _number(path: Path) -> int:
    digits = path.stem.rpartition("_")[2]
    if not digits.isdigit():
        raise UserError(f"{path}: its name has no number, as in body3DScene_00000123.json")
    return int(digits)


def _read_json(path: Path) -> Any:
    try:
        return json.loads(path.read_text())
    except (OSError, ValueError) as error:
        raise UserError(f"{path} is no JSON file that can be read ({error})") from error
