"""A small disk that can be filled: a file system in memory, which bears the name of the process that mounted it.

A process that is killed leaves its file system mounted; by that name the next one knows it as left over and unmounts it.
"""

import os
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import psutil

DISK_MB = 256
_PREFIX = "kinebox-drill"


@contextmanager
def small_disk(folder: Path) -> Iterator[None]:
    """A file system of `DISK_MB` in memory; those that are left over of killed processes are unmounted first."""
    unmount_left_over()
    folder.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", f"size={DISK_MB}m", _name(psutil.Process()), str(folder)]
    subprocess.run(command, check=True, capture_output=True)
    try:
        yield
    finally:
        _unmount(folder)


def may_mount(folder: Path) -> bool:
    """Whether a file system can be mounted here."""
    with suppress(subprocess.CalledProcessError, FileNotFoundError), small_disk(folder / "probe"):
        return True
    return False


def mounted() -> list[tuple[str, Path]]:
    """Names and folders of all small disks that there are, of whatever process."""
    lines = (line.split() for line in Path("/proc/self/mounts").read_text().splitlines())
    # The kernel writes a space in a path as an octal escape.
    return [
        (name, Path(os.fsdecode(folder.encode().decode("unicode_escape").encode("latin-1"))))
        for name, folder, *_ in lines
        if name.startswith(f"{_PREFIX}-")
    ]


def unmount_left_over() -> None:
    """Unmount the small disks of processes that do not run any more."""
    disks = mounted()
    running = {_name(process) for process in psutil.process_iter()} if disks else set()
    for name, folder in disks:
        if name not in running:
            _unmount(folder)


def _name(process: psutil.Process) -> str:
    """The process's id may be another's one day, but not together with the time of its start."""
    try:
        return f"{_PREFIX}-{process.pid}-{process.create_time():.2f}"
    except psutil.NoSuchProcess:
        return ""


def _unmount(folder: Path) -> None:
    subprocess.run(["umount", "--lazy", str(folder)], check=True)
