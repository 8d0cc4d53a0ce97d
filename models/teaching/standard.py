"""How an action is done well: a performance that others are compared with, and its file. Pure: bytes in, bytes out.

The canonical frame: right-handed, metres, z up, the floor at 0; the first frame's middle of the hips above the origin, looking
along x; whoever performs leads with the right side.

A file is an .npz with these keys; nothing is unpickled:

| Key | Shape | What |
|---|---|---|
| `format`, `layout` | | "kinebox-standard", 1: the layout of the file |
| `action`, `version`, `origin`, `stature_m` | | as `Standard` |
| `moments_s` | (1 + E, 4) | keyframes of the standard and of its E exemplars |
| `ends` | (1 + E,) | where each ends in `joints` |
| `joints` | (sum of frames, 17, 3) | int16, `UNIT_M` metres, first the standard, then its exemplars; the least number is unknown |
| `spread` | (S, 17) | uint16, `UNIT_M` metres; the largest number is unknown |
"""

import io
import math
import zipfile
import zlib
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from models.arrays import Float
from models.errors import UserError
from models.skeleton import coco

FORMAT: Final = "kinebox-standard"
LAYOUT: Final = 1
RATE_HZ: Final = 30.0
FRAME_S: Final = 1 / RATE_HZ
UNIT_M: Final = 0.0005
LONGEST_S: Final = 20.0
"""Nothing that is taught as one movement takes longer."""
BEFORE_S: Final = 0.2
AFTER_S: Final = 0.15
"""A performance begins so long before its start and ends so long after its end, as far as that is known."""
LAST_VERSION: Final = 999_999
"""Nobody counts so far; a file with a larger number was damaged or made up, and would leave none for those after it."""
_UNKNOWN: Final = -(2**15)
_FARTHEST_M: Final = UNIT_M * (2**15 - 2)
_UNKNOWN_SPREAD: Final = 2**16 - 1
_UNREADABLE: Final = (
    *(ValueError, EOFError, KeyError, TypeError, AttributeError, OSError, zipfile.BadZipFile, zlib.error),
    *(NotImplementedError, RuntimeError, SyntaxError, OverflowError, MemoryError),
)
"""What zipfile and numpy raise over damaged files."""
_KEYS: Final = {"format", "layout", "action", "version", "origin", "stature_m", "moments_s", "ends", "joints", "spread"}
_STATURE_M: Final = (0.5, 2.5)

Array = npt.NDArray[Any]
Moments = tuple[float, float, float, float]


class NoStandardError(UserError):
    """What a file holds can be no standard, neither by another name nor for a newer KineBox: another must take its place."""


@dataclass(frozen=True, eq=False)
class Exemplar:
    """A performance with its keyframes.

    Attributes:
        joints_m: (T, 17, 3) COCO points in the canonical frame at `RATE_HZ`; NaN is unknown.
        moments_s: start, exertion, peak and end, seconds from the first frame.
    """

    joints_m: Float
    moments_s: Moments

    def __post_init__(self) -> None:
        count = len(self.joints_m)
        if self.joints_m.shape != (count, coco.COUNT, 3) or not 2 <= count <= LONGEST_S * RATE_HZ:
            raise ValueError(f"a performance has the shape (T, {coco.COUNT}, 3), T from 2 to {LONGEST_S * RATE_HZ:.0f}")
        if np.isinf(self.joints_m).any() or np.nanmax(np.abs(self.joints_m), initial=0.0) > _FARTHEST_M:
            raise ValueError(f"a performance stays within {_FARTHEST_M:.1f} m of where it begins")
        start, exertion, peak, end = self.moments_s
        if not 0 <= start < exertion < peak < end <= (count - 0.5) * FRAME_S:
            raise ValueError(f"keyframes follow one another within the {count} frames of a performance: {self.moments_s}")


@dataclass(frozen=True, eq=False)
class Standard:
    """How an action is done well.

    Attributes:
        action: its name.
        version: counts the standards of this action; from 1 to `LAST_VERSION`.
        origin: in words: a simulated performance, a recorded one and when, an imported file.
        performance: what others are compared with.
        spread_m: (S, 17) how far a joint of a good performance is from there, root of the mean square over good performances of a
            body of this size, once they are aligned; NaN where it is not known. S are the frames of `performance`.
        stature_m: of whose size `performance` is.
        exemplars: more good performances, by other bodies and at other tempi; by them attempts are found and timed.
    """

    action: str
    version: int
    origin: str
    performance: Exemplar
    spread_m: Float
    stature_m: float
    exemplars: tuple[Exemplar, ...] = ()

    def __post_init__(self) -> None:
        if not self.action or not 1 <= self.version <= LAST_VERSION:
            raise ValueError(f"a standard has an action, and a version from 1 to {LAST_VERSION}")
        if not _STATURE_M[0] <= self.stature_m <= _STATURE_M[1]:
            raise ValueError(f"nobody is {self.stature_m:g} m tall")
        if self.spread_m.shape != (len(self.joints_m), coco.COUNT) or (self.spread_m < 0).any() or np.isinf(self.spread_m).any():
            raise ValueError("the spread of a standard is a length of each joint in each frame, or unknown")

    @property
    def joints_m(self) -> Float:
        """(S, 17, 3) of `performance`."""
        return self.performance.joints_m

    @property
    def moments_s(self) -> Moments:
        """Keyframes of `performance`."""
        return self.performance.moments_s


