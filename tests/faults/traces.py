"""What a box leaves behind: processes, ports, shared memory, temporary files. It must be nothing."""

import socket
import tempfile
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import psutil

from tests.faults.box import Box


@dataclass(frozen=True)
class Before:
    """What was there before the box."""

    shared: frozenset[str]
    temporary: frozenset[str]

    @classmethod
    def look(cls) -> "Before":
        """Look now."""
        return cls(_names(Path("/dev/shm")), _names(Path(tempfile.gettempdir())))  # noqa: S108 - looked at, not written to


def left_behind(box: Box, processes: list[psutil.Process], before: Before) -> list[str]:
    """What is still there of a box that has ended, in words; `processes` are all that it ever was seen to have."""
    left = [f"process {process.pid}" for process in processes if _runs(process)]
    left += [f"port {port}" for port in (box.port, box.bus_port) if _is_taken(port)]
    after = Before.look()
    left += [f"shared memory {name}" for name in sorted(after.shared - before.shared) if "zenoh" in name]
    left += [f"temporary {name}" for name in sorted(after.temporary - before.temporary) if "kinebox" in name or "numba" in name]
    return box.remains + left


def _names(folder: Path) -> frozenset[str]:
    return frozenset(path.name for path in folder.iterdir())


def _runs(process: psutil.Process) -> bool:
    try:
        return process.is_running() and process.status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False


def _is_taken(port: int) -> bool:
    with closing(socket.socket()) as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0
