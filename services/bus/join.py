"""Joining a box's bus from outside it, for somebody who waits: in bounded time, also if its router hangs."""

import socket
import time
from typing import Final

from models.config.endpoint import split_endpoint
from models.process import Bus

_ACCEPT_S: Final = 1.0
_AGAIN_S: Final = 0.1
"""Between two tries, and the shortest one."""


def join(endpoint: str, within_s: float) -> Bus | None:
    """A client on the bus; None if no router answers in time: the port of one that hangs accepts, and nothing follows."""
    from services.bus.zenoh_bus import try_client  # noqa: PLC0415 - a machine on which it cannot be imported is examined, too

    ends_s = time.monotonic() + within_s
    while (left_s := ends_s - time.monotonic()) > _AGAIN_S:
        bus = try_client(endpoint, answers_within_s=left_s)
        if bus is not None:
            return bus
        time.sleep(_AGAIN_S)
    return None


def accepts(endpoint: str) -> bool:
    """Whether somebody listens at the endpoint, who may hang all the same."""
    try:
        socket.create_connection(split_endpoint(endpoint), _ACCEPT_S).close()
    except OSError:
        return False
    return True
