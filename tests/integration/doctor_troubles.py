"""Every trouble that `kinebox doctor` must name, each really staged: the list in docs/doctor.md is this one.

A stage is a context manager: within it the trouble is there, and what the doctor finds is its value.
"""

import os
import resource
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

from edge.inspect import inspect
from models.messages import codec
from services.doctor.examine import Order, examine
from services.doctor.finding import Examined
from services.doctor.installation import PAGE, Installation, gather_installation
from services.support.machine import Sensors, Throttling
from tests.installed import DATA
from tests.integration import doctor_room, small_edge
from tests.integration.box import Box, HealthWatch
from tests.integration.house import House, build_house, replace_text
from tests.integration.waiting import until

Stage = Callable[[Path], AbstractContextManager[Examined]]
SECOND_NS = 1_000_000_000


@dataclass(frozen=True)
class Trouble:
    """A trouble, and patterns that one finding must match: the part at fault, what is wrong, and what to do."""

    stage: Stage
    where: str
    what: str
    remedy: str
    level: str = "fault"


@lru_cache(maxsize=1)
def _installation_here() -> Installation:
    """This machine's, gathered once; its kernels and page are what some troubles are about, and good for the others."""
    found = gather_installation(DATA)
    return replace(found, kernels=found.kernels or 0, kernels_lacking=(), kernels_problem="", page_lacks=())


def examined(house: House | Box, **changes: object) -> Examined:
    """What the doctor finds in a house or of a running box."""
    order = Order(house.site, house.data, (inspect,), installation=lambda _: _installation_here())
    return examine(replace(order, **changes))  # type: ignore[arg-type]


def broken(break_it: Callable[[House], object]) -> Stage:
    """A house in which one thing is broken."""

    @contextmanager
    def stage(folder: Path) -> Iterator[Examined]:
        house = build_house(folder)
        break_it(house)
        yield examined(house)

    return stage


@contextmanager
def footage_without_a_site(folder: Path) -> Iterator[Examined]:
    house = build_house(folder)
    _flip_byte(house.videos / "a.avi")
    yield examined(house, site=None)


def measured(**sensors: object) -> Stage:
    """A machine that measures something else than this one."""

    @contextmanager
    def stage(folder: Path) -> Iterator[Examined]:
        yield examined(build_house(folder), sensors=replace(Sensors(), **sensors))  # type: ignore[arg-type]

    return stage


def installed(spoil: Callable[[House], Installation]) -> Stage:
    """An installation that is looked at anew, spoilt."""

    @contextmanager
    def stage(folder: Path) -> Iterator[Examined]:
        house = build_house(folder)
        yield examined(house, installation=lambda _: spoil(house))

    return stage


def _flip_byte(file: Path) -> None:
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)


def _loop(house: House) -> None:
    shutil.rmtree(house.data)
    house.data.symlink_to(house.data)


def _file_for_folder(house: House) -> None:
    shutil.rmtree(house.data)
    house.data.write_text("")


def _with_module(name: str, source: str) -> Callable[[House], Installation]:
    def spoil(house: House) -> Installation:
        folder = house.folder / "shadow"
        folder.mkdir()
        (folder / f"{name}.py").write_text(source)
        before = os.environ.get("PYTHONPATH")
        os.environ["PYTHONPATH"] = f"{folder}{os.pathsep}{before or ''}"
        try:
            return gather_installation(DATA)
        finally:
            os.environ.pop("PYTHONPATH") if before is None else os.environ.update(PYTHONPATH=before)

    return spoil


def _page_without_its_program(house: House) -> Installation:
    page = house.folder / "dist"
    page.mkdir()
    (page / "index.html").write_text('<script type="module" src="/assets/index-1.js"></script>')
    return gather_installation(DATA, page)


@contextmanager
def file_size_limit(folder: Path) -> Iterator[Examined]:
    house = build_house(folder)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    _installation_here()
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, before[1]))
    try:
        found = examined(house)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    yield found


@contextmanager
def port_taken_by_a_program(folder: Path) -> Iterator[Examined]:
    house = build_house(folder)
    command = [sys.executable, "-m", "http.server", str(house.page_port), "--bind", "127.0.0.1", "--directory", str(folder)]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as program:
        try:
            until(lambda: _answers(house.page_port), "the program to listen")
            yield examined(house)
        finally:
            program.kill()


def _answers(port: int) -> bool:
    with suppress(OSError), socket.create_connection(("127.0.0.1", port), 1.0):
        return True
    return False


@contextmanager
def port_taken_by_another_box(folder: Path) -> Iterator[Examined]:
    (folder / "other").mkdir()
    (folder / "own").mkdir()
    with Box(folder / "other") as box:
        box.wait_page()
        house = build_house(folder / "own")
        replace_text(house.site, f"port = {house.page_port}", f"port = {box.page_port}")
        yield examined(house)


