"""Human3.6M in the form that most people hold it in.

- `data_3d_h36m.npz`, as VideoPose3D's `prepare_data_h36m.py` writes it: `positions_3d`, subject -> action -> (T, 32, 3), metres in
  the world, 50 Hz.
- `camera-parameters.json`, as `karfly/human36m-camera-parameters` has it: intrinsics by camera; R and t (mm) by subject and camera.
- the films as they are distributed: `S9/Videos/Directions 1.54138969.mp4`, or the same without `Videos/`.

Of the 32 joints the twelve of arms and legs are COCO's; they are joint centres from markers and not COCO's points, so an error of
some millimetres to centimetres is the definition's. Reading the original `.cdf` would take a library that nothing else needs.

Sources: Ionescu et al., "Human3.6M", TPAMI 2014; Pavllo et al., "3D human pose estimation in video", CVPR 2019.
"""

import io
import json
import pickle
import zipfile
from pathlib import Path
from typing import Any, Final, cast

import numpy as np

from models.arrays import Float
from models.camera.pinhole import Camera
from models.camera.rig import Rig
from models.errors import UserError
from models.skeleton import coco
from tests.bench.datasets.film import Film, open_film, opener
from tests.bench.datasets.track import between_samples
from tests.bench.reconstruct.lesson import Lesson, Span

RATE_HZ: Final = 50.0
SUBJECTS: Final = ("S9", "S11")
"""Those that everybody tests on."""
JOINTS: Final = {
    "right_hip": 1, "right_knee": 2, "right_ankle": 3, "left_hip": 6, "left_knee": 7, "left_ankle": 8,
    "left_shoulder": 17, "left_elbow": 18, "left_wrist": 19, "right_shoulder": 25, "right_elbow": 26, "right_wrist": 27,
}  # fmt: skip
_POSITIONS, _CAMERAS = "data_3d_h36m.npz", "camera-parameters.json"
_OTHER_NAMES: Final = (("Photo", "TakingPhoto"), ("WalkDog", "WalkingDog"))
"""The positions' names for actions, and the films'."""
_SETTLING_S: Final = 0.5


def load(folder: Path, seconds: float) -> list[Lesson]:
    """A lesson for every film of the test subjects of which all four views are there.

    Args:
        folder: see this file's head.
        seconds: of each film, from its beginning.

    Raises:
        UserError: a file is missing or foreign; says which.
    """
    positions = _positions(folder / _POSITIONS)
    cameras = _read_json(folder / _CAMERAS)
    found = []
    for subject in (name for name in SUBJECTS if name in positions):
        for action, points in sorted(positions[subject].items()):
            lesson = _lesson(folder, cameras, subject, action, np.asarray(points, np.float64), seconds)
            found += [lesson] if lesson is not None else []
    if not found:
        raise UserError(
            f"{folder} holds no film of {' or '.join(SUBJECTS)} in four views, such as 'S9/Videos/Directions 1.54138969.mp4'"
        )
    return found


def _lesson(folder: Path, cameras: dict[str, Any], subject: str, action: str, points_m: Float, seconds: float) -> Lesson | None:
    names = sorted(_key(cameras, "extrinsics", subject))
    paths = {name: _film_path(folder, subject, action, name) for name in names}
    if not all(path is not None for path in paths.values()):
        return None
    count = min(len(points_m), round(seconds * RATE_HZ))
    films = {name: open_film(cast(Path, path), name, RATE_HZ, 0, count) for name, path in paths.items()}
    count = min(film.count for film in films.values())
    points = np.full((count, coco.COUNT, 3), np.nan)
    for name, joint in JOINTS.items():
        points[:, coco.INDEX[name]] = points_m[:count, joint]
    length_s = (count - 1) / RATE_HZ
    # The film's own bytes are not hashed: gigabytes.
    return Lesson(
        name=f"{subject} {action}",
        seed=0,
        pupil=subject,
        identity=f"h36m {subject} {action} {count} {[film.path.stat().st_size for film in films.values()]}",
        rig=Rig(tuple(_camera(cameras, subject, films[name]) for name in names)),
        length_s=length_s,
        spans=(Span(action.lower().split(" ", maxsplit=1)[0], _SETTLING_S, length_s),),
        frames=opener(films),
        truth_m=between_samples(np.arange(count) / RATE_HZ, points),
    )


