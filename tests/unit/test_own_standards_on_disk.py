"""A school's own standards on a disk that is full, read-only or slow, beside others at work, and when the power goes."""

import errno
import fcntl
import multiprocessing
import os
import resource
import signal
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from models.errors import UserError
from services.support import own_standards
from services.support.own_standards import OwnStandards
from tests.integration.waiting import DEADLINE_S
from tests.unit.test_own_standards import holds, named, origins

pytestmark = pytest.mark.slow


class Fails:
    """What changes the disk works, but for the call of this number."""

    def __init__(self, at: int, error: OSError) -> None:
        self._at, self._error, self.calls = at, error, 0

    def stand_in_for(self, name: str, patched: pytest.MonkeyPatch) -> None:
        if name == "fsync":
            patched.setattr(os, "fsync", self._counted(os.fsync))
        elif name == "write":
            opened = Path.open

            def open_counted(path: Path, mode: str = "r", *given: Any) -> Any:
                return self._counted(opened)(path, mode, *given) if "w" in mode else opened(path, mode, *given)

            patched.setattr(Path, "open", open_counted)
        else:
            patched.setattr(Path, name, self._counted(getattr(Path, name)))

    def _counted(self, function: Callable[..., Any]) -> Callable[..., Any]:
        def call(*given: Any, **named: Any) -> Any:
            self.calls += 1
            if self.calls == self._at:
                raise self._error
            return function(*given, **named)

        return call


def changes(own: OwnStandards) -> tuple[Callable[[], object], ...]:
    """Everything that changes something."""
    return (lambda: own.put(named("new"))), (lambda: own.bring_back("squat", 2)), (lambda: own.bring_back_shipped("squat"))


@pytest.mark.parametrize("change", range(3))
@pytest.mark.parametrize(
    ("error", "remedy"),
    [
        (OSError(errno.ENOSPC, "No space left on device"), "No space left on device; make room there"),
        (OSError(errno.EROFS, "Read-only file system"), "Read-only file system; correct its permissions"),
    ],
)
@pytest.mark.parametrize("name", ["fsync", "write", "replace", "mkdir"])
def test_a_full_or_read_only_disk_leaves_all_as_it_was_at_whatever_step(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, error: OSError, remedy: str, change: int
) -> None:
    for at in range(1, 9):
        own = OwnStandards(tmp_path / f"{at}")
        for origin in ("a", "b"):
            own.put(named(origin))
        before = holds(own.folder)
        failing = Fails(at, error)
        told = ""
        with monkeypatch.context() as patched:
            failing.stand_in_for(name, patched)
            try:
                changes(own)[change]()
            except UserError as raised:
                told = str(raised)
        after = holds(own.folder)
        assert origins(own) >= {"a", "b"}, "a version was lost"
        assert not [file for file in after if file.endswith(".part")]
        if failing.calls < at:
            assert not told
            return
        assert remedy in told
        assert "\n" not in told
        if after != before:
            # Only the sync of the folder failed, when all was in its place.
            assert name == "fsync"
            assert origins(own) == {"a", "b"} | ({"new"} if change == 0 else set())
    raise AssertionError("there is no end to its steps")


def test_a_first_standard_that_cannot_be_written_leaves_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_descriptor: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(UserError, match="make room there"):
        OwnStandards(tmp_path / "school").put(named("a"))
    assert list(tmp_path.iterdir()) == []


def test_a_disk_that_is_full_in_truth_leaves_all_as_it_was(tmp_path: Path) -> None:
    own = OwnStandards(tmp_path)
    own.put(named("a"))
    own.put(named("b"))
    before = holds(tmp_path)
    signal_before = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
    try:
        with pytest.raises(UserError, match="cannot be written"):
            own.put(named("c"))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        signal.signal(signal.SIGXFSZ, signal_before)
    assert holds(tmp_path) == before


def _put(own: Path, origin: str) -> None:
    OwnStandards(own).put(named(origin))


def test_two_at_the_same_time_lose_nothing(tmp_path: Path) -> None:
    makers = [multiprocessing.get_context("spawn").Process(target=_put, args=(tmp_path, f"{number}")) for number in range(4)]
    for maker in makers:
        maker.start()
    for maker in makers:
        maker.join()
    assert [maker.exitcode for maker in makers] == [0] * 4
    own = OwnStandards(tmp_path)
    assert origins(own) == {"0", "1", "2", "3"}
    assert own.counts("squat").version == 5


def test_killed_at_whatever_step_every_version_is_there_as_a_whole(tmp_path: Path) -> None:
    for at in range(1, 7):
        own = OwnStandards(tmp_path / f"{at}")
        for origin in ("a", "b"):
            own.put(named(origin))
        process = multiprocessing.get_context("fork").Process(target=_killed_at, args=(tmp_path / f"{at}", at))
        process.start()
        process.join()
        assert origins(own) >= {"a", "b"}
        assert own.counts("squat").origin in {"b", "new"}
        own.put(named("after"))
        assert origins(own) >= {"a", "b", "after"}


def _killed_at(own: Path, at: int) -> None:
    """Dies at the system call of this number that changes the disk."""
    calls = 0

    def counted(function: Callable[..., object]) -> Callable[..., object]:
        def call(*given: object, **named: object) -> object:
            nonlocal calls
            calls += 1
            if calls == at:
                os.kill(os.getpid(), 9)
            return function(*given, **named)

        return call

    os.fsync = counted(os.fsync)  # type: ignore[assignment]
    Path.replace = counted(Path.replace)  # type: ignore[assignment, method-assign]
    OwnStandards(own).put(named("new"))


def test_another_one_that_hangs_in_the_folder_is_waited_for_a_while_and_then_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(own_standards, "PATIENCE_S", 0.1)
    own = OwnStandards(tmp_path)
    own.put(named("a"))
    before = holds(tmp_path)
    other = os.open(own.folder, os.O_RDONLY)
    fcntl.flock(other, fcntl.LOCK_EX)
    try:
        for change in changes(own):
            with pytest.raises(UserError, match=r"another .kinebox standard. has been at work in .*standards .*; end it, and"):
                change()
        assert holds(tmp_path) == before
    finally:
        os.close(other)
    assert own.put(named("b")).standard.version == 3


def test_another_one_that_is_at_work_for_a_moment_is_waited_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(own_standards, "PATIENCE_S", DEADLINE_S)
    own = OwnStandards(tmp_path)
    own.put(named("a"))
    other = os.open(own.folder, os.O_RDONLY)
    fcntl.flock(other, fcntl.LOCK_EX)
    timer = threading.Timer(0.1, os.close, [other])
    timer.start()
    try:
        assert own.put(named("b")).standard.version == 3
    finally:
        timer.join()
