"""No bytes may crash a reader: they are a message or a CodecError."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.messages import codec
from tests.unit.test_codec import examples


@given(st.sampled_from(sorted(examples())), st.binary(max_size=200))
def test_random_bytes_are_refused(name: str, data: bytes) -> None:
    with pytest.raises(codec.CodecError):
        codec.decode(b"\xff" + data, type(examples()[name]))


@given(st.sampled_from(sorted(examples())), st.binary(max_size=200))
def test_random_bytes_behind_a_true_header_are_a_message_or_refused(name: str, data: bytes) -> None:
    message = examples()[name]
    try:
        decoded = codec.decode(codec.encode(message)[:2] + data, type(message))
    except codec.CodecError:
        return
    assert isinstance(decoded, type(message))
    assert codec.decode(codec.encode(decoded), type(message)) is not None


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
