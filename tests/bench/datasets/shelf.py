"""The Shelf as it is distributed.

- `actorsGT.mat`: `actor3D`, a cell of actors, each a cell of frames with (14, 3) joints in metres, or nothing.
- `Camera0/img_000000.png` ...
- `calibration_shelf.json`, as VoxelPose has it: by camera fx, fy, cx, cy, k, p, and R and T (mm) of X_cam = R (X - T).

Source: Belagiannis et al., "3D Pictorial Structures for Multiple Human Pose Estimation", CVPR 2014.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np
import scipy.io
from scipy.io.matlab import MatReadError

from models.arrays import Float, UInt8
from models.camera.pinhole import Camera
from models.camera.rig import Rig
from models.errors import UserError

FRAMES: Final = range(300, 601)
"""Those that everybody tests on."""
_JOINTS: Final = 14
_RIGHT_HIP, _LEFT_HIP = 2, 3


@dataclass(frozen=True, eq=False)
class ShelfFilm:
    """The Shelf as pictures.

    Attributes:
        rig: cameras "0" to "4".
        paths: of each camera, the pictures.
        truth: of each frame, actor -> (15, 3) m, as `tests.bench.shelf.data` has it.
    """

    rig: Rig
    paths: dict[str, list[Path]]
    truth: list[dict[str, Float]]


def load(folder: Path, frames: range = FRAMES) -> ShelfFilm:
    """Read the Shelf as it is distributed.

    Raises:
        UserError: a file is missing or foreign; says which.
    """
    actors = _actors(folder / "actorsGT.mat")
    cameras = _calibration(folder / "calibration_shelf.json")
    names = sorted(cameras)
    paths = {name: [folder / f"Camera{name}" / f"img_{frame:06d}.png" for frame in frames] for name in names}
    for pictures in paths.values():
        for path in pictures:
            if not path.is_file():
                raise UserError(
                    f"{path} is missing; the test needs the pictures {frames.start} to {frames.stop - 1} of every camera"
                )
    size = picture(paths[names[0]][0]).shape
    rig = Rig(tuple(_camera(name, cameras[name], (size[1], size[0])) for name in names))
    return ShelfFilm(rig, paths, [_at(actors, frame) for frame in frames])


def picture(path: Path) -> UInt8:
    """(H, W, 3) RGB.

    Raises:
        UserError: it is no picture.
    """
    found = cv2.imread(str(path), cv2.IMREAD_COLOR_RGB)
    if found is None:
        raise UserError(f"{path} is no picture that can be read; copy it again")
    return np.asarray(found, np.uint8)


def _actors(path: Path) -> list[list[Float]]:
    """Of each actor, (14, 3) of each frame; (0, 3) where he is not there."""
    if not path.is_file():
        raise UserError(f"{path} is missing: the Shelf's ground truth")
    try:
        cells = scipy.io.loadmat(str(path))["actor3D"]
    except KeyError:
        raise UserError(f"{path} has no actor3D; is it the Shelf's actorsGT.mat?") from None
    except (ValueError, OSError, NotImplementedError, TypeError, IndexError, MatReadError) as error:
        raise UserError(f"{path} is no MATLAB file that can be read ({error})") from error
    while cells.dtype == object and cells.size == 1:
        cells = cells.flat[0]
    actors = [[_joints(joints, path) for joints in np.ravel(actor)] for actor in np.ravel(cells)]
    if len({len(actor) for actor in actors}) != 1 or len(actors[0]) < 2:
        raise UserError(f"{path}: actor3D is not a cell of actors with a cell of frames each")
    return actors


def _joints(cell: Any, path: Path) -> Float:
    joints = np.asarray(cell, np.float64)
    if joints.size < _JOINTS * 3:  # an empty matrix, or one zero: he is not there
        return np.zeros((0, 3))
    if joints.shape != (_JOINTS, 3):
        raise UserError(f"{path}: a pose has the shape {joints.shape}, needed is ({_JOINTS}, 3)")
    return joints


def _at(actors: list[list[Float]], frame: int) -> dict[str, Float]:
    found = {}
    for number, poses in enumerate(actors):
        if frame < len(poses) and len(poses[frame]):
            joints = poses[frame]
            found[str(number)] = np.vstack((joints, joints[[_RIGHT_HIP, _LEFT_HIP]].mean(axis=0)))
    return found


def _calibration(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text())
    except FileNotFoundError:
        raise UserError(f"{path} is missing: the calibration in the form of VoxelPose's repository") from None
    except (OSError, ValueError) as error:
        raise UserError(f"{path} is no JSON file that can be read ({error})") from error
    if not isinstance(content, dict) or len(content) < 2 or not all(isinstance(camera, dict) for camera in content.values()):
        raise UserError(f"{path} is not a calibration of two cameras or more, by their numbers")
    return content


def _camera(name: str, record: dict[str, Any], size_px: tuple[int, int]) -> Camera:
    def numbers(key: str, count: int) -> Float:
        try:
            return np.asarray(record[key], np.float64).reshape(count)
        except (KeyError, ValueError, TypeError):
            raise UserError(f"calibration_shelf.json: camera {name} has no {key} of {count} numbers") from None

    (fx,), (fy,), (cx,), (cy,) = (numbers(key, 1) for key in ("fx", "fy", "cx", "cy"))
    (k1, k2, k3), (p1, p2) = numbers("k", 3), numbers("p", 2)
    left, _, right = np.linalg.svd(numbers("R", 9).reshape(3, 3))
    rotation = left @ right
    return Camera(
        name=name,
        size_px=size_px,
        matrix_px=np.array(((fx, 0.0, cx), (0.0, fy, cy), (0.0, 0.0, 1.0))),
        distortion=np.array((k1, k2, p1, p2, k3)),
        rotation=rotation,
        translation_m=-rotation @ numbers("T", 3) / 1e3,
        shift_px=np.zeros(2),
    )
