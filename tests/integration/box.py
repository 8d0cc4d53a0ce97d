"""A whole box of fake parts under the real `kinebox run`, in a folder of its own."""

import os
import signal
import subprocess
import sys
import threading
from functools import partial
from pathlib import Path
from types import TracebackType

from models.config.site import SITE_VERSION
from models.messages import codec, topics
from models.messages.health import Health
from services.bus.zenoh_bus import open_client
from tests.integration.waiting import until
from tests.lifeline import bound
from tests.ports import free_port

ROOT = Path(__file__).parents[2]
NAMES = ("fusion", "edge-a", "edge-b", "tablet", "evaluation", "recorder")

ENTRY_POINTS = """
[kinebox.processes]
fusion = tests.integration.fake_parts:fusion
edge = {edge}
evaluation = tests.integration.fake_parts:evaluation
tablet = {tablet}
recorder = tests.integration.fake_parts:recorder
[kinebox.checks]
edge = {check}
tablet = tests.integration.fake_parts:nothing_to_check
"""

CAMERA = """
[[camera]]
name = "{name}"
size_px = [640, 480]
matrix_px = [[600.0, 0.0, 320.0], [0.0, 600.0, 240.0], [0.0, 0.0, 1.0]]
rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
translation_m = [{x_m}, 0.0, 3.0]
"""


def write_site(folder: Path, page_port: int, bus_port: int, more: str = "") -> Path:
    """A site of two cameras, "a" and "b", with its calibration; the site file's path."""
    rig = "version = 1\n" + CAMERA.format(name="a", x_m=0.0) + CAMERA.format(name="b", x_m=1.0)
    (folder / "rig.toml").write_text(rig)
    site = folder / "site.toml"
    cameras = "".join(f'[[cameras]]\nname = "{name}"\nkind = "video"\npath = "footage/{name}.avi"\n' for name in "ab")
    site.write_text(
        f'version = {SITE_VERSION}\nname = "Test gym"\ncalibration = "rig.toml"\n{cameras}'
        f'[bus]\nendpoint = "tcp/127.0.0.1:{bus_port}"\n[tablet]\nhost = "127.0.0.1"\nport = {page_port}\n{more}'
    )
    return site


def fake_parts(
    folder: Path,
    check: str = "tests.integration.fake_parts:check",
    edge: str = "tests.integration.fake_parts:edge",
    tablet: str = "tests.integration.fake_parts:tablet",
) -> dict[str, str]:
    """An environment in which the parts of the box are the fake ones: an installed package that comes first.

    `check` is what is checked before the start, `edge` the process of a camera, `tablet` the page's server.
    """
    package = folder / "packages" / "fake_parts-1.0.dist-info"
    package.mkdir(parents=True, exist_ok=True)
    (package / "METADATA").write_text("Metadata-Version: 2.1\nName: fake-parts\nVersion: 1.0\n")
    (package / "entry_points.txt").write_text(ENTRY_POINTS.format(check=check, edge=edge, tablet=tablet))
    return dict(os.environ) | {"PYTHONPATH": f"{package.parent}{os.pathsep}{ROOT}"}