def _film_path(folder: Path, subject: str, action: str, camera: str) -> Path | None:
    names = {action, *(action.replace(ours, theirs) for ours, theirs in _OTHER_NAMES)}
    for name in sorted(names):
        for parent in (folder / subject / "Videos", folder / subject):
            path = parent / f"{name}.{camera}.mp4"
            if path.is_file():
                return path
    return None


def _camera(cameras: dict[str, Any], subject: str, film: Film) -> Camera:
    inside, outside = _key(cameras, "intrinsics", film.camera), _key(cameras, "extrinsics", subject, film.camera)
    rotation = np.asarray(_key(outside, "R"), np.float64).reshape(3, 3)
    left, _, right = np.linalg.svd(rotation)  # the file's digits leave it no exact rotation
    return Camera(
        name=film.camera,
        size_px=film.size_px,
        matrix_px=np.asarray(_key(inside, "calibration_matrix"), np.float64).reshape(3, 3),
        distortion=np.asarray(_key(inside, "distortion"), np.float64).reshape(5),
        rotation=left @ right,
        translation_m=np.asarray(_key(outside, "t"), np.float64).reshape(3) / 1e3,
        shift_px=np.zeros(2),
    )


def _key(record: dict[str, Any], *keys: str) -> Any:
    value: Any = record
    for key in keys:
        if not isinstance(value, dict) or key not in value:
            raise UserError(f"{_CAMERAS} has no {'.'.join(keys)}; is it that of karfly/human36m-camera-parameters?")
        value = value[key]
    return value


def _read_json(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text())
    except FileNotFoundError:
        raise UserError(f"{path} is missing: the calibration, from karfly/human36m-camera-parameters") from None
    except (OSError, ValueError) as error:
        raise UserError(f"{path} is no JSON file that can be read ({error})") from error
    if not isinstance(content, dict):
        raise UserError(f"{path} is not the calibration of karfly/human36m-camera-parameters")
    return content


class _Arrays(pickle.Unpickler):
    """Unpickles arrays and nothing else: such a file is passed from hand to hand."""

    def find_class(self, module: str, name: str) -> Any:
        """What an array is made of."""
        if (module.split(".", maxsplit=1)[0], name) in {
            ("numpy", "_reconstruct"),
            ("numpy", "ndarray"),
            ("numpy", "dtype"),
            ("_codecs", "encode"),
        }:
            return super().find_class(module, name)
        raise pickle.UnpicklingError(f"it holds {module}.{name}, which is no array")


def _positions(path: Path) -> dict[str, dict[str, Float]]:
    try:
        with zipfile.ZipFile(path) as archive:
            stored = io.BytesIO(archive.read("positions_3d.npy"))
        np.lib.format.read_magic(stored)
        np.lib.format.read_array_header_1_0(stored)
        table = _Arrays(stored).load().item()
    except FileNotFoundError:
        raise UserError(f"{path} is missing: make it with VideoPose3D's data/prepare_data_h36m.py") from None
    except (OSError, KeyError, ValueError, AttributeError, EOFError, zipfile.BadZipFile, pickle.UnpicklingError) as error:
        raise UserError(f"{path} is not what VideoPose3D's data/prepare_data_h36m.py writes ({error})") from error
    if not isinstance(table, dict) or not all(isinstance(actions, dict) for actions in table.values()):
        raise UserError(f"{path} is not what VideoPose3D's data/prepare_data_h36m.py writes: no subjects with actions")
    for subject, actions in table.items():
        for action, points in actions.items():
            if np.ndim(points) != 3 or np.shape(points)[1:] != (32, 3):
                raise UserError(f"{path}: {subject} {action} has the shape {np.shape(points)}, needed is (T, 32, 3), all joints")
    return cast(dict[str, dict[str, Float]], table)
