"""A box that runs as it is shipped, and what its processes use."""

import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

import psutil

from services.supervisor.child import name_of
from tests.installed import ROOT
from tests.lifeline import bound


class CpuUsed(NamedTuple):
    """What was used over a time: CPU seconds a second."""

    seconds: float
    cores: float


class CpuMeter:
    """Measures, from when it is made on, the CPU that some processes use; those that come meanwhile count whole.

    Args:
        whose: the processes, asked at the beginning and at every reading.
    """

    def __init__(self, whose: Callable[[], Iterable[psutil.Process]]) -> None:
        self._whose = whose
        self._began_s, self._cpu_s = time.monotonic(), _cpu_s(whose())

    def read(self) -> CpuUsed:
        """What was used since the beginning."""
        seconds = time.monotonic() - self._began_s
        return CpuUsed(seconds, (_cpu_s(self._whose()) - self._cpu_s) / seconds)


def _cpu_s(processes: Iterable[psutil.Process]) -> float:
    times = [process.cpu_times() for process in processes]
    return float(sum(each.user + each.system for each in times))


def rss_mb(process: psutil.Process) -> float:
    """Its resident memory."""
    return float(process.memory_info().rss / 2**20)


def processes(box: psutil.Process) -> dict[str, psutil.Process]:
    """The box's processes by their name on the bus."""
    found = {"supervisor": box}
    for child in sorted(box.children(recursive=True), key=psutil.Process.create_time):
        with contextlib.suppress(psutil.Error):
            name = name_of(child.cmdline())
            if name is not None:
                found[name if name not in found else f"{name}-spare"] = child
    return found


@contextlib.contextmanager
def running_box(site: Path, data: Path, cpus: set[int] | None) -> Iterator[psutil.Process]:
    """`kinebox run` in a process group of its own, ended by SIGTERM."""
    log = data / "bench" / "box.log"
    log.parent.mkdir(parents=True, exist_ok=True)
    with log.open("wb") as output:
        command = [sys.executable, "-m", "services.cli.main", "run", "--site", str(site.resolve()), "--data", str(data.resolve())]
        if cpus is not None:
            command = ["taskset", "-c", ",".join(map(str, sorted(cpus))), *command]
        popen = subprocess.Popen(bound(command), cwd=ROOT, stdout=output, stderr=output, start_new_session=True)
        try:
            yield psutil.Process(popen.pid)
        finally:
            popen.terminate()
            try:
                popen.wait(15)
            except subprocess.TimeoutExpired:
                os.killpg(popen.pid, signal.SIGKILL)
                raise
