"""The motion frame that the page reads: its bytes are fixed, and what does not fit is never drawn as if it did."""

from collections.abc import Callable

import msgspec
import numpy as np
import pytest

from models.arrays import Float
from models.messages.motion import CameraUse, JointState, Motion
from models.skeleton import coco
from services.tablet import motion_frame
from tests.golden.motion_frame.vectors import FOLDER, NAMES, differences, load


def motion(joints_m: Float | None = None, sigma_m: float = 0.01, views: int = 3) -> Motion:
    joints = np.ones((coco.COUNT, 3)) if joints_m is None else joints_m
    return Motion(
        kind="live",
        sequence=7,
        epoch=1,
        t_ns=1_000_000_000,
        t_newest_ns=1_020_000_000,
        t_published_ns=1_100_000_000,
        joints_m=joints.astype(np.float32),
        covariance_m2=np.tile(np.eye(3, dtype=np.float32) * np.float32(sigma_m**2), (coco.COUNT, 1, 1)),
        states=np.full(coco.COUNT, JointState.SEEN, np.uint8),
        views=np.full(coco.COUNT, views, np.uint32),
        cameras=(CameraUse("cam0", True, 20.0),),
    )


@pytest.mark.parametrize("name", NAMES)
def test_golden_bytes_are_written_as_they_were(name: str) -> None:
    assert motion_frame.pack(load(name)) == (FOLDER / f"{name}.bin").read_bytes()


@pytest.mark.parametrize("name", NAMES)
def test_golden_bytes_are_read_as_they_say(name: str) -> None:
    assert differences(motion_frame.unpack((FOLDER / f"{name}.bin").read_bytes()), load(name)) == []


def test_a_client_on_the_box_can_measure_latency_from_the_frame() -> None:
    frame = motion_frame.from_motion(motion(), now_ns=1_150_000_000)
    assert frame.t_newest_ns == 1_020_000_000
    assert frame.server_latency_us == 130_000


def test_latency_saturates_and_is_never_negative() -> None:
    assert motion_frame.from_motion(motion(), now_ns=1_000_000_000).server_latency_us == 0
    assert motion_frame.from_motion(motion(), now_ns=10**16).server_latency_us == 2**32 - 1


def test_a_joint_outside_the_layout_becomes_unknown_and_not_a_wrong_place() -> None:
    joints_m = np.ones((coco.COUNT, 3))
    joints_m[9] = (0.0, 33.0, 0.0)
    frame = motion_frame.from_motion(motion(joints_m), now_ns=1_100_000_000)
    assert frame.out_of_range
    assert frame.states[9] == JointState.UNKNOWN
    assert (frame.positions_mm[9] == 0).all()
    assert (np.delete(frame.states, 9) == JointState.SEEN).all()


def test_sigma_saturates_at_its_largest_value() -> None:
    assert (motion_frame.from_motion(motion(sigma_m=0.0123), now_ns=0).sigma_mm == 12).all()
    assert (motion_frame.from_motion(motion(sigma_m=100.0), now_ns=0).sigma_mm == 65535).all()


def test_an_unknown_joint_carries_no_coordinates() -> None:
    states = np.full(coco.COUNT, JointState.SEEN, np.uint8)
    states[0] = JointState.UNKNOWN
    unknown = msgspec.structs.replace(motion(), states=states)
    assert (motion_frame.from_motion(unknown, now_ns=0).positions_mm[0] == 0).all()


def test_a_ninth_camera_is_refused_and_not_dropped() -> None:
    with pytest.raises(motion_frame.MotionFrameError, match="eighth"):
        motion_frame.from_motion(motion(views=0b1_0000_0001), now_ns=0)


def test_counters_go_on_from_zero() -> None:
    late = msgspec.structs.replace(motion(), sequence=2**32 + 5)
    assert motion_frame.from_motion(late, now_ns=0).sequence == 5


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda data: data[:-1], "205 bytes"),
        (lambda data: data + b"\0", "207 bytes"),
        (lambda data: b"XBMF" + data[4:], "begins with"),
        (lambda data: data[:4] + b"\2" + data[5:], "version 2"),
        (lambda data: data[:5] + b"\7" + data[6:], "kind 7"),
        (lambda data: data[:6] + b"\x12" + data[7:], "18 joints"),
        (lambda data: data[:44] + b"\3" + data[45:], "state is 3"),
    ],
)
def test_bytes_that_are_no_frame_are_refused(damage: Callable[[bytes], bytes], message: str) -> None:
    data = motion_frame.pack(load("walking"))
    with pytest.raises(motion_frame.MotionFrameError, match=message):
        motion_frame.unpack(damage(data))