def running(
    stage_it: Callable[[Box], object],
    orders: dict[str, str] | None = None,
    more: str = "",
    edge: str | None = None,
    film: Callable[[Path], None] = small_edge.write_film,
) -> Stage:
    """A box that runs, to which something happens."""

    @contextmanager
    def stage(folder: Path) -> Iterator[Examined]:
        small_edge.write_film(folder / "data" / "footage" / "a.avi")
        film(folder / "data" / "footage" / "b.avi")
        with Box(folder, orders, more, *([edge] if edge else [])) as box:
            box.wait_started()
            try:
                stage_it(box)
                yield examined(box)
            finally:
                if box.process.poll() is None:
                    box.process.send_signal(signal.SIGCONT)

    return stage


def _wait_for(box: Box, process: str, state: str) -> None:
    with HealthWatch(box) as watch:
        watch.wait_for(process, state)


def _all_well(box: Box) -> None:
    box.wait_page()
    with HealthWatch(box) as watch:
        for name in ("fusion", "edge-a", "edge-b", "tablet", "supervisor"):
            watch.wait_for(name, "ok")


def _stop(*names: str) -> Callable[[Box], None]:
    """Stop processes while the supervisor, who would see to it, is stopped too."""

    def stage(box: Box) -> None:
        _all_well(box)
        box.process.send_signal(signal.SIGSTOP)
        for name in names:
            os.kill(box.pid(name), signal.SIGSTOP)

    return stage


def _kill_once(box: Box) -> None:
    _all_well(box)
    pid = box.pid("edge-a")
    os.kill(pid, signal.SIGKILL)
    box.wait_restarted("edge-a")
    with HealthWatch(box) as watch:
        back = watch.wait_for("edge-a", "ok", box.pid("edge-a"))
        watch.wait_for("supervisor", "ok", after_ns=back.t_ns)


def _kill_unseen(box: Box) -> None:
    """The supervisor cannot start it anew."""
    _all_well(box)
    box.process.send_signal(signal.SIGSTOP)
    os.kill(box.pid("edge-b"), signal.SIGKILL)


@contextmanager
def another_version(folder: Path) -> Iterator[Examined]:
    package = folder / "packages" / "kinebox-9.9.9.dist-info"
    package.mkdir(parents=True)
    (package / "METADATA").write_text("Metadata-Version: 2.1\nName: kinebox\nVersion: 9.9.9\n")
    with running(_all_well)(folder) as found:
        yield found


@contextmanager
def log_that_cannot_be_written(folder: Path) -> Iterator[Examined]:
    (folder / "data").mkdir()
    (folder / "data" / "logs").write_text("a file where the folder should be")
    with running(_until_told("supervisor", "degraded"))(folder) as found:
        yield found


def _until_told(process: str, state: str) -> Callable[[Box], None]:
    return lambda box: _wait_for(box, process, state)


def _slow_for_a_while(box: Box) -> None:
    with HealthWatch(box) as watch:
        first = watch.wait_for("edge-b", "ok")
        watch.wait_for("edge-b", "ok", after_ns=first.t_ns + 2 * SECOND_NS)


def _fault(camera: str, kind: str) -> str:
    return f'[[faults]]\ncamera = "{camera}"\nkind = "{kind}"\nat_s = 0.0\nfor_s = 10000.0\n'


@contextmanager
def clock_set_while_running(folder: Path) -> Iterator[Examined]:
    offset_ns = [1_900_000_000 * SECOND_NS]
    sensors = replace(Sensors(), clocks_ns=lambda: (offset_ns[0] + time.monotonic_ns(), time.monotonic_ns()))
    with doctor_room.room(folder) as room:
        measure = room.measured(sensors)
        room.voices["supervisor"] = lambda: room.supervisor(measure())
        measure()
        offset_ns[0] += 90 * SECOND_NS
        yield room.judged()


@contextmanager
def messages_that_nobody_can_read(folder: Path) -> Iterator[Examined]:
    with doctor_room.room(folder) as room:
        room.voices["stranger"] = lambda: codec.encode(room.health("stranger"))[:-3]
        yield room.judged()


@contextmanager
def camera_moved(folder: Path) -> Iterator[Examined]:
    with doctor_room.filmed(folder, calibration=doctor_room.turned("cam1", 4.0)) as room:
        yield room.judged()


@contextmanager
def camera_of_another_loop(folder: Path) -> Iterator[Examined]:
    with doctor_room.filmed(folder, late="cam2") as room:
        yield room.judged()


_EDGE = "tests.integration.small_edge:main"