def same_instants(times_s: Float, ours: Moments, theirs: Moments) -> Float:
    """Instants of a performance in another one: even between keyframes, at the same pace before the first and after the last."""
    inside = np.interp(times_s, ours, theirs)
    return np.asarray(inside + np.minimum(times_s - ours[0], 0.0) + np.maximum(times_s - ours[-1], 0.0))


def encode(standard: Standard) -> bytes:
    """The file of a standard. The same standard gives the same bytes."""
    performances = (standard.performance, *standard.exemplars)
    joints = np.concatenate([one.joints_m for one in performances])
    spread = np.where(np.isnan(standard.spread_m), _UNKNOWN_SPREAD, np.minimum(standard.spread_m / UNIT_M, _UNKNOWN_SPREAD - 1))
    arrays: dict[str, Array] = {
        "format": np.array(FORMAT),
        "layout": np.array(LAYOUT),
        "action": np.array(standard.action),
        "version": np.array(standard.version),
        "origin": np.array(standard.origin),
        "stature_m": np.array(standard.stature_m),
        "moments_s": np.array([one.moments_s for one in performances]),
        "ends": np.cumsum([len(one.joints_m) for one in performances]),
        "joints": np.where(np.isnan(joints), _UNKNOWN, np.round(joints / UNIT_M)).astype(np.int16),
        "spread": np.round(spread).astype(np.uint16),
    }
    file = io.BytesIO()
    np.savez_compressed(file, allow_pickle=False, **arrays)
    return file.getvalue()


def decode(data: bytes, name: str) -> Standard:
    """Read a standard's file.

    Args:
        data: content of the .npz.
        name: how errors call the file.

    Raises:
        NoStandardError: no such file, or a key that is missing, unknown or wrong.
        UserError: one of a newer layout.
    """
    arrays = _arrays(data, name)
    if str(arrays.get("format")) != FORMAT:
        raise NoStandardError(f"{name}: is not a standard's file of KineBox; record a standard or export it again")
    layout = arrays.get("layout", np.array(None))
    if layout.shape != () or layout.dtype.kind not in "iu" or layout != LAYOUT:
        raise UserError(f"{name}: its layout is {layout}, this KineBox reads {LAYOUT}; update KineBox, or export the file again")
    for key in sorted(_KEYS ^ arrays.keys()):
        raise NoStandardError(f"{name}: {key} is {'missing' if key in _KEYS else 'unknown'}; export the file again")
    try:
        return _standard(arrays)
    except (ValueError, TypeError, IndexError) as error:
        raise NoStandardError(f"{name}: is damaged ({error}); export the file again") from error


def _standard(arrays: dict[str, Array]) -> Standard:
    _require(arrays, "action", "U", ())
    _require(arrays, "origin", "U", ())
    _require(arrays, "version", "iu", ())
    _require(arrays, "stature_m", "f", ())
    count = len(arrays["ends"]) if arrays["ends"].ndim else 0
    _require(arrays, "ends", "iu", (count,))
    _require(arrays, "moments_s", "f", (count, 4))
    frames = int(arrays["ends"][-1]) if count else 0
    _require(arrays, "joints", "i", (frames, coco.COUNT, 3))
    _require(arrays, "spread", "u", (int(arrays["ends"][0]) if count else 0, coco.COUNT))
    if not count or (np.diff(arrays["ends"], prepend=0) < 2).any():
        raise ValueError("it holds no performance")
    joints = np.where(arrays["joints"] == _UNKNOWN, np.nan, arrays["joints"] * UNIT_M)
    joints[np.isnan(joints).any(axis=2)] = np.nan
    performances = []
    for part, moments in zip(np.split(joints, arrays["ends"][:-1]), arrays["moments_s"].tolist(), strict=True):
        if not all(map(math.isfinite, moments)):
            raise ValueError("a keyframe has no time")
        performances.append(Exemplar(part, tuple(moments)))
    return Standard(
        action=str(arrays["action"]),
        version=int(arrays["version"]),
        origin=str(arrays["origin"]),
        performance=performances[0],
        spread_m=np.where(arrays["spread"] == _UNKNOWN_SPREAD, np.nan, arrays["spread"] * UNIT_M),
        stature_m=float(arrays["stature_m"]),
        exemplars=tuple(performances[1:]),
    )


def _require(arrays: dict[str, Array], key: str, kinds: str, shape: tuple[int, ...]) -> None:
    value = arrays[key]
    if value.dtype.kind not in kinds or value.shape != shape:
        raise ValueError(f"{key} is {value.dtype} of the shape {value.shape}, needed {shape}")


def _arrays(data: bytes, name: str) -> dict[str, Array]:
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            return {key: archive[key] for key in archive}
    except _UNREADABLE as error:
        raise NoStandardError(f"{name}: is no standard's file, or is damaged; export or record it again") from error
