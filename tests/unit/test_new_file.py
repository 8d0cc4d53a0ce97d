"""Files that are there as a whole or not at all."""

import errno
import os
from pathlib import Path

import pytest

from services.support.new_file import write_new


def test_a_file_is_written_with_its_content_and_nothing_beside_it(tmp_path: Path) -> None:
    write_new(tmp_path / "a.trc", b"whole")
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == {"a.trc": b"whole"}


def test_a_file_of_that_name_stays_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "a.trc").write_bytes(b"mine")
    with pytest.raises(FileExistsError):
        write_new(tmp_path / "a.trc", b"other")
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == {"a.trc": b"mine"}


@pytest.mark.parametrize("error", [OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt()])
def test_whatever_goes_wrong_before_it_is_safe_nothing_is_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: BaseException
) -> None:
    def fails(_descriptor: int) -> None:
        assert [path.name for path in tmp_path.iterdir()] == [".a.trc.part"], "the file has its name already"
        raise error

    monkeypatch.setattr(os, "fsync", fails)
    with pytest.raises(type(error)):
        write_new(tmp_path / "a.trc", b"half")
    assert list(tmp_path.iterdir()) == []
