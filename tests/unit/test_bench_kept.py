"""What took minutes to make is kept whole or not at all, and a disk that is full is said in one line."""

import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from models.errors import UserError
from tests.bench.kept import keep, keep_arrays


@contextmanager
def files_of_at_most(count: int) -> Iterator[None]:
    """No file of this process may have more bytes: the kernel refuses to write them, as it does on a full disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (count, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_arrays_come_back_as_they_were(tmp_path: Path) -> None:
    arrays = {"cam01.points": np.array(((1.5, np.nan),)), "cam01.scores": np.zeros((0, 17))}
    keep_arrays(tmp_path / "keypoints/looks.npz", arrays)
    with np.load(tmp_path / "keypoints/looks.npz") as kept:
        assert set(kept) == set(arrays)
        for name, array in arrays.items():
            np.testing.assert_array_equal(kept[name], array)


def test_a_write_that_breaks_off_leaves_what_was_there_and_no_part_of_the_new(tmp_path: Path) -> None:
    keep(tmp_path / "a.msgpack", b"before")
    with files_of_at_most(10_000), pytest.raises(UserError, match=r"a\.msgpack cannot be written .*; make room") as raised:
        keep(tmp_path / "a.msgpack", bytes(50_000))
    assert "\n" not in str(raised.value)
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [("a.msgpack", b"before")]


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "keypoints").write_text("a file")
    with pytest.raises(UserError, match=r"keypoints/a\.msgpack cannot be written"):
        keep(tmp_path / "keypoints/a.msgpack", b"")
