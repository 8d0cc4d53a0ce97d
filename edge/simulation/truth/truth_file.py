"""The file of a lesson's truth: an .npz with a header in JSON, and the arrays of `Truth` as `CAMERA/FIELD`; nothing is pickled."""

import io
import zipfile
import zlib
from dataclasses import fields
from pathlib import Path
from typing import Any, Final

import msgspec
import numpy as np
import numpy.typing as npt

from edge.simulation.picture.shutter import Shutter
from edge.simulation.truth.truth import LessonTruth, Truth
from models.errors import UserError
from models.skeleton import coco_feet, smpl

FORMAT: Final = "kinebox-truth"
VERSION: Final = 1

_SHAPES: Final[dict[str, tuple[type, tuple[int | str, ...]]]] = {
    "times_s": (np.float64, ()),
    "cameras": (np.float64, (22,)),
    "translations_m": (np.float32, ("P", 3)),
    "rotations_rad": (np.float32, ("P", smpl.COUNT, 3)),
    "joints_m": (np.float32, ("P", smpl.COUNT, 3)),
    "coco_m": (np.float32, ("P", coco_feet.COUNT, 3)),
    "coco_exposed_m": (np.float32, ("P", coco_feet.COUNT, 3)),
    "joints_px": (np.float32, ("P", smpl.COUNT, 2)),
    "coco_px": (np.float32, ("P", coco_feet.COUNT, 2)),
    "joints_seen": (np.uint8, ("P", smpl.COUNT)),
    "coco_seen": (np.uint8, ("P", coco_feet.COUNT)),
    "boxes_px": (np.float32, ("P", 4)),
}


_DAMAGED = (ValueError, EOFError, KeyError, TypeError, AttributeError, OSError, RuntimeError, zipfile.BadZipFile, zlib.error)
"""What NumPy and zipfile raise at bytes that were changed; RuntimeError for a method or a lock that zipfile does not know."""


class _Header(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    format: str
    version: int
    origin: str
    pupils: tuple[str, ...]
    sizes_px: dict[str, tuple[int, int]]
    exposure_s: float
    readout_s: float


class _Kind(msgspec.Struct, frozen=True):
    format: str
    version: int


def encode(truth: LessonTruth) -> bytes:
    """A lesson's truth as bytes: the same for the same truth."""
    header = _Header(
        FORMAT, VERSION, truth.origin, truth.pupils, dict(truth.sizes_px), truth.shutter.exposure_s, truth.shutter.readout_s
    )
    arrays: dict[str, npt.NDArray[Any]] = {
        "header": np.frombuffer(msgspec.json.encode(header), np.uint8),
        "shapes": truth.shapes,
        "rest_joints_m": truth.rest_joints_m,
    }
    for name, camera in truth.cameras.items():
        arrays |= {f"{name}/{field.name}": getattr(camera, field.name) for field in fields(Truth)}
    data = io.BytesIO()
    np.savez_compressed(data, allow_pickle=False, **arrays)
    return data.getvalue()


def decode(data: bytes, name: str) -> LessonTruth:
    """Read a lesson's truth.

    Args:
        data: content of the file.
        name: how errors call the file.

    Raises:
        UserError: no such file, of another version, or damaged.
    """
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            arrays = {key: archive[key] for key in archive}
        header = _read_header(arrays["header"].tobytes(), name)
        cameras = {camera: _camera(arrays, camera, len(header.pupils)) for camera in header.sizes_px}
        shapes, rest = arrays["shapes"], arrays["rest_joints_m"]
        if shapes.ndim != 2 or len(shapes) != len(header.pupils) or rest.shape != (len(header.pupils), smpl.COUNT, 3):
            raise ValueError(f"shapes {shapes.shape} and rest_joints_m {rest.shape} of {len(header.pupils)} pupils")
    except _DAMAGED as error:
        raise UserError(f"{name}: is no lesson's truth, or is damaged ({error}); render the lesson again") from error
    shutter = Shutter(header.exposure_s, header.readout_s)
    return LessonTruth(header.origin, header.pupils, shapes, rest, shutter, header.sizes_px, cameras)


def read(path: Path) -> LessonTruth:
    """A lesson's truth from its file. Raises UserError as `decode` does, or if the file cannot be read."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror}); render the lesson again") from error
    return decode(data, str(path))


def _read_header(data: bytes, name: str) -> _Header:
    try:
        kind = msgspec.json.decode(data, type=_Kind)
        if kind.format == FORMAT and kind.version != VERSION:
            raise UserError(
                f"{name}: truth of version {kind.version}; this KineBox reads version {VERSION}; render the lesson again"
            )
        if kind.format != FORMAT:
            raise ValueError(f"its format is '{kind.format}'")
        return msgspec.json.decode(data, type=_Header)
    except msgspec.MsgspecError as error:
        raise ValueError(str(error)) from error


def _camera(arrays: dict[str, npt.NDArray[Any]], camera: str, pupils: int) -> Truth:
    found = {}
    count = len(arrays[f"{camera}/times_s"])
    for field, (kind, shape) in _SHAPES.items():
        array = arrays[f"{camera}/{field}"]
        wanted = (count, *(pupils if size == "P" else size for size in shape))
        if array.dtype != kind or array.shape != wanted:
            raise ValueError(f"{camera}/{field} is {array.dtype} {array.shape}, not {np.dtype(kind)} {wanted}")
        found[field] = array
    return Truth(**found)
