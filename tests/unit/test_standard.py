"""Standards as values and as files."""

import io
from typing import Any

import numpy as np
import pytest

from models.errors import UserError
from models.teaching.standard import UNIT_M, Exemplar, Standard, decode, encode


def _exemplar(frames: int, seed: int) -> Exemplar:
    joints = np.random.default_rng(seed).normal(size=(frames, 17, 3))
    return Exemplar(joints, (0.1, 0.4, 0.7, (frames - 2) / 30))


def _standard() -> Standard:
    performance = _exemplar(40, 1)
    performance.joints_m[3, 7] = np.nan
    spread = np.random.default_rng(2).uniform(0, 0.2, (40, 17))
    spread[5, 5] = np.nan
    return Standard("squat", 3, "recorded on a Tuesday", performance, spread, 1.43, (_exemplar(30, 3), _exemplar(50, 4)))


def _altered(**keys: Any) -> bytes:
    with np.load(io.BytesIO(encode(_standard()))) as file:
        arrays = {**file, **keys}
    data = io.BytesIO()
    np.savez(data, **{key: value for key, value in arrays.items() if value is not None})
    return data.getvalue()


def test_a_file_holds_the_standard_to_a_quarter_of_a_millimetre_and_twice_the_same() -> None:
    standard = _standard()
    data = encode(standard)
    assert encode(standard) == data
    read = decode(data, "squat.npz")
    assert (read.action, read.version, read.origin, read.stature_m) == ("squat", 3, "recorded on a Tuesday", 1.43)
    assert len(read.exemplars) == 2
    for ours, theirs in zip((standard.performance, *standard.exemplars), (read.performance, *read.exemplars), strict=True):
        np.testing.assert_allclose(theirs.joints_m, ours.joints_m, atol=UNIT_M / 2 + 1e-9)
        assert theirs.moments_s == ours.moments_s
    np.testing.assert_allclose(read.spread_m, standard.spread_m, atol=UNIT_M / 2 + 1e-9)
    assert encode(read) == data


@pytest.mark.parametrize("data", [b"", b"PK\x03\x04", b"no zip at all", b"\x93NUMPY\x01\x00"])
def test_what_is_no_file_of_ours_is_refused_by_its_name(data: bytes) -> None:
    with pytest.raises(UserError, match=r"^mine\.npz: is no standard's file, or is damaged"):
        decode(data, "mine.npz")


def test_a_file_that_breaks_off_is_refused() -> None:
    data = encode(_standard())
    for length in range(0, len(data), 997):
        with pytest.raises(UserError, match="mine"):
            decode(data[:length], "mine.npz")


def test_a_flipped_byte_is_refused_or_does_no_harm() -> None:
    data = encode(_standard())
    for place in range(0, len(data), 61):
        broken = bytearray(data)
        broken[place] ^= 0xFF
        try:
            read = decode(bytes(broken), "mine.npz")
        except UserError:
            continue
        assert encode(read) == data, f"byte {place} changed what was read"


@pytest.mark.parametrize(
    ("keys", "told"),
    [
        ({"format": np.array("kinebox-body")}, "is not a standard's file"),
        ({"format": None}, "is not a standard's file"),
        ({"layout": np.array(2)}, "layout is 2, this KineBox reads 1; update"),
        ({"layout": None}, "layout is None"),
        ({"spread": None}, "spread is missing"),
        ({"colour": np.array(1)}, "colour is unknown"),
        ({"joints": np.zeros((120, 17, 2), np.int16)}, "is damaged"),
        ({"joints": np.zeros((120, 17, 3))}, "is damaged"),
        ({"ends": np.array([40, 30, 120])}, "is damaged"),
        ({"ends": np.array(0)}, "is damaged"),
        ({"ends": np.zeros(0, np.int64)}, "is damaged"),
        ({"moments_s": np.full((3, 4), np.nan)}, "is damaged"),
        ({"moments_s": np.zeros((3, 4))}, "is damaged"),
        ({"version": np.array(0)}, "is damaged"),
        ({"version": np.array("1")}, "is damaged"),
        ({"version": np.array(2**64 - 1, np.uint64)}, "is damaged .*a version from 1 to 999999"),
        ({"version": np.array(10**6)}, "is damaged .*a version from 1 to 999999"),
        ({"stature_m": np.array(np.nan)}, "is damaged"),
        ({"action": np.array("")}, "is damaged"),
        ({"spread": np.zeros((3, 17), np.uint16)}, "is damaged"),
    ],
)
def test_a_file_with_a_wrong_key_is_refused_with_what_is_wrong(keys: dict[str, Any], told: str) -> None:
    with pytest.raises(UserError, match=rf"^mine\.npz: .*{told}"):
        decode(_altered(**keys), "mine.npz")


def test_what_is_no_performance_is_no_standard() -> None:
    joints = np.zeros((30, 17, 3))
    with pytest.raises(ValueError, match="follow one another"):
        Exemplar(joints, (0.1, 0.5, 0.4, 0.9))
    with pytest.raises(ValueError, match="follow one another"):
        Exemplar(joints, (0.1, 0.2, 0.4, 1.9))
    with pytest.raises(ValueError, match="shape"):
        Exemplar(joints[:1], (0.0, 0.1, 0.2, 0.3))
    with pytest.raises(ValueError, match="within"):
        Exemplar(joints + 100, (0.1, 0.2, 0.4, 0.9))
