"""A disk that stalls: the box goes on, nothing is lost that fits, and what happens is said."""

import fcntl
import io
import os
import re
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import msgspec
import pytest

from services.logs import write_behind
from services.logs.files import log_path
from services.logs.write_behind import HELD_UP, ROOM
from services.supervisor.journal import Journal
from tests.integration.waiting import until

LINES = 200
"""More than the disk takes before it stalls."""


class StalledDisk:
    """A log's file that takes a few lines and then holds up whoever writes to it, until somebody reads: a pipe with a name."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._others = set(threading.enumerate())
        path = log_path(folder, 1)
        os.mkfifo(path)
        self._reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
        fcntl.fcntl(self._reader, fcntl.F_SETPIPE_SZ, 4096)
        self._taken = b""

    def goes_on(self) -> None:
        """Take what is there; to be called again and again, as `until` does."""
        try:
            self._taken += os.read(self._reader, 65536)
        except BlockingIOError:
            return

    def events(self) -> list[str]:
        return [msgspec.json.decode(line)["event"] for line in self._taken.splitlines()]

    def has(self, event: str) -> bool:
        self.goes_on()
        return self._taken.endswith(b"\n") and event in self.events()

    def lost(self) -> list[int]:
        return [entry["lines"] for line in self._taken.splitlines() if "lines" in (entry := msgspec.json.decode(line))]

    def close(self) -> None:
        def is_left() -> bool:
            self.goes_on()
            return not any(thread.name == "log" for thread in set(threading.enumerate()) - self._others)

        until(is_left, "whoever still writes to be done")
        os.close(self._reader)


@pytest.fixture
def disk(tmp_path: Path) -> Iterator[StalledDisk]:
    made = StalledDisk(tmp_path)
    yield made
    made.close()


def within_seconds(what: Callable[[], None]) -> None:
    """Call it on a thread, so that one that waits for ever fails this test only."""
    thread = threading.Thread(target=what, daemon=True)
    thread.start()
    thread.join(30.0)
    assert not thread.is_alive(), "it waits for the disk"


def say(journal: Journal, count: int) -> list[str]:
    """Have that many lines said; what they are."""
    events = [f"line {number}" for number in range(count)]

    def talk() -> None:
        for event in events:
            journal.note(event)
            journal.settle()

    within_seconds(talk)
    return events


def ended(journal: Journal, disk: StalledDisk) -> None:
    """End the log, with a disk that goes on meanwhile."""
    end = threading.Thread(target=journal.close, daemon=True)
    end.start()

    def is_done() -> bool:
        disk.goes_on()
        return not end.is_alive()

    until(is_done, "the end of the log")
    disk.goes_on()


def test_a_disk_that_stalls_does_not_hold_up_the_supervisor_and_takes_every_line_later(disk: StalledDisk) -> None:
    journal = Journal(disk.folder, io.StringIO())
    said = say(journal, LINES)
    until(lambda: disk.has(said[-1]), "the last line in the log")
    journal.note("and on")
    ended(journal, disk)
    assert disk.events() == [*said, "and on"]


def test_what_waits_for_the_disk_is_written_at_the_end(disk: StalledDisk) -> None:
    journal = Journal(disk.folder, io.StringIO())
    said = say(journal, LINES)
    ended(journal, disk)
    assert disk.events() == said


def test_that_a_disk_stalls_is_said_without_another_line_and_that_it_goes_on_too(
    disk: StalledDisk, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(write_behind, "TOLD_AFTER_S", 0.0)
    console = io.StringIO()
    journal = Journal(disk.folder, console)
    said = say(journal, LINES)

    def told() -> bool:
        journal.settle()
        return journal.trouble is not None

    until(told, "the trouble")
    assert journal.trouble is not None
    assert (journal.trouble.code, journal.trouble.words) == ("log_not_kept", f"nothing is kept in {journal.path}: {HELD_UP}")
    assert "does not answer" in journal.trouble.remedy
    assert not re.search("room|rights", journal.trouble.remedy), "neither helps a disk that stalls"

    def over() -> bool:
        disk.goes_on()
        journal.settle()
        return journal.trouble is None

    until(over, "the end of the trouble")
    ended(journal, disk)
    assert disk.events() == said, "nothing was lost"
    assert "is kept in" in console.getvalue().splitlines()[-1]


def test_what_does_not_fit_any_more_is_counted_and_told_in_its_place(disk: StalledDisk) -> None:
    console = io.StringIO()
    journal = Journal(disk.folder, console)
    said = say(journal, LINES + ROOM)
    assert journal.trouble is not None, "it is told as soon as something is lost"
    until(lambda: disk.has("lines of the log could not be kept"), "the word about the loss")
    journal.note("and on")
    ended(journal, disk)
    *kept, told, after = disk.events()
    assert (told, after) == ("lines of the log could not be kept", "and on")
    assert kept == said[: len(kept)]
    assert disk.lost() == [len(said) - len(kept)]
    assert said[-1] in console.getvalue(), "people get what the log does not"


def test_a_loss_is_told_in_a_log_that_ends_then(disk: StalledDisk) -> None:
    journal = Journal(disk.folder, io.StringIO())
    said = say(journal, LINES + ROOM)
    ended(journal, disk)
    (lost,) = disk.lost()
    assert lost + len(disk.events()) - 1 == len(said)


def test_a_disk_that_never_goes_on_does_not_hold_up_the_end_which_says_what_was_given_up(
    disk: StalledDisk, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(write_behind, "END_WITHIN_S", 0.2)
    console = io.StringIO()
    journal = Journal(disk.folder, console)
    said = say(journal, LINES)
    within_seconds(journal.close)
    disk.goes_on()
    given_up = len(said) - len(disk.events())
    assert f"{given_up} lines of the log were given up" in console.getvalue()


def test_whoever_waits_at_the_end_for_a_disk_that_stalls_is_told_for_what_before_and_nobody_else_is(
    disk: StalledDisk, tmp_path_factory: pytest.TempPathFactory
) -> None:
    console = io.StringIO()
    journal = Journal(disk.folder, console)
    say(journal, LINES)
    end = threading.Thread(target=journal.close, daemon=True)
    end.start()
    told = f"waiting up to 10 s for the disk of {journal.path} to take the last lines of the log"
    until(lambda: told in console.getvalue(), "the word about the wait")
    assert end.is_alive()

    def is_done() -> bool:
        disk.goes_on()
        return not end.is_alive()

    until(is_done, "the end of the log")
    console = io.StringIO()
    journal = Journal(tmp_path_factory.mktemp("quick"), console)
    say(journal, LINES)
    journal.close()
    assert console.getvalue() == ""
