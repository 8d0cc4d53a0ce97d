"""The boxes in the table of processes: whoever looks for one must find its supervisor, however it was called."""

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from services.doctor.processes import RunningBox, gather_boxes
from tests.integration.waiting import until


@contextmanager
def called(folder: Path, *words: str) -> Iterator[subprocess.Popen[bytes]]:
    """A process that has the command line of a supervisor, in `folder`, and does nothing."""
    process = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)", "services.cli.main", *words], cwd=folder)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def box_of(site: Path) -> RunningBox | None:
    return next((box for box in gather_boxes() if box.site == site), None)


@pytest.mark.parametrize("words", [("--site", "x.toml"), ("--site=x.toml",), ("--data=build", "--site=./x.toml")])
def test_a_supervisor_is_found_in_both_forms_of_its_option_also_when_it_is_stopped(tmp_path: Path, words: tuple[str, ...]) -> None:
    site = (tmp_path / "x.toml").resolve()
    with called(tmp_path, "run", *words) as process:
        until(lambda: box_of(site) is not None, "a box with that site file")
        process.send_signal(signal.SIGSTOP)

        def stopped() -> bool:
            box = box_of(site)
            return box is not None and box.supervisor is not None and box.supervisor.stopped

        until(stopped, "its supervisor to be known as stopped")
        box = box_of(site)
        assert box is not None
        assert box.supervisor is not None
        assert box.supervisor.pid == process.pid


@pytest.mark.parametrize("words", [("check", "--site=x.toml"), ("run",), ("run", "--site"), ("run", "--sites=x.toml")])
def test_what_runs_no_box_is_taken_for_none(tmp_path: Path, words: tuple[str, ...]) -> None:
    with called(tmp_path, *words) as process, called(tmp_path, "run", "--site", "y.toml"):
        until(lambda: box_of((tmp_path / "y.toml").resolve()) is not None, "the box beside it")
        assert not any(box.owns(process.pid) for box in gather_boxes())
