"""When the test runner itself is killed, nothing of what it started is left for long."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import psutil
import pytest

from tests.faults.disk import may_mount, mounted, small_disk, unmount_left_over
from tests.installed import ROOT
from tests.integration.waiting import until

pytestmark = pytest.mark.slow

BOX = """
import sys, time
from pathlib import Path
from tests.integration.box import NAMES, Box
box = Box(Path(sys.argv[1]))
box.wait_started()
print(box.process.pid, *(pid for name in NAMES for pid in box.pids(name)), flush=True)
time.sleep(1000)
"""
DISK = """
import sys, time
from pathlib import Path
from tests.faults.disk import small_disk
with small_disk(Path(sys.argv[1])):
    print("mounted", flush=True)
    time.sleep(1000)
"""


@contextmanager
def runner(program: str, folder: Path) -> Iterator[tuple["subprocess.Popen[str]", str]]:
    """A process that has started something, and what it said of it."""
    command = [sys.executable, "-c", program, str(folder)]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            yield process, process.stdout.readline().strip()
        finally:
            process.kill()


def test_a_box_ends_when_the_runner_of_its_test_is_killed(tmp_path: Path) -> None:
    with runner(BOX, tmp_path) as (process, said):
        everyone = [psutil.Process(int(word)) for word in said.split()]
        assert len(everyone) > 5
        os.kill(process.pid, signal.SIGKILL)
        until(lambda: not any(map(_runs, everyone)), "the end of the box")


def _runs(process: psutil.Process) -> bool:
    try:
        return process.is_running() and process.status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False


def test_a_small_disk_that_is_left_over_is_unmounted_at_the_next_start_and_no_other(tmp_path: Path) -> None:
    if not may_mount(tmp_path):
        pytest.skip("file systems cannot be mounted here")
    left, own = tmp_path / "left over", tmp_path / "own"
    with runner(DISK, left) as (process, said), small_disk(own):
        assert said == "mounted"
        unmount_left_over()
        assert {left, own} <= _folders(), "both belong to processes that run"
        process.kill()
        process.wait()
        assert left in _folders(), "or there would be nothing to clear"
        with small_disk(tmp_path / "next"):
            assert left not in _folders()
            assert own in _folders()


def _folders() -> set[Path]:
    return {folder for _, folder in mounted()}
