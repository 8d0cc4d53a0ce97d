"""The boxes that run on this machine, from the table of processes."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import zip_longest
from pathlib import Path

import psutil

from services.supervisor.child import name_of

_MAIN = "services.cli.main"
_SITE = "--site"


@dataclass(frozen=True)
class BoxProcess:
    """One process of a box. `stopped` is the kernel's: by SIGSTOP or a debugger."""

    pid: int
    stopped: bool


@dataclass
class RunningBox:
    """The processes of one box.

    Attributes:
        site: its site file.
        supervisor: None if only processes without one were found.
        processes: by name on the bus; a spare, which waits to take over, has its name too.
    """

    site: Path
    supervisor: BoxProcess | None = None
    processes: dict[str, list[BoxProcess]] = field(default_factory=dict)

    def owns(self, pid: int) -> bool:
        """Whether it is a process of this box."""
        everyone = [process for processes in self.processes.values() for process in processes]
        return any(process.pid == pid for process in (*everyone, *filter(None, (self.supervisor,))))


def gather_boxes() -> list[RunningBox]:
    """Every box whose processes can be seen."""
    boxes: dict[Path, RunningBox] = {}
    for process, command, name in _ours():
        site = _site_of(process, command)
        if site is None:
            continue
        box = boxes.setdefault(site, RunningBox(site))
        entry = BoxProcess(process.pid, process.info["status"] == psutil.STATUS_STOPPED)
        if name is None:
            box.supervisor = entry
        else:
            box.processes.setdefault(name, []).append(entry)
    return list(boxes.values())


def _ours() -> Iterator[tuple[psutil.Process, list[str], str | None]]:
    """Processes of boxes with their command lines and names; None is the name of a supervisor."""
    for process in psutil.process_iter(["cmdline", "status"]):
        command = process.info["cmdline"] or []
        if process.info["status"] == psutil.STATUS_ZOMBIE:
            continue
        if (name := name_of(command)) is not None or _is_supervisor(command):
            yield process, command, name


def _is_supervisor(command: list[str]) -> bool:
    called = _MAIN in command or any(Path(word).name == "kinebox" for word in command[:2])
    return called and "run" in command and _site_file(command) is not None


def _site_of(process: psutil.Process, command: list[str]) -> Path | None:
    try:
        site_file = _site_file(command)
        return None if site_file is None else (Path(process.cwd()) / site_file).resolve()
    except (psutil.Error, OSError):
        return None


def _site_file(command: list[str]) -> str | None:
    """As it was typed: `--site FILE` or `--site=FILE`, which mean the same."""
    for word, after in zip_longest(command, command[1:]):
        if word == _SITE:
            return after
        if word.startswith(f"{_SITE}="):
            return word.removeprefix(f"{_SITE}=")
    return None
