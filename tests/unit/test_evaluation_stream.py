"""The stream that attempts are found in: what is missing is unknown, and what does not belong together is never joined."""

from dataclasses import replace

import msgspec
import numpy as np
import pytest

from models.messages.motion import JointState, Motion
from services.evaluation.config import EvaluationConfig
from services.evaluation.stream import FARTHEST_M, KEPT_S, LONGEST_GAP_S, Stream
from services.fusion.config import PRESETS
from tests.mutations.samples import motion

FRAME_NS = 33_333_333
CONFIG = EvaluationConfig({}, {})
PLAYED_TWICE_AS_FAST = replace(CONFIG, speed=2.0, slack_frames=15.0)


def smooth(number: int, *, late_ns: int = 0, speed: float = 1.0, epoch: int = 0) -> Motion:
    made: Motion = msgspec.structs.replace(
        motion(10**12 + round(number * FRAME_NS / speed) + late_ns, number, "smooth"), epoch=epoch
    )
    return made


def streamed(*numbers: int) -> Stream:
    stream = Stream()
    for number in numbers:
        stream.take(smooth(number), CONFIG)
    return stream


def test_the_grid_is_fusions() -> None:
    assert {preset.frame_s for preset in PRESETS.values()} == {CONFIG.frame_s}


def test_frames_follow_one_another() -> None:
    track = streamed(5, 6, 7).track(-1.0, 10.0, CONFIG.frame_s)
    assert track.t_s == pytest.approx(np.arange(3) * CONFIG.frame_s)
    assert (track.states == JointState.SEEN).all()


def test_a_motion_that_never_came_is_an_unknown_frame_and_is_counted() -> None:
    stream = streamed(0, 1, 4)
    track = stream.track(-1.0, 10.0, CONFIG.frame_s)
    assert (track.states == JointState.UNKNOWN).all(axis=1).tolist() == [False, False, True, True, False]
    assert np.isnan(track.joints_m[2:4]).all()
    assert stream.missed == 2


@pytest.mark.parametrize(
    ("what", "after"),
    [
        ("another epoch", smooth(6, epoch=1)),
        ("another fusion, which counts anew", smooth(0, late_ns=6 * FRAME_NS)),
        ("the same motion again", smooth(5)),
        ("one that is older", smooth(4)),
        ("a pause of fusion, after which it counts on", smooth(6, late_ns=10**9)),
        ("half a frame off the grid", smooth(6, late_ns=FRAME_NS // 2)),
        ("a time before the last one", smooth(6, late_ns=-(10**9))),
        ("too long a gap", smooth(6 + round(LONGEST_GAP_S / CONFIG.frame_s))),
    ],
)
def test_what_does_not_go_on_begins_a_new_stream(what: str, after: Motion) -> None:
    stream = streamed(3, 4, 5)
    assert not stream.goes_on(after, CONFIG), what
    assert [frame.number for frame in stream.take(after, CONFIG)] == [0]
    assert len(stream.frames) == 1
    assert stream.goes_on(smooth(after.sequence + 1, late_ns=after.t_ns - smooth(after.sequence).t_ns, epoch=after.epoch), CONFIG)


def test_a_gap_that_is_too_long_is_counted_all_the_same() -> None:
    stream = streamed(0, 1, 100)
    assert stream.missed == 98
    assert len(stream.frames) == 1


def test_what_is_played_faster_is_of_the_pupils_own_time() -> None:
    stream = Stream()
    for number in range(10):
        stream.take(smooth(number, speed=2.0), PLAYED_TWICE_AS_FAST)
    assert len(stream.frames) == 10
    assert stream.track(0.0, 10.0, CONFIG.frame_s).frame_s == pytest.approx(CONFIG.frame_s)


def test_a_player_that_was_late_does_not_tear_the_stream() -> None:
    stream = Stream()
    stream.take(smooth(0, speed=2.0), PLAYED_TWICE_AS_FAST)
    stream.take(smooth(1, speed=2.0, late_ns=6 * FRAME_NS), PLAYED_TWICE_AS_FAST)
    stream.take(smooth(2, speed=2.0), PLAYED_TWICE_AS_FAST)
    assert [frame.number for frame in stream.frames] == [0, 1, 2]


def test_the_stream_does_not_grow_for_ever() -> None:
    stream = streamed(*range(round(3 * KEPT_S / CONFIG.frame_s)))
    assert len(stream.frames) == pytest.approx(KEPT_S / CONFIG.frame_s, abs=1)
    with pytest.raises(ValueError, match="nothing is kept"):
        stream.track(0.0, 1.0, CONFIG.frame_s)


@pytest.mark.parametrize("place_m", [2 * FARTHEST_M, -1e38])
def test_a_joint_outside_every_gym_is_nowhere(place_m: float) -> None:
    joints_m = smooth(0).joints_m.copy()
    joints_m[9] = place_m
    stream = Stream()
    stream.take(msgspec.structs.replace(smooth(0), joints_m=joints_m), CONFIG)
    assert stream.newest.states[9] == JointState.UNKNOWN
    assert np.isnan(stream.newest.joints_m[9]).all()
    assert (np.delete(stream.newest.states, 9) == JointState.SEEN).all()


def test_a_joint_with_an_impossible_covariance_is_nowhere() -> None:
    covariance_m2 = smooth(0).covariance_m2.copy()
    covariance_m2[3, 1, 1] = -1.0
    covariance_m2[4, 0, 1] = 3e38
    stream = Stream()
    stream.take(msgspec.structs.replace(smooth(0), covariance_m2=covariance_m2), CONFIG)
    assert np.flatnonzero(stream.newest.states == JointState.UNKNOWN).tolist() == [3, 4]
