"""Wire format: a two-byte header (format version, message type), then MessagePack; arrays travel as raw bytes.

An array is a MessagePack extension of code 1: dtype (one byte of `_DTYPES`), number of dimensions (one byte), each dimension
(uint32), then the little-endian elements in C order. Float lists would cost a hundred times as much.
"""

import struct
from typing import Any, TypeVar

import msgspec
import numpy as np

from models.messages.attempts import AttemptsBegin, FeedbackRequest, RememberedFeedback
from models.messages.control import ViewControl
from models.messages.feedback import ActivityRequest, Feedback
from models.messages.health import Health
from models.messages.lesson import FusionLog, LessonRequest, SegmentRequest
from models.messages.motion import Motion
from models.messages.observation import Observation
from models.messages.pupil import PupilCorrections, PupilTurn

VERSION = 2
Message = (
    Observation
    | Motion
    | ViewControl
    | Health
    | FusionLog
    | SegmentRequest
    | LessonRequest
    | Feedback
    | ActivityRequest
    | PupilTurn
    | PupilCorrections
    | AttemptsBegin
    | FeedbackRequest
    | RememberedFeedback
)
MessageT = TypeVar("MessageT", bound=Message)

_TYPES: dict[int, type] = {
    1: Observation,
    2: Motion,
    3: ViewControl,
    4: Health,
    5: FusionLog,
    6: SegmentRequest,
    7: LessonRequest,
    8: Feedback,
    9: ActivityRequest,
    10: PupilTurn,
    11: PupilCorrections,
    12: AttemptsBegin,
    13: FeedbackRequest,
    14: RememberedFeedback,
}
_CODES = {kind: code for code, kind in _TYPES.items()}
_ARRAY = 1
_DTYPES: dict[int, np.dtype[Any]] = {0: np.dtype("<f4"), 1: np.dtype("<f8"), 2: np.dtype("u1"), 3: np.dtype("<u4")}
_DTYPE_CODES = {dtype: code for code, dtype in _DTYPES.items()}
_MAX_DIMENSIONS = 4


class CodecError(ValueError):
    """Bytes that are not a message of this version, with the reason."""


def encode(message: Message) -> bytes:
    """A message as bytes for the bus."""
    return bytes((VERSION, _CODES[type(message)])) + _ENCODER.encode(message)


def decode(data: bytes, kind: type[MessageT]) -> MessageT:
    """Read a message of the type expected on a topic.

    Raises:
        CodecError: truncated, corrupt, nested too deeply, of another type or of another version.
    """
    if len(data) < 2:
        raise CodecError(f"{len(data)} bytes are no message")
    if data[0] != VERSION:
        raise CodecError(f"wire format version {data[0]}; this KineBox speaks {VERSION}")
    if data[1] != _CODES[kind]:
        found = _TYPES.get(data[1])
        raise CodecError(f"a {found.__name__ if found else f'message of unknown type {data[1]}'} where {kind.__name__} belongs")
    try:
        message: MessageT = _DECODERS[kind].decode(memoryview(data)[2:])
    except (msgspec.MsgspecError, ValueError, OverflowError, RecursionError, struct.error) as error:
        raise CodecError(f"corrupt {kind.__name__}: {error}") from error
    return message


def _encode_array(value: Any) -> msgspec.msgpack.Ext:
    if not isinstance(value, np.ndarray):
        raise NotImplementedError(f"{type(value).__name__} has no place in a message")
    array = np.ascontiguousarray(value, dtype=value.dtype.newbyteorder("<"))
    header = struct.pack(f"<BB{array.ndim}I", _DTYPE_CODES[array.dtype], array.ndim, *array.shape)
    return msgspec.msgpack.Ext(_ARRAY, header + array.tobytes())


def _decode_extension(code: int, data: memoryview) -> Any:
    if code != _ARRAY:
        raise ValueError(f"unknown extension {code}")
    dtype_code, dimensions = struct.unpack_from("<BB", data)
    if dtype_code not in _DTYPES or dimensions > _MAX_DIMENSIONS:
        raise ValueError(f"no array has dtype {dtype_code} and {dimensions} dimensions")
    shape = struct.unpack_from(f"<{dimensions}I", data, 2)
    # A copy, so that the array owns its memory and may be written to; frombuffer alone would pin the whole message.
    return np.frombuffer(data, _DTYPES[dtype_code], offset=2 + 4 * dimensions).reshape(shape).copy()


def _decode_annotation(_kind: type, value: Any) -> Any:
    # Array annotations are generic aliases of numpy.ndarray, which msgspec hands to us to check.
    if isinstance(value, np.ndarray):
        return value
    raise ValueError(f"an array was expected, not {type(value).__name__}")


_ENCODER = msgspec.msgpack.Encoder(enc_hook=_encode_array)
_DECODERS: dict[type, msgspec.msgpack.Decoder[Any]] = {
    kind: msgspec.msgpack.Decoder(kind, dec_hook=_decode_annotation, ext_hook=_decode_extension) for kind in _TYPES.values()
}
