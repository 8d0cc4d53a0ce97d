"""The box as it is shipped, in a folder of its own that can be filled, watched and looked over when it is gone."""

import json
import subprocess
import sys
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import dataclass, field
from pathlib import Path

import psutil

from tests.bench.running_box import processes, rss_mb
from tests.faults.disk import small_disk
from tests.installed import ROOT
from tests.integration.waiting import until
from tests.lifeline import bound
from tests.ports import free_port

SHIPPED = ROOT / "deploy/sites/footage"
STARTING_S = 120.0
"""A machine that has never compiled the kernels compiles them now."""
ENDING_S = 30.0
ISOLATED = "[supervisor]\nmax_restarts = 5\nwindow_s = 8\n[lessons]\nleast_free_mb = 50\n"
"""Drills come one after the other; each is a fault of its own and not part of a storm."""


@dataclass
class Box:
    """`kinebox run` as a process of its own.

    Attributes:
        folder: has the site file, the output of the box and its data folder.
        port, bus_port: of the page and of the bus.
        remains: what was not as it should be when the box had ended, before anything was cleared away.
    """

    process: "subprocess.Popen[bytes]"
    folder: Path
    port: int
    bus_port: int
    remains: list[str] = field(default_factory=list)

    @property
    def data(self) -> Path:
        """The data folder: logs and lessons of its own, networks and footage of the set-up."""
        return self.folder / "data"

    @property
    def page(self) -> str:
        """Address of the page."""
        return f"http://127.0.0.1:{self.port}/"

    @property
    def endpoint(self) -> str:
        """Address of the bus."""
        return f"tcp/127.0.0.1:{self.bus_port}"

    def output(self) -> str:
        """What the box has told the person who started it."""
        return (self.folder / "output").read_text()

    def answers(self) -> bool:
        """Whether the page's server answers."""
        try:
            with urllib.request.urlopen(f"{self.page}api/status", timeout=5) as answer:  # noqa: S310 - our own page
                return bool(json.load(answer))
        except OSError:
            return False

    def descendants(self) -> list[psutil.Process]:
        """Every process of the box but the supervisor, spares included."""
        return psutil.Process(self.process.pid).children(recursive=True)

    def children(self) -> dict[str, psutil.Process]:
        """The processes by their name on the bus; the one that waits to take over from another is "NAME-spare"."""
        return processes(psutil.Process(self.process.pid))

    def child(self, name: str) -> psutil.Process:
        """The process of that name, waited for."""
        until(lambda: name in self.children(), f"a process {name}; the box said:\n{self.output()}", STARTING_S)
        return self.children()[name]

    def rss_mb(self) -> float:
        """Resident memory of all processes."""
        total = 0.0
        for process in [psutil.Process(self.process.pid), *self.descendants()]:
            with suppress(psutil.Error):
                total += rss_mb(process)
        return total

    def start_ns(self) -> int:
        """CLOCK_MONOTONIC from which the sources count."""
        words = self.child("fusion").cmdline()
        return int(words[words.index("--start-ns") + 1])


def write_site(folder: Path, port: int, bus_port: int, more: str = ISOLATED) -> Path:
    """The shipped site with ports of its own and `more` lines, and a data folder; the site file's path."""
    (folder / "rig.toml").write_bytes((SHIPPED / "rig.toml").read_bytes())
    ports = f'\n[bus]\nendpoint = "tcp/127.0.0.1:{bus_port}"\n[tablet]\nhost = "127.0.0.1"\nport = {port}\n'
    site = folder / "site.toml"
    site.write_text((SHIPPED / "site.toml").read_text() + ports + more)
    return site


def fill_data_folder(data: Path, installed: Path) -> None:
    """What the set-up installed, by links; whatever the box writes stays in `data`."""
    data.mkdir(exist_ok=True)
    for part in ("networks", "footage", "kernels"):
        (data / part).symlink_to((installed / part).resolve())


@contextmanager
def running(folder: Path, installed: Path, more: str = ISOLATED, *, disk: bool = False) -> Iterator[Box]:
    """A box that has begun to answer; ended in order afterwards, or killed if it does not end.

    With `disk` its data folder is a small file system of its own, for which mounting must be allowed.
    """
    port, bus_port = free_port(), free_port()
    site = write_site(folder, port, bus_port, more)
    with small_disk(folder / "data") if disk else nullcontext():
        yield from _started(folder, site, installed, port, bus_port)


def _started(folder: Path, site: Path, installed: Path, port: int, bus_port: int) -> Iterator[Box]:
    fill_data_folder(folder / "data", installed)
    command = [sys.executable, "-m", "services.cli.main", "run", "--site", str(site), "--data", str(folder / "data")]
    with (folder / "output").open("wb") as output:
        process = subprocess.Popen(bound(command), cwd=ROOT, stdout=output, stderr=output, start_new_session=True)
    box = Box(process, folder, port, bus_port)
    try:
        until(lambda: box.answers() or process.poll() is not None, "the page's server", STARTING_S)
        assert process.poll() is None, box.output()
        yield box
    finally:
        end(box)


def end(box: Box) -> None:
    """SIGTERM, and SIGKILL to whatever then remains, which is noted; a stopped process would otherwise wait for ever."""
    if box.process.poll() is not None:
        box.remains.append(f"a supervisor that had ended by itself, with code {box.process.returncode}")
        return
    children = box.descendants()
    box.process.terminate()
    try:
        code = box.process.wait(ENDING_S)
        box.remains += [f"exit code {code}"] if code else []
    except subprocess.TimeoutExpired:
        box.remains.append(f"a supervisor that did not end within {ENDING_S:.0f} s")
        box.process.kill()
        box.process.wait()
    for child in children:
        with suppress(psutil.NoSuchProcess):
            if child.is_running() and child.status() != psutil.STATUS_ZOMBIE:
                box.remains.append(f"process {child.pid} of the box")
            child.kill()
    unfinished = (path for pattern in ("*.tmp", "*.part") for path in box.data.rglob(pattern))
    box.remains += [f"unfinished {path.name}" for path in unfinished]
