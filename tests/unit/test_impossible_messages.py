"""Messages that broke a process when mutated ones were first sent through it, or that no process may believe."""

import msgspec
import numpy as np
import pytest

from models.messages import codec, topics
from models.messages.addressed import read_health, read_observation
from models.messages.motion import JointState, Motion
from models.messages.observation import Observation
from tests.mutations.samples import control, healths, motion, observation

T_NS = 10**12


def raw(message: codec.Message, **changes: object) -> bytes:
    """A message with other values, unchecked."""
    body = msgspec.msgpack.decode(codec.encode(message)[2:])
    return codec.encode(message)[:2] + msgspec.msgpack.encode(body | changes)


@pytest.mark.parametrize("field", ["t_ns", "t_newest_ns", "t_published_ns", "sequence", "epoch"])
@pytest.mark.parametrize("value", [-1, 2**63, 2**64 - 1])
def test_a_motion_of_an_impossible_time_which_the_page_could_not_pack_is_refused(field: str, value: int) -> None:
    with pytest.raises(codec.CodecError, match=field):
        codec.decode(raw(motion(T_NS), **{field: value}), Motion)


@pytest.mark.parametrize("field", ["t_mid_ns", "epoch", "frame", "sequence"])
def test_an_observation_of_an_impossible_time_is_refused(field: str) -> None:
    with pytest.raises(codec.CodecError, match=field):
        codec.decode(raw(observation(0, T_NS), **{field: 2**63}), Observation)


def test_a_plan_of_an_impossible_time_is_refused() -> None:
    for field in ("t_ns", "offset_ns"):
        with pytest.raises(codec.CodecError, match=field):
            codec.decode(raw(control(T_NS), **{field: 2**63}), type(control(T_NS)))


def test_a_joint_of_a_state_that_there_is_not_is_refused() -> None:
    states = np.full(17, JointState.SEEN, np.uint8)
    states[3] = 3
    with pytest.raises(ValueError, match="states"):
        msgspec.structs.replace(motion(T_NS), states=states)


def test_nobody_speaks_in_anothers_name() -> None:
    said = codec.encode(healths(T_NS)["fusion"])
    assert read_health(topics.health("fusion"), said).process == "fusion"
    with pytest.raises(codec.CodecError, match="process 'fusion'"):
        read_health(topics.health("tablet"), said)
    seen = codec.encode(observation(1, T_NS))
    with pytest.raises(codec.CodecError, match="camera 'cam1'"):
        read_observation(topics.observation("cam0"), seen)


def test_a_cameras_process_speaks_of_its_own_camera() -> None:
    health = healths(T_NS)["edge-cam0"]
    assert health.camera is not None
    other = msgspec.structs.replace(health, camera=msgspec.structs.replace(health.camera, camera="cam3"))
    with pytest.raises(codec.CodecError, match="camera 'cam3'"):
        read_health(topics.health("edge-cam0"), codec.encode(other))
