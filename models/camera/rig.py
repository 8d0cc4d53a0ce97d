"""A rig: the calibrated cameras of one site, read from its TOML file."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import combinations

import msgspec
import numpy as np

from models.arrays import Float
from models.camera.pinhole import Camera
from models.camera.plausible import require_plausible
from models.errors import UserError

RIG_VERSION = 1
MIN_BASELINE_M = 0.01


@dataclass(frozen=True, eq=False)
class Rig:
    """Cameras by name, in the order of the calibration file."""

    cameras: tuple[Camera, ...]

    def __post_init__(self) -> None:
        names = [camera.name for camera in self.cameras]
        doubled = sorted({name for name in names if names.count(name) > 1})
        if doubled:
            raise UserError(f"calibration: camera '{doubled[0]}' occurs twice; remove one of the two")

    def __iter__(self) -> Iterator[Camera]:
        return iter(self.cameras)

    def __len__(self) -> int:
        return len(self.cameras)

    @property
    def names(self) -> tuple[str, ...]:
        """The cameras' names, in the rig's order."""
        return tuple(camera.name for camera in self.cameras)

    def index(self, name: str) -> int:
        """Position of a camera; KeyError if the rig has none of that name."""
        try:
            return self.names.index(name)
        except ValueError:
            raise KeyError(name) from None

    def select(self, names: Iterable[str]) -> "Rig":
        """The rig of the named cameras, in the order given.

        Raises:
            UserError: a name is not in this calibration.
        """
        known = {camera.name: camera for camera in self.cameras}
        chosen = []
        for name in names:
            if name not in known:
                raise UserError(
                    f"camera '{name}' is not in the calibration, which knows {', '.join(known) or 'none'}; "
                    "calibrate it or correct its name in the site file"
                )
            chosen.append(known[name])
        return Rig(tuple(chosen))

    def with_shifts(self, shifts_px: Float) -> "Rig":
        """The same rig with `shift_px` replaced by (cameras, 2) offsets in pixels."""
        return Rig(tuple(replace(c, shift_px=np.asarray(s, np.float64)) for c, s in zip(self, shifts_px, strict=True)))


class _CameraRecord(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    name: str
    size_px: tuple[int, int]
    matrix_px: list[list[float]]
    rotation: list[list[float]]
    translation_m: list[float]
    distortion: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0, 0.0)
    shift_px: tuple[float, ...] = (0.0, 0.0)


class _RigRecord(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    version: int
    camera: list[_CameraRecord]
    source: str = ""


def decode_rig(data: bytes, origin: str) -> Rig:
    """Read a rig from the bytes of a calibration file.

    Args:
        data: TOML text.
        origin: the file's name, for error messages.

    Raises:
        UserError: not TOML, a key unknown or missing, a value of the wrong kind, a rotation that is none, or a lens that no camera
            has.
    """
    try:
        record = msgspec.toml.decode(data, type=_RigRecord)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise UserError(f"calibration {origin}: {error}; correct the file or calibrate again") from error
    except ValueError as error:  # Python reads no whole number of more than 4300 digits.
        raise UserError(f"calibration {origin}: a number in it has thousands of digits; calibrate again") from error
    if record.version != RIG_VERSION:
        raise UserError(f"calibration {origin}: version {record.version} is not known to this KineBox ({RIG_VERSION})")
    try:
        rig = Rig(tuple(_camera(entry) for entry in record.camera))
        _require_depth(rig)
    except UserError as error:
        raise UserError(f"calibration {origin}: {error}") from error
    return rig


def _require_depth(rig: Rig) -> None:
    for a, b in combinations(rig, 2):
        if np.linalg.norm(a.centre_m - b.centre_m) < MIN_BASELINE_M:
            raise UserError(f"cameras '{a.name}' and '{b.name}' are in the same place, so they see no depth; calibrate again")


def _camera(record: _CameraRecord) -> Camera:
    def array(field: str, value: object) -> Float:
        try:
            return np.asarray(value, dtype=np.float64)
        except ValueError as error:
            raise UserError(f"camera '{record.name}': {field} is not a regular array of numbers") from error

    camera = Camera(
        name=record.name,
        size_px=record.size_px,
        matrix_px=array("matrix_px", record.matrix_px),
        distortion=array("distortion", record.distortion),
        rotation=array("rotation", record.rotation),
        translation_m=array("translation_m", record.translation_m),
        shift_px=array("shift_px", record.shift_px),
    )
    require_plausible(camera)
    return camera


def encode_rig(rig: Rig, source: str) -> bytes:
    """The calibration file of a rig; `decode_rig` reads the same values back, to the last digit.

    Args:
        rig: any rig.
        source: one line on where the calibration comes from, for people who open the file.
    """
    head = f"version = {RIG_VERSION}\nsource = {_quoted(source)}\n"
    return "\n".join((head, *(_camera_table(camera) for camera in rig))).encode()


def _camera_table(camera: Camera) -> str:
    return "\n".join(
        (
            "[[camera]]",
            f"name = {_quoted(camera.name)}",
            f"size_px = {list(camera.size_px)}",
            f"matrix_px = {_rows(camera.matrix_px)}",
            f"distortion = {_row(camera.distortion)}",
            f"rotation = {_rows(camera.rotation)}",
            f"translation_m = {_row(camera.translation_m)}",
            f"shift_px = {_row(camera.shift_px)}",
            "",
        )
    )


def _rows(matrix: Float) -> str:
    return "[\n" + "".join(f"    {_row(row)},\n" for row in matrix) + "]"


def _row(values: Float) -> str:
    return f"[{', '.join(repr(float(value)) for value in values)}]"


def _quoted(text: str) -> str:
    # A JSON string is a TOML basic string, but for the delete character, which TOML wants escaped.
    return msgspec.json.encode(text).decode().replace("\x7f", "\\u007f")
