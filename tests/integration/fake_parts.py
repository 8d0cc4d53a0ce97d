"""Parts of a box that cost nothing: they report their health and do as a file in the data folder tells them when they start.

`data/orders/NAME` holds one word: "crash", "hang" (reports no more once there is a file `data/hang`), "deaf" (to SIGTERM), "noise"
(prints what is no log line), "refuse" (ends with a line for people), "refuse again" (does so while there is a file `data/refuse`),
"stop the second" (the second of that name stops itself), "ail" (reports that it failed while there is a file `data/ail`) or
"linger" (beats, and takes three seconds to end of itself).
`data/starts/NAME` gets a line a start: process id, common beginning, folder of compiled kernels.
"""

import atexit
import os
import signal
import socket
import sys
import time
from pathlib import Path

from models.camera.rig import Rig
from models.config.site import Site
from models.errors import UserError
from models.messages import topics
from models.messages.trouble import Trouble
from models.process import ProcessContext
from services.support.health import HealthReporter

_DARK = Trouble("camera_dark", "its pictures are black")


def fusion(context: ProcessContext) -> None:
    _report_until_stopped(context)


def edge(context: ProcessContext) -> None:
    _report_until_stopped(context)


def tablet(context: ProcessContext) -> None:
    with socket.create_server((context.site.tablet.host, context.site.tablet.port)) as server:
        server.settimeout(0.05)
        _report_until_stopped(context, server)


def evaluation(context: ProcessContext) -> None:
    _report_until_stopped(context)


def recorder(context: ProcessContext) -> None:
    _report_until_stopped(context)


def check(_site: Site, _rig: Rig, data: Path) -> None:
    fault = data / "orders" / "check"
    if fault.is_file():
        raise UserError(fault.read_text())


def nothing_to_check(_site: Site, _rig: Rig, _data: Path) -> None:
    """What the tablet's real check asks for, a built page, is not needed by a fake one."""


def _report_until_stopped(context: ProcessContext, server: socket.socket | None = None) -> None:
    order = _order(context)
    if order == "crash":
        raise RuntimeError("crashed as ordered")
    if order == "refuse" or (order == "refuse again" and (context.data / "refuse").exists()):
        raise UserError(f"camera '{context.camera}': film.avi is missing; run 'make footage'")
    if order == "linger":
        _beat_and_linger(context)
        return
    if order == "noise":
        sys.stdout.write("what a library printed\n")
    context.bus.declare_alive(topics.alive(context.name))
    reporter = HealthReporter(context.name, context.bus, context.resources)
    while order == "deaf" or not context.stop.is_set():
        if reporter.due() and not (order == "hang" and (context.data / "hang").exists()):
            ails = order == "ail" and (context.data / "ail").exists()
            reporter.report("failed" if ails else "ok", (_DARK,) if ails else ())
        _answer_or_wait(server)


def _beat_and_linger(context: ProcessContext) -> None:
    context.bus.declare_alive(topics.alive(context.name))
    # Until the supervisor has heard one, and expects them.
    for _ in range(20):
        context.beat()
        time.sleep(0.1)
    atexit.register(time.sleep, 3.0)


def _answer_or_wait(server: socket.socket | None) -> None:
    if server is None:
        time.sleep(0.05)
        return
    try:
        connection, _ = server.accept()
    except TimeoutError:
        return
    with connection:
        connection.recv(100)
        connection.sendall(b"HTTP/1.0 200 OK\r\n\r\n")


def _order(context: ProcessContext) -> str:
    starts = context.data / "starts" / context.name
    starts.parent.mkdir(exist_ok=True)
    with starts.open("a") as file:
        file.write(f"{os.getpid()} {context.start_ns} {os.environ.get('NUMBA_CACHE_DIR')}\n")
    order = context.data / "orders" / context.name
    word = order.read_text() if order.is_file() else ""
    if word == "stop the second" and len(starts.read_text().splitlines()) == 2:
        os.kill(os.getpid(), signal.SIGSTOP)
    if word == "deaf":
        signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGTERM])
    return word
