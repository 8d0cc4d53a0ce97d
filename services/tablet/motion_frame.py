"""Binary layout of one motion for the page: fixed, versioned, little-endian, 206 bytes.

    offset  size  field
         0     4  magic "KBMF"
         4     1  version (1)
         5     1  kind: 0 live, 1 smooth
         6     1  number of joints (17)
         7     1  flags: bit 0, a joint was out of the range of this layout and is sent as UNKNOWN
         8     4  sequence, uint32, counts on from 0 after 2^32 - 1
        12     4  epoch, uint32, as above
        16     8  t_ns, int64: CLOCK_MONOTONIC of the instant described
        24     8  t_newest_ns, int64: CLOCK_MONOTONIC at mid-exposure of the newest observation used
        32     4  server_latency_us, uint32: from t_newest_ns until the server packed the frame; saturates
        36   170  joints, 10 bytes each: int16 x, y, z in mm; uint16 sigma in mm (saturates); uint8 state; uint8 views

`web/src/protocol/motionFrame.ts` reads the same layout; both are held to the vectors in `tests/golden/motion_frame`.
"""

import struct
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
import numpy.typing as npt

from models.arrays import UInt8
from models.messages.motion import JointState, Motion
from models.skeleton import coco

MAGIC: Final = b"KBMF"
VERSION: Final = 1
KINDS: Final = ("live", "smooth")
OUT_OF_RANGE: Final = 1
"""Flag: the coordinates of at least one joint did not fit and were withheld."""

_HEADER = struct.Struct("<4sBBBBIIqqI")
_JOINT = np.dtype([("position_mm", "<i2", 3), ("sigma_mm", "<u2"), ("state", "u1"), ("views", "u1")])
SIZE: Final = _HEADER.size + coco.COUNT * _JOINT.itemsize

_LIMIT_MM = int(np.iinfo(np.int16).max)
_SIGMA_LIMIT_MM = int(np.iinfo(np.uint16).max)
_LATENCY_LIMIT_US = 2**32 - 1
_VIEWS_LIMIT = 0xFF


class MotionFrameError(ValueError):
    """Bytes that are not a motion frame of this version, or a motion that this layout cannot carry."""


@dataclass(frozen=True, eq=False)
class MotionFrame:
    """What the page is told about one instant.

    Attributes:
        kind: as `Motion.kind`.
        sequence: as `Motion.sequence`, modulo 2^32.
        epoch: as `Motion.epoch`, modulo 2^32.
        t_ns: CLOCK_MONOTONIC of the instant described.
        t_newest_ns: mid-exposure of the newest observation used, so that a client on the same machine can measure latency.
        server_latency_us: microseconds from t_newest_ns until the frame was packed.
        out_of_range: a joint did not fit into the layout; it is UNKNOWN here.
        positions_mm: (17, 3) world frame.
        sigma_mm: (17,) root mean square of the three axes' standard deviations.
        states: (17,) `JointState`.
        views: (17,) bit i set if camera i was an inlier.
    """

    kind: Literal["live", "smooth"]
    sequence: int
    epoch: int
    t_ns: int
    t_newest_ns: int
    server_latency_us: int
    out_of_range: bool
    positions_mm: npt.NDArray[np.int16]
    sigma_mm: npt.NDArray[np.uint16]
    states: UInt8
    views: UInt8


def from_motion(motion: Motion, now_ns: int) -> MotionFrame:
    """Reduce a motion to what the page draws.

    A joint that lies outside +-32.767 m has no honest place in the layout: it becomes UNKNOWN with zero coordinates, and the
    frame says so. Sigma and latency saturate, which keeps them "at least this much". UNKNOWN joints carry zero coordinates.

    Args:
        motion: the message of the fusion process.
        now_ns: CLOCK_MONOTONIC now.

    Raises:
        MotionFrameError: a view above the eighth, which no site can have.
    """
    if int(motion.views.max(initial=0)) > _VIEWS_LIMIT:
        raise MotionFrameError("a joint was seen by a camera above the eighth; a motion frame holds eight")
    rounded_mm = np.rint(motion.joints_m.astype(np.float64) * 1000)
    fits = (np.abs(rounded_mm) <= _LIMIT_MM).all(axis=1)
    known = (motion.states != JointState.UNKNOWN) & fits
    variance_m2 = np.trace(motion.covariance_m2.astype(np.float64), axis1=1, axis2=2) / 3
    sigma_mm = np.clip(np.rint(1000 * np.sqrt(np.maximum(variance_m2, 0))), 0, _SIGMA_LIMIT_MM)
    return MotionFrame(
        kind=motion.kind,
        sequence=motion.sequence % 2**32,
        epoch=motion.epoch % 2**32,
        t_ns=motion.t_ns,
        t_newest_ns=motion.t_newest_ns,
        server_latency_us=min(max((now_ns - motion.t_newest_ns) // 1000, 0), _LATENCY_LIMIT_US),
        out_of_range=not bool(fits.all()),
        positions_mm=np.where(known[:, None], rounded_mm, 0).astype(np.int16),
        sigma_mm=sigma_mm.astype(np.uint16),
        states=np.where(known, motion.states, JointState.UNKNOWN).astype(np.uint8),
        views=motion.views.astype(np.uint8),
    )


def pack(frame: MotionFrame) -> bytes:
    """The frame as `SIZE` bytes."""
    header = _HEADER.pack(
        MAGIC,
        VERSION,
        KINDS.index(frame.kind),
        coco.COUNT,
        OUT_OF_RANGE if frame.out_of_range else 0,
        frame.sequence,
        frame.epoch,
        frame.t_ns,
        frame.t_newest_ns,
        frame.server_latency_us,
    )
    joints = np.empty(coco.COUNT, dtype=_JOINT)
    joints["position_mm"] = frame.positions_mm
    joints["sigma_mm"] = frame.sigma_mm
    joints["state"] = frame.states
    joints["views"] = frame.views
    return header + joints.tobytes()


def unpack(data: bytes) -> MotionFrame:
    """Read what `pack` wrote; used by clients in Python.

    Raises:
        MotionFrameError: of another length, without the magic, or of another version, kind, number of joints or state.
    """
    if len(data) != SIZE:
        raise MotionFrameError(f"{len(data)} bytes are no motion frame, which has {SIZE}")
    magic, version, kind, count, flags, sequence, epoch, t_ns, t_newest_ns, latency_us = _HEADER.unpack_from(data)
    if magic != MAGIC:
        raise MotionFrameError(f"a motion frame begins with {MAGIC!r}, not {magic!r}")
    if version != VERSION:
        raise MotionFrameError(f"motion frame version {version}; this KineBox reads {VERSION}")
    if kind >= len(KINDS) or count != coco.COUNT:
        raise MotionFrameError(f"motion frame of kind {kind} with {count} joints is not known")
    joints = np.frombuffer(data, _JOINT, offset=_HEADER.size)
    if int(joints["state"].max()) > JointState.SEEN:
        raise MotionFrameError(f"a joint's state is {int(joints['state'].max())}, which is not known")
    return MotionFrame(
        kind=KINDS[kind],
        sequence=sequence,
        epoch=epoch,
        t_ns=t_ns,
        t_newest_ns=t_newest_ns,
        server_latency_us=latency_us,
        out_of_range=bool(flags & OUT_OF_RANGE),
        positions_mm=joints["position_mm"].copy(),
        sigma_mm=joints["sigma_mm"].copy(),
        states=joints["state"].copy(),
        views=joints["views"].copy(),
    )