TROUBLES: dict[str, Trouble] = {
    # The configuration.
    "the site file does not exist": Trouble(
        broken(lambda house: house.site.unlink()), "site file", r"site\.toml does not exist", "correct its path"
    ),
    "the site file has an unknown key": Trouble(
        broken(lambda house: replace_text(house.site, "[tablet]\n", "[tablet]\nspeling = 1\n")),
        "site file",
        "unknown field `speling`",
        r"docs/configuration\.md",
    ),
    "the site file asks for faults on demand": Trouble(
        broken(lambda house: house.site.write_text(house.site.read_text() + _fault("a", "stall"))),
        "site file",
        "asks for faults on demand: a will fall ill",
        "remove them",
        "warning",
    ),
    "the calibration names another camera": Trouble(
        broken(lambda house: replace_text(house.rig, 'name = "b"', 'name = "z"')),
        "calibration|site file",
        "camera 'b' is not in the calibration",
        "calibrate it or correct its name",
    ),
    "the calibration is cut off": Trouble(
        broken(lambda house: house.rig.write_bytes(house.rig.read_bytes()[:-40])),
        "calibration",
        r"calibration .*rig\.toml",
        "calibrate again",
    ),
    "the page and the bus have one port": Trouble(
        broken(lambda house: replace_text(house.site, f"tcp/127.0.0.1:{house.bus_port}", f"tcp/127.0.0.1:{house.page_port}")),
        "ports",
        "is both the page's and the bus's",
        r"change tablet\.port or bus\.endpoint|correct it",
    ),
    "the page's address is none of this machine's": Trouble(
        broken(lambda house: replace_text(house.site, 'host = "127.0.0.1"', 'host = "192.0.2.99"')),
        "ports",
        r"port of the page: .*192\.0\.2\.99",
        r"change tablet\.port",
    ),
    # The data folder.
    "a network file has one wrong byte": Trouble(
        broken(lambda house: _flip_byte(house.networks / "nanodet.onnx")),
        "network nanodet",
        r"nanodet\.onnx is damaged",
        "run `make networks`",
    ),
    "no network is installed": Trouble(
        broken(lambda house: shutil.rmtree(house.networks)), "networks", "there are no networks in", "run `make networks`"
    ),
    "a camera's file is cut off": Trouble(
        broken(lambda house: (house.videos / "b.avi").write_bytes((house.videos / "b.avi").read_bytes()[:-100])),
        "camera 'b'",
        r"b\.avi has \d+ bytes instead of \d+",
        "run `make footage SOURCE=footage`",
    ),
    "a camera's file has one wrong byte": Trouble(
        broken(lambda house: _flip_byte(house.videos / "a.avi")),
        "camera 'a'",
        r"a\.avi is damaged",
        "run `make footage SOURCE=footage`",
    ),
    "a camera's file is missing": Trouble(
        broken(lambda house: (house.videos / "b.avi").unlink()), "camera 'b'", r"b\.avi is missing", "correct `path`"
    ),
    "the built-in footage is damaged": Trouble(
        footage_without_a_site, "footage", r"a\.avi is missing or damaged", "run `make footage SOURCE=footage`"
    ),
    "the data folder cannot be read": Trouble(broken(_loop), "data folder", "cannot be used: Too many levels", "correct --data"),
    "the data folder is a file": Trouble(broken(_file_for_folder), "data folder", "is no folder", "correct --data"),
    "nothing can be written to the data folder": Trouble(
        file_size_limit, "data folder", "cannot be used: File too large", "mend its disk"
    ),
    # The machine.
    "the disk is full": Trouble(
        measured(free_disk_mb=lambda _: 120.0), "disk", "the disk of the data folder is full: 120 MB", "delete old lessons"
    ),
    "the disk is nearly full": Trouble(
        measured(free_disk_mb=lambda _: 1500.0), "disk", r"is nearly full: 1\.5 GB", "delete old lessons", "warning"
    ),
    "memory is nearly gone": Trouble(
        measured(free_memory_mb=lambda: 80.0), "memory", "memory is nearly gone: 80 MB", "end other programs"
    ),
    "the processor is too hot": Trouble(measured(temperature_c=lambda: 101.0), "processor", "too hot: 101 °C", "clean its fan"),
    "the processor is slowed down": Trouble(
        measured(throttling=lambda: Throttling(0, now=True)), "processor", "was slowed down", "power supply", "warning"
    ),
    "the clock was never set": Trouble(
        measured(clocks_ns=lambda: (3600 * SECOND_NS, SECOND_NS)), "clock", "the clock says 01 Jan 1970", "set it", "warning"
    ),
    # What was installed.
    "the page is not built": Trouble(
        installed(lambda house: gather_installation(DATA, house.folder / "none")),
        "page",
        r"index\.html is missing",
        "run `make web`",
    ),
    "a file of the page is missing": Trouble(
        installed(_page_without_its_program), "page", r"assets/index-1\.js is missing", "run `make web`"
    ),
    "the kernels are not compiled": Trouble(
        installed(lambda house: gather_installation(house.data, PAGE)),
        "kernels",
        r"(\d+) of \1 numerical kernels are not compiled",
        "run `make kernels`",
        "warning",
    ),
    "a package cannot be imported": Trouble(
        installed(_with_module("mcap", "import a_library_that_is_gone")),
        "package mcap",
        "cannot be imported: ModuleNotFoundError: .*a_library_that_is_gone",
        "run `make setup`",
    ),
    "a library is made for another processor": Trouble(
        installed(_with_module("av", "import os, signal; os.kill(os.getpid(), signal.SIGILL)")),
        "package av",
        r"cannot be imported: it ended its process \(SIGILL\)",
        "run `make setup`",
    ),
    # The ports.
    "another program has the page's port": Trouble(
        port_taken_by_a_program, "port of the page", r"is taken by .*http\.server .*\(process \d+\)", r"kill \d+"
    ),
    "another KineBox has the page's port": Trouble(
        port_taken_by_another_box, "port of the page", r"is taken by another KineBox, of .*other/site\.toml", r"kill \d+"
    ),
    # A box that runs.
    "a process crashes until it is given up": Trouble(
        running(lambda box: _wait_for(box, "supervisor", "failed"), {"edge-b": "crash"}, "[supervisor]\nmax_restarts = 2\n"),
        "edge-b",
        "edge-b is given up and does not run any more: ended 3 times within 60 s; last, it ended with exit code 1",
        "start the box anew",
    ),
    "a process was killed": Trouble(
        running(_kill_once),
        "edge-a",
        r"edge-a was started again once; \d+ s ago it was ended by SIGKILL",
        "read what it said",
        "warning",
    ),
    "a process is missing": Trouble(running(_kill_unseen), "edge-b", "edge-b is missing", "it may be starting"),
    "a camera's process hangs": Trouble(
        running(_stop("edge-a")), "edge-a", r"edge-a \(process \d+\) is stopped", r"kill -CONT \d+"
    ),
    "the router hangs": Trouble(running(_stop("fusion")), "fusion", r"fusion \(process \d+\) is stopped", r"kill -CONT \d+"),
    "the supervisor hangs": Trouble(running(_stop()), "supervisor", r"supervisor \(process \d+\) is stopped", "kill -CONT"),
    "the page hangs": Trouble(running(_stop("tablet")), "tablet", r"the page at port \d+ does not answer", "wait some seconds"),
    "the log cannot be written": Trouble(
        log_that_cannot_be_written, "log", r"nothing is kept in .*kinebox\.log: File exists", "make room on its disk"
    ),
    "the box is of another version": Trouble(
        another_version, "version", r"the box that runs is KineBox 9\.9\.9", "start it anew with this version", "warning"
    ),
    "a camera is silent": Trouble(
        running(_until_told("edge-b", "degraded"), more=_fault("b", "stall"), edge=_EDGE),
        "camera 'b'",
        "camera 'b' is silent: it delivers no pictures",
        "check its cable",
    ),
    "a camera is gone": Trouble(
        running(_until_told("edge-b", "degraded"), more=_fault("b", "end"), edge=_EDGE),
        "camera 'b'",
        "camera 'b' is silent: it delivers no pictures .*",
        "check its cable",
    ),
    "a camera's lens is covered": Trouble(
        running(_until_told("edge-b", "degraded"), edge=_EDGE, film=small_edge.write_black_film),
        "camera 'b'",
        "camera 'b' .*shows black pictures",
        "take the cap off its lens",
        "warning",
    ),
    "a camera falls behind": Trouble(
        running(_slow_for_a_while, {"edge-b": "slow"}, edge=_EDGE),
        "camera 'b'",
        "camera 'b' falls behind: ",
        "end other programs",
        "warning",
    ),
    "a camera was moved": Trouble(
        camera_moved,
        "camera 'cam1'",
        r"the calibration of camera 'cam1' is doubtful: \d+% of its view",
        "calibrate it again",
        "warning",
    ),
    "a camera shows another loop of its film": Trouble(
        camera_of_another_loop,
        "fusion",
        "cam2 is not fused: its pictures are of a past epoch",
        "count their films' loops differently",
        "warning",
    ),
    "the clock was set": Trouble(
        clock_set_while_running, "clock", r"the clock was set forwards by 90\.0 s", "let a time service keep the clock", "warning"
    ),
    "somebody sends what nobody can read": Trouble(
        messages_that_nobody_can_read, "bus", r"\d+ messages on gym/health/stranger could not be read", "another version", "warning"
    ),
}
