"""Messages gone wrong: bytes flipped, cut and joined, and, one level up, values that no healthy process would send.

Seeded, so that a message which breaks something can be made again: the same seed gives the same sequence.
"""

import copy
import math
import random
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import msgspec

_NESTED = 20_000
"""Deeper than anything that is meant, and by far than Python's own stack, with one call a level, on any machine."""


def hostile_values() -> list[Any]:
    """What may stand anywhere in a message that was made to harm, or by a program gone mad."""
    return [
        None, True, False, 0, -1, 1, 2**31, 2**32, 2**53, 2**63 - 1, -(2**63), 2**64 - 1, 1e308, -1e308, 5e-324, -0.0,
        math.nan, math.inf, -math.inf, "", "x" * 5000, "\x00", "../../etc/passwd", "cam01", "edge-cam9", "\U0001f984" * 50,
        b"", b"\xff" * 300, [], [[]], {}, {"": 0}, [0] * 3000, {"camera": "cam0"},
    ]  # fmt: skip


def hostile_bytes() -> list[bytes]:
    """Beginnings that promise more than there is, as MessagePack writes lengths."""
    return [
        b"\xdd\xff\xff\xff\xff",  # an array of 2^32 - 1 items
        b"\xdf\xff\xff\xff\xff",  # a map
        b"\xdb\xff\xff\xff\xff",  # a text
        b"\xc6\xff\xff\xff\xff",  # bytes
        b"\xc9\xff\xff\xff\xff\x01",  # an extension
        b"\xc7\xff\x01" + b"\x00\x04" + b"\xff\xff\xff\x7f" * 4,  # an array extension of an impossible shape
        b"\x91" * _NESTED,
        b"\x81\xa0" * _NESTED,
        b"\xc1",  # never used
    ]


def mutants(samples: Sequence[bytes], seed: int, count: int) -> Iterator[bytes]:
    """So many mutations of valid messages, all kinds in turn. The samples may be changed between two of them."""
    kinds = (_flip, _cut, _splice, _repeat, _inject, _edit, _edit, _edit, _exchange, _damage_array, _damage_array)
    return _mutants(kinds, samples, seed, count)


def raw_mutants(samples: Sequence[bytes], seed: int, count: int) -> Iterator[bytes]:
    """The same of bytes that are no message of the codec's."""
    return _mutants((_flip, _cut, _splice, _repeat, _noise), samples, seed, count)


_Kind = Callable[[Sequence[bytes], random.Random], bytes]


def _mutants(kinds: Sequence[_Kind], samples: Sequence[bytes], seed: int, count: int) -> Iterator[bytes]:
    chance = random.Random(seed)  # noqa: S311 - no secret
    for number in range(count):
        yield kinds[number % len(kinds)](samples, chance)


def _noise(_samples: Sequence[bytes], chance: random.Random) -> bytes:
    texts = [str(value).encode() for value in hostile_values() if isinstance(value, (int, float, str))]
    return chance.choice([*texts, *hostile_bytes(), "٤٢".encode(), chance.randbytes(chance.randrange(300))])


def _flip(samples: Sequence[bytes], chance: random.Random) -> bytes:
    data = bytearray(chance.choice(samples))
    for _ in range(chance.choice((1, 1, 2, 8, 64))):
        data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
    return bytes(data)


def _cut(samples: Sequence[bytes], chance: random.Random) -> bytes:
    data = chance.choice(samples)
    return data[: chance.randrange(len(data))]


def _splice(samples: Sequence[bytes], chance: random.Random) -> bytes:
    first, second = chance.choice(samples), chance.choice(samples)
    return first[: chance.randrange(len(first))] + second[chance.randrange(len(second)) :]


def _repeat(samples: Sequence[bytes], chance: random.Random) -> bytes:
    data = chance.choice(samples)
    at, length = chance.randrange(len(data)), chance.randrange(1, 40)
    return data[: at + length] + data[at : at + length] * chance.choice((1, 2, 50)) + data[at + length :]


def _inject(samples: Sequence[bytes], chance: random.Random) -> bytes:
    data = chance.choice(samples)
    at = chance.randrange(2, len(data) + 1)
    piece = chance.choice([*hostile_bytes(), chance.randbytes(chance.randrange(1, 20))])
    return data[:at] + piece + data[at + chance.choice((0, len(piece))) :]


def _edit(samples: Sequence[bytes], chance: random.Random) -> bytes:
    """Some values replaced by hostile ones; a number sometimes by one near a border of its own."""

    def replace(value: Any) -> Any:
        if isinstance(value, (int, float)) and not isinstance(value, bool) and chance.random() < 0.5:
            return chance.choice((-value, value * 1000, value + 1, value - 2**62, value * 0.5, value + 2**62))
        return chance.choice(hostile_values())

    return _rewritten(chance.choice(samples), chance, replace, chance.choice((1, 1, 1, 2, 5)))


def _exchange(samples: Sequence[bytes], chance: random.Random) -> bytes:
    """One value in the place of another, from the same message or another one."""
    donors = [value for _, value in _places(_body(chance.choice(samples)))]
    return _rewritten(chance.choice(samples), chance, lambda _: copy.deepcopy(chance.choice(donors)), chance.choice((1, 2)))


def _damage_array(samples: Sequence[bytes], chance: random.Random) -> bytes:
    """An array of another type, shape or content."""

    def damage(value: Any) -> Any:
        if not isinstance(value, msgspec.msgpack.Ext):
            return chance.choice(hostile_values())
        data = bytearray(value.data)
        match chance.randrange(4):
            case 0:
                data[chance.randrange(min(len(data), 14))] = chance.randrange(256)
            case 1:
                at = chance.randrange(2, len(data)) & ~3
                data[at : at + 4] = chance.choice((b"\x00\x00\xc0\x7f", b"\x00\x00\x80\x7f", b"\xff\xff\x7f\xff", b"\xff" * 4))
            case 2:
                del data[chance.randrange(len(data)) :]
            case _:
                return msgspec.msgpack.Ext(chance.choice((-128, -1, 0, 2, 127)), bytes(data))
        return msgspec.msgpack.Ext(value.code, bytes(data))

    sample = chance.choice(samples)
    arrays = [place for place, value in _places(_body(sample)) if isinstance(value, msgspec.msgpack.Ext)]
    return _rewritten(sample, chance, damage, 1, arrays)


Place = tuple[Any, ...]
"""Keys and indices from the root of a message to a value in it."""


def _body(message: bytes) -> Any:
    return msgspec.msgpack.decode(message[2:])


def _places(value: Any, at: Place = ()) -> Iterator[tuple[Place, Any]]:
    """Every value of a tree but the root."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in items:
        yield (*at, key), item
        yield from _places(item, (*at, key))


def _rewritten(
    message: bytes, chance: random.Random, replace: Callable[[Any], Any], times: int, places: list[Place] | None = None
) -> bytes:
    body = _body(message)
    for _ in range(times):
        choices = places or [place for place, _ in _places(body)]
        if not choices:
            break
        *way, last = chance.choice(choices)
        holder = body
        try:
            for key in way:
                holder = holder[key]
            if chance.random() < 0.1 and isinstance(holder, dict):
                del holder[last]
            else:
                holder[last] = replace(holder[last])
        except (KeyError, IndexError, TypeError):
            continue  # An earlier change has taken the place away.
    try:
        return message[:2] + msgspec.msgpack.encode(body)
    except (OverflowError, msgspec.MsgspecError):
        return message[:-1]  # A number that MessagePack cannot carry.
