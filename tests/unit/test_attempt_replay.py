"""The replay of an attempt that the page reads: its bytes are fixed, and what is not known is never drawn as if it were."""

from collections.abc import Callable

import msgspec
import numpy as np
import pytest

from models.messages.feedback import Colour
from models.messages.motion import JointState
from services.tablet import attempt_replay
from tests.golden.attempt_replay.vectors import FOLDER, NAMES, differences, load
from tests.mutations.samples import feedback

T_NS = 10**12


@pytest.mark.parametrize("name", NAMES)
def test_golden_bytes_are_written_as_they_were(name: str) -> None:
    assert attempt_replay.pack(load(name)) == (FOLDER / f"{name}.bin").read_bytes()


@pytest.mark.parametrize("name", NAMES)
def test_golden_bytes_are_read_as_they_say(name: str) -> None:
    assert differences(attempt_replay.unpack((FOLDER / f"{name}.bin").read_bytes()), load(name)) == []


def test_an_attempt_is_right_to_half_a_millimetre() -> None:
    told = feedback(T_NS)
    replay = attempt_replay.unpack(attempt_replay.pack(attempt_replay.from_feedback(told)))
    assert np.abs(replay.positions_mm - 1000.0 * told.joints_m).max() <= 0.5
    assert np.abs(replay.standard_mm - 1000.0 * told.standard_m).max() <= 0.51
    assert replay.keyframes == (0, 3, 6, 9)
    assert replay.frame_us == 33_333
    assert not replay.out_of_range


def test_a_keyframe_between_two_frames_is_shown_at_the_nearer_one() -> None:
    told = feedback(T_NS)
    first_ns, second_ns, third_ns, last_ns = told.keyframes_ns
    between = msgspec.structs.replace(told, keyframes_ns=(first_ns, second_ns + 16_000_000, third_ns + 17_000_000, last_ns))
    assert attempt_replay.from_feedback(between).keyframes == (0, 3, 7, 9)


def test_a_joint_outside_the_layout_becomes_unknown_and_grey() -> None:
    told = feedback(T_NS)
    joints_m = told.joints_m.copy()
    joints_m[4, 9] = (0.0, 33.0, 0.0)
    replay = attempt_replay.from_feedback(msgspec.structs.replace(told, joints_m=joints_m))
    assert replay.out_of_range
    assert replay.states[4, 9] == JointState.UNKNOWN
    assert replay.colours[4, 9] == Colour.GREY
    assert (replay.positions_mm[4, 9] == 0).all()
    assert (replay.colours != Colour.GREY).sum() == replay.colours.size - 1


def test_a_standard_that_is_not_known_has_no_place() -> None:
    told = feedback(T_NS)
    standard_m = told.standard_m.copy()
    standard_m[2, 3] = np.nan
    replay = attempt_replay.from_feedback(msgspec.structs.replace(told, standard_m=standard_m))
    assert (replay.standard_mm[2, 3] == attempt_replay.UNKNOWN_MM).all()
    assert not replay.out_of_range
    standard_m[2, 4] = (0.0, 0.0, 40.0)
    far = attempt_replay.from_feedback(msgspec.structs.replace(told, standard_m=standard_m))
    assert (far.standard_mm[2, 4] == attempt_replay.UNKNOWN_MM).all()
    assert far.out_of_range


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda data: data[:-1], "bytes are no replay of 6 frames"),
        (lambda data: data + b"\0", "bytes are no replay of 6 frames"),
        (lambda data: data[:21], "21 bytes"),
        (lambda data: b"XBRP" + data[4:], "begins with"),
        (lambda data: data[:4] + b"\2" + data[5:], "version 2"),
        (lambda data: data[:5] + b"\x12" + data[6:], "18 joints"),
        (lambda data: data[:8] + b"\0\0" + data[10:], "0 frames"),
        (lambda data: data[:20] + b"\6\0" + data[22:], "keyframes"),
        (lambda data: data[:14] + b"\5\0" + data[16:], "keyframes"),
        (lambda data: data[:28] + b"\3" + data[29:], "state or colour"),
        (lambda data: data[:29] + b"\4" + data[30:], "state or colour"),
    ],
)
def test_bytes_that_are_no_replay_are_refused(damage: Callable[[bytes], bytes], message: str) -> None:
    with pytest.raises(attempt_replay.AttemptReplayError, match=message):
        attempt_replay.unpack(damage(attempt_replay.pack(load("jump"))))
