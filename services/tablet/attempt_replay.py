"""Binary layout of an attempt for the page's slow replay: fixed, versioned, little-endian, 22 + 238 bytes a frame.

    offset  size  field
         0     4  magic "KBRP"
         4     1  version (1)
         5     1  number of joints (17)
         6     1  flags: bit 0, a place was out of the range of this layout and is sent as unknown
         7     1  reserved (0)
         8     2  T, number of frames, uint16, at least 1
        10     4  from one frame to the next in microseconds, uint32
        14     8  frames of the four keyframes (start, exertion, peak, end), 4 x uint16, each after the one before or the same
        22  136T  the pupil: for each frame, for each joint, 8 bytes: int16 x, y, z in mm; uint8 state; uint8 colour
  22+136T  102T  how it should look: for each frame, for each joint, int16 x, y, z in mm; -32768 three times where nothing is known

States are those of a motion frame; colours are 0 grey, 1 green, 2 yellow, 3 red. An UNKNOWN joint carries zeros. The page reads the
same layout; both are held to the vectors in `tests/golden/attempt_replay`.
"""

import struct
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
import numpy.typing as npt

from models.arrays import Bool, Float, Float32, UInt8
from models.messages.feedback import Colour, Feedback
from models.messages.motion import JointState
from models.skeleton import coco

MAGIC: Final = b"KBRP"
VERSION: Final = 1
MEDIA_TYPE: Final = "application/octet-stream"
OUT_OF_RANGE: Final = 1
"""Flag: at least one place did not fit and was withheld."""
UNKNOWN_MM: Final = int(np.iinfo(np.int16).min)
"""Of all three coordinates where it is not known how it should look."""

_HEADER = struct.Struct("<4sBBBBHI4H")
_JOINT = np.dtype([("position_mm", "<i2", 3), ("state", "u1"), ("colour", "u1")])
_PLACE = np.dtype(("<i2", 3))
_LIMIT_MM = int(np.iinfo(np.int16).max)


class AttemptReplayError(ValueError):
    """Bytes that are not an attempt's replay of this version."""


@dataclass(frozen=True, eq=False)
class AttemptReplay:
    """What the page draws of an attempt.

    Attributes:
        frame_us: from one frame to the next.
        keyframes: frames of start, exertion, peak and end.
        out_of_range: a place did not fit into the layout and is unknown here.
        positions_mm: (T, 17, 3) of the pupil, world frame; zero where UNKNOWN.
        states: (T, 17) `JointState`.
        colours: (T, 17) `Colour`.
        standard_mm: (T, 17, 3) how it should look; `UNKNOWN_MM` where nothing is known.
    """

    frame_us: int
    keyframes: tuple[int, int, int, int]
    out_of_range: bool
    positions_mm: npt.NDArray[np.int16]
    states: UInt8
    colours: UInt8
    standard_mm: npt.NDArray[np.int16]


def size(frames: int) -> int:
    """Bytes of an attempt with so many frames."""
    return _HEADER.size + frames * coco.COUNT * (_JOINT.itemsize + _PLACE.itemsize)


def from_feedback(feedback: Feedback) -> AttemptReplay:
    """Reduce an attempt to what the page draws. A place outside +-32.767 m becomes unknown and grey, and the replay says so."""
    positions_mm, fits = _rounded(feedback.joints_m)
    standard_mm, standard_fits = _rounded(feedback.standard_m)
    known = (feedback.states != JointState.UNKNOWN) & fits
    first, second, third, fourth = (feedback.frame_of(t_ns) for t_ns in feedback.keyframes_ns)
    return AttemptReplay(
        frame_us=round(feedback.frame_ns / 1000),
        keyframes=(first, second, third, fourth),
        out_of_range=not bool(fits.all() and (standard_fits | np.isnan(feedback.standard_m).any(axis=2)).all()),
        positions_mm=np.where(known[..., None], positions_mm, 0).astype(np.int16),
        states=np.where(known, feedback.states, JointState.UNKNOWN).astype(np.uint8),
        colours=np.where(known, feedback.colours, Colour.GREY).astype(np.uint8),
        standard_mm=np.where(standard_fits[..., None], standard_mm, UNKNOWN_MM).astype(np.int16),
    )


def pack(replay: AttemptReplay) -> bytes:
    """The replay as `size(T)` bytes."""
    flags = OUT_OF_RANGE if replay.out_of_range else 0
    header = _HEADER.pack(MAGIC, VERSION, coco.COUNT, flags, 0, len(replay.states), replay.frame_us, *replay.keyframes)
    joints = np.empty(replay.states.shape, dtype=_JOINT)
    joints["position_mm"] = replay.positions_mm
    joints["state"] = replay.states
    joints["colour"] = replay.colours
    return header + joints.tobytes() + replay.standard_mm.astype("<i2").tobytes()


def unpack(data: bytes) -> AttemptReplay:
    """Read what `pack` wrote; used by clients in Python.

    Raises:
        AttemptReplayError: of another length, without the magic, or of another version, number of joints, state or colour.
    """
    if len(data) < _HEADER.size:
        raise AttemptReplayError(f"{len(data)} bytes are no attempt's replay")
    magic, version, joint_count, flags, _, count, frame_us, first, second, third, fourth = _HEADER.unpack_from(data)
    keyframes = first, second, third, fourth
    if magic != MAGIC:
        raise AttemptReplayError(f"an attempt's replay begins with {MAGIC!r}, not {magic!r}")
    if version != VERSION or joint_count != coco.COUNT:
        raise AttemptReplayError(f"replay of version {version} with {joint_count} joints; this KineBox reads {VERSION}")
    if count == 0 or len(data) != size(count):
        raise AttemptReplayError(f"{len(data)} bytes are no replay of {count} frames")
    if fourth >= count or any(before > after for before, after in pairwise(keyframes)):
        raise AttemptReplayError(f"the keyframes {keyframes} of a replay of {count} frames")
    joints = np.frombuffer(data, _JOINT, count * coco.COUNT, _HEADER.size).reshape(count, coco.COUNT)
    standard = np.frombuffer(data, "<i2", offset=_HEADER.size + joints.nbytes)
    if int(joints["state"].max()) > JointState.SEEN or int(joints["colour"].max()) > Colour.RED:
        raise AttemptReplayError("a joint's state or colour is not known")
    return AttemptReplay(
        frame_us=frame_us,
        keyframes=keyframes,
        out_of_range=bool(flags & OUT_OF_RANGE),
        positions_mm=joints["position_mm"].copy(),
        states=joints["state"].copy(),
        colours=joints["colour"].copy(),
        standard_mm=standard.reshape(count, coco.COUNT, 3).astype(np.int16),
    )


def _rounded(places_m: Float32) -> tuple[Float, Bool]:
    """Places (T, 17, 3) in whole millimetres, and (T, 17) whether they are known and fit."""
    rounded_mm = np.rint(places_m.astype(np.float64) * 1000)
    fits = np.asarray((np.abs(rounded_mm) <= _LIMIT_MM).all(axis=2))
    return np.where(fits[..., None], rounded_mm, 0), fits
