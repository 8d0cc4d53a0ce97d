"""Joining a box's bus from outside it, for somebody who waits: in bounded time, also if its router hangs."""

import socket
import threading
from concurrent.futures import Future

from models.process import Bus
from services.bus.endpoint import split_endpoint

_ACCEPT_S = 1.0


def join(endpoint: str, within_s: float) -> Bus | None:
    """A client on the bus; None if no router answers in time.

    The port of a router that hangs accepts, and nothing follows: Zenoh then waits for ten seconds, and cannot be told to stop. So
    that is left to a thread, which closes what it still opens.
    """
    from services.bus.zenoh_bus import open_client  # noqa: PLC0415 - a machine on which it cannot be imported is examined, too

    stop = threading.Event()
    opened: Future[Bus | None] = Future()

    def open_it() -> None:
        try:
            opened.set_result(open_client(endpoint, stop))
        except BaseException as error:  # noqa: BLE001 - it is raised where the result is waited for
            opened.set_exception(error)

    threading.Thread(target=open_it, name="bus-join", daemon=True).start()
    try:
        return opened.result(within_s)
    except TimeoutError:
        stop.set()
        opened.add_done_callback(_close)
        return None


def accepts(endpoint: str) -> bool:
    """Whether somebody listens at the endpoint, who may hang all the same."""
    try:
        socket.create_connection(split_endpoint(endpoint), _ACCEPT_S).close()
    except OSError:
        return False
    return True


def _close(opened: Future[Bus | None]) -> None:
    if opened.exception() is None and (bus := opened.result()) is not None:
        bus.close()
