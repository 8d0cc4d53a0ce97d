"""No bytes may crash a reader: they are a message or a CodecError."""

from hypothesis import given
from hypothesis import strategies as st

from models.messages import codec
from models.messages.control import ViewControl
from models.messages.health import Health
from models.messages.motion import Motion
from models.messages.observation import Observation
from tests.unit.test_codec import examples

KINDS = (Observation, Motion, ViewControl, Health)


@given(st.sampled_from(KINDS), st.binary(max_size=200))
def test_random_bytes_are_refused(kind: type, data: bytes) -> None:
    try:
        codec.decode(data, kind)
    except codec.CodecError:
        return
    raise AssertionError("random bytes were taken for a message")


@given(st.sampled_from(sorted(examples())), st.data())
def test_a_mutated_message_is_read_or_refused_but_never_crashes_the_reader(name: str, data: st.DataObject) -> None:
    message = examples()[name]
    payload = bytearray(codec.encode(message))
    for _ in range(data.draw(st.integers(1, 4))):
        payload[data.draw(st.integers(0, len(payload) - 1))] = data.draw(st.integers(0, 255))
    try:
        decoded = codec.decode(bytes(payload), type(message))
    except codec.CodecError:
        return
    assert isinstance(decoded, type(message))
    codec.encode(decoded)