class Box:
    """`kinebox run` as a process of its own.

    Args:
        folder: an empty folder.
        orders: what the fake parts are told, by process.
        more: further lines of the site file.
        edge, tablet: entry points of the process of a camera and of the page's server.
        console: a descriptor in the place of the files that take what a person is shown.
    """

    def __init__(
        self,
        folder: Path,
        orders: dict[str, str] | None = None,
        more: str = "",
        edge: str = "tests.integration.fake_parts:edge",
        tablet: str = "tests.integration.fake_parts:tablet",
        *,
        console: int | None = None,
    ) -> None:
        self.data = folder / "data"
        (self.data / "orders").mkdir(parents=True)
        for name, order in (orders or {}).items():
            (self.data / "orders" / name).write_text(order)
        self.page_port, self.bus_port = free_port(), free_port()
        self.site = write_site(folder, self.page_port, self.bus_port, more)
        self.errors = folder / "stderr"
        self.output = folder / "stdout"
        with self.errors.open("w") as errors, self.output.open("w") as output:
            self.process = subprocess.Popen(
                bound([sys.executable, "-m", "services.cli.main", "run", "--site", str(self.site), "--data", str(self.data)]),
                env=fake_parts(folder, edge=edge, tablet=tablet),
                stdout=output if console is None else console,
                stderr=errors if console is None else console,
                cwd=ROOT,
                start_new_session=True,
            )

    def __enter__(self) -> "Box":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        for name in NAMES:
            for pid in self.pids(name):
                if _runs(pid):
                    os.kill(pid, signal.SIGKILL)

    def pids(self, name: str) -> list[int]:
        """Of a process, one a start, in order."""
        return [int(line.split()[0]) for line in self._starts(name)]

    def pid(self, name: str) -> int:
        """Of the process of that name that was started last."""
        return self.pids(name)[-1]

    def start_times_ns(self) -> set[int]:
        """The common beginning that the processes were given, over all starts of all processes."""
        return {int(line.split()[1]) for name in NAMES for line in self._starts(name)}

    def wait_started(self, *names: str) -> None:
        """Until these processes (all by default) have been started at least once."""
        for name in names or NAMES:
            until(partial(self._was_started, name), partial(self._missed, f"a start of {name}"))

    def wait_page(self) -> None:
        """Until the person is told where the page is."""
        until(lambda: "is running" in self.output.read_text(), "the address of the page")

    def wait_restarted(self, name: str, starts: int = 2) -> None:
        """Until a process has been started so many times."""
        until(lambda: len(self.pids(name)) >= starts, partial(self._missed, f"start {starts} of {name}"))

    def wait_gone(self) -> None:
        """Until no process of the box is left."""
        until(lambda: not self.running(), "the end of every process")

    def running(self) -> list[str]:
        """The processes that exist, hung ones included."""
        return [name for name in NAMES if any(_runs(pid) for pid in self.pids(name))]

    def end(self, number: signal.Signals = signal.SIGTERM) -> int:
        """Tell the box to end as a service manager or a person does; its exit code."""
        self.process.send_signal(number)
        return self.process.wait(60.0)

    def _was_started(self, name: str) -> bool:
        return bool(self.pids(name))

    def _missed(self, what: str) -> str:
        return f"{what}; stderr:\n{self.errors.read_text()}"

    def _starts(self, name: str) -> list[str]:
        file = self.data / "starts" / name
        # A line is whole once it ends.
        return [line for line in file.read_text().splitlines(keepends=True) if line.endswith("\n")] if file.is_file() else []


class HealthWatch:
    """Somebody on the bus of a box who hears how its processes are."""

    def __init__(self, box: Box) -> None:
        bus = open_client(f"tcp/127.0.0.1:{box.bus_port}", threading.Event())
        assert bus is not None
        self._bus = bus
        self._subscription = bus.subscribe(topics.ALL_HEALTH, keep=4)
        self._newest: dict[str, Health] = {}

    def __enter__(self) -> "HealthWatch":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._bus.close()

    def wait_for(self, process: str, state: str, pid: int | None = None, after_ns: int = 0) -> Health:
        """Until a process (of that id) says, later than `after_ns`, that it is in that state."""

        def is_so() -> bool:
            while (delivery := self._subscription.receive(0.0)) is not None:
                health = codec.decode(delivery.payload, Health)
                self._newest[health.process] = health
            newest = self._newest.get(process)
            return newest is not None and newest.state == state and pid in (None, newest.pid) and newest.t_ns > after_ns

        until(is_so, f"{process} to be {state}; newest: {self._newest}")
        return self._newest[process]


def _runs(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return False
    # Whoever inherits an orphan may take its time to collect it.
    return state != "Z"
