"""Run one process of the box: read the site, join the bus, and hand over until told to stop."""

import contextlib
import sys
import threading
import time
from dataclasses import dataclass
from importlib.metadata import EntryPoint
from pathlib import Path

from models.errors import UserError
from models.process import EDGE, ROUTERS, SPARE_READY, Bus, Playback, ProcessContext, process_name
from services.cli.parts import Process, find_process, load_process
from services.site_file.reading import read_site
from services.support.getting_ready import getting_ready
from services.support.health import ResourceMeter
from services.support.heartbeat import Heartbeat
from services.support.signals import stop_on_signals


@dataclass(frozen=True)
class ProcessOrder:
    """What to run: the process's entry point, and for an edge process its camera.

    `start_ns` is shared by all processes of one run; None is now. A `spare` gets everything ready, says so, then waits for a line
    on its standard input, and ends without having joined the bus if that is closed. `playback` is what a replay plays.
    """

    entry: str
    site: Path
    data: Path
    camera: str | None = None
    start_ns: int | None = None
    spare: bool = False
    playback: Playback | None = None

    @property
    def name(self) -> str:
        """The name on the bus."""
        return process_name(self.entry, self.camera)


def run_process(order: ProcessOrder) -> None:
    """Run until SIGTERM or SIGINT; a second signal ends it at once.

    Raises:
        UserError: the site, the bus or the process itself cannot work.
    """
    stop = stop_on_signals()
    site, rig = read_site(order.site)
    _require_camera(order, rig.names)
    entry = find_process(order.entry)
    from services.bus.zenoh_bus import BusError  # noqa: PLC0415 - a wrong site file shall not wait for it

    ready = _load_and_join(order, entry, site.bus.endpoint, stop)
    if ready is None:
        return
    main, bus = ready
    heartbeat = Heartbeat(order.name, bus)
    context = ProcessContext(
        name=order.name,
        camera=order.camera,
        site=site,
        rig=rig,
        data=order.data,
        start_ns=time.monotonic_ns() if order.start_ns is None else order.start_ns,
        bus=bus,
        stop=stop,
        resources=ResourceMeter(),
        playback=order.playback,
        beat=heartbeat,
    )
    try:
        main(context)
    finally:
        with contextlib.suppress(BusError):  # Who cannot say that it ends ends all the same.
            heartbeat.last()
        bus.close()


def _load_and_join(order: ProcessOrder, entry: EntryPoint, endpoint: str, stop: threading.Event) -> tuple[Process, Bus] | None:
    """The process's main function and the bus; None if the process is told to stop, or its post never falls vacant."""
    from services.bus.zenoh_bus import open_client, open_router  # noqa: PLC0415 - as above

    routes = order.entry in ROUTERS
    if routes and not order.spare:
        # The router first, because everybody waits for it.
        router = open_router(endpoint)
        with getting_ready(order.name, router):
            return load_process(entry), router
    main = load_process(entry)
    if order.spare and not _is_called():
        return None
    bus = open_router(endpoint) if routes else open_client(endpoint, stop)
    return None if bus is None else (main, bus)


def _is_called() -> bool:
    """Say that everything is ready, and wait for the post; False if it will never fall vacant."""
    sys.stdout.write(f"{SPARE_READY}\n")
    sys.stdout.flush()
    return bool(sys.stdin.buffer.readline())


def _require_camera(order: ProcessOrder, names: tuple[str, ...]) -> None:
    """Raise UserError unless an edge process has a camera of the site, and any other has none."""
    if order.entry != EDGE:
        if order.camera is not None:
            raise UserError(f"process '{order.entry}' serves no camera of its own; leave out --camera")
        return
    if order.camera is None:
        raise UserError(f"process '{EDGE}' serves one camera; name it with --camera ({', '.join(names)})")
    if order.camera not in names:
        raise UserError(f"camera '{order.camera}' is not in {order.site}, which has {', '.join(names)}; correct its name")
