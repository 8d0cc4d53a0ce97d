"""A console that nobody reads: nothing waits for it, not even the end."""

import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TextIO

import pytest

from services.supervisor.journal import Journal
from tests.installed import ROOT
from tests.integration.waiting import until

LINES = 5000
"""More than a pipe and all that waits for it can hold."""


@pytest.fixture
def pipe() -> Iterator[tuple[int, TextIO]]:
    """A pipe: the descriptor to read from, and the console that writes into it."""
    reader, writer = os.pipe()
    os.set_blocking(reader, False)
    with os.fdopen(writer, "w") as console:
        yield reader, console
        os.close(reader)  # Whoever still writes is let go,
        time.sleep(0.2)  # and has given it up before its descriptor becomes another file's.


def read(reader: int) -> str:
    parts: list[bytes] = []
    while True:
        try:
            parts.append(os.read(reader, 65536))
        except BlockingIOError:
            return b"".join(parts).decode()


def within_seconds(what: Callable[[], None]) -> None:
    """Call it on a thread, so that one that waits for ever fails this test only."""
    thread = threading.Thread(target=what, daemon=True)
    thread.start()
    thread.join(30.0)
    assert not thread.is_alive(), "it waits for somebody to read"


def test_a_pipe_that_nobody_reads_holds_up_neither_a_word_nor_the_end_and_the_log_has_everything(
    tmp_path: Path, pipe: tuple[int, TextIO]
) -> None:
    journal = Journal(tmp_path, pipe[1])

    def talk_and_end() -> None:
        for number in range(LINES):
            journal.say(f"line {number} {'x' * 100}")
            journal.settle()
        journal.close()

    within_seconds(talk_and_end)
    assert len(journal.path.read_text().splitlines()) == LINES


def test_whoever_reads_again_sees_whole_lines_and_how_many_he_missed(tmp_path: Path, pipe: tuple[int, TextIO]) -> None:
    reader, console = pipe
    journal = Journal(tmp_path, console)

    def talk() -> None:
        for number in range(LINES):
            journal.say(f"line {number} {'x' * 100}")

    within_seconds(talk)
    seen = ""

    def told() -> bool:
        nonlocal seen
        seen += read(reader)
        journal.settle()
        return "nobody read" in seen and seen.endswith("\n")

    until(told, "how many lines are missing")
    lines = [line.split("  ", 2)[2].strip() for line in seen.splitlines()]
    said = [f"line {number} {'x' * 100}" for number in range(LINES)]
    shown = [line for line in lines if line.startswith("line")]
    left = iter(said)
    assert all(line in left for line in shown), "each is whole, and in its place"
    assert lines[len(shown) :] == [
        f"nobody read what is shown here: {LINES - len(shown)} lines were left out; 'kinebox logs' has them"
    ]
    journal.close()


def test_a_supervisor_whose_console_is_blocked_ends_as_it_should() -> None:
    program = """
import sys
from services.supervisor.console import Console
console = Console(sys.stderr)
for _ in range(5000):
    console.show("x" * 99 + "\\n")
console.close()
"""
    reader, writer = os.pipe()
    try:
        process = subprocess.Popen([sys.executable, "-c", program], cwd=ROOT, stderr=writer)
        os.close(writer)
        assert process.wait(60.0) == 0
    finally:
        os.close(reader)
