"""How long a connection may be at what it is at. Uvicorn waits for ever for whoever begins a request, or takes no answer.

What it is at is read from Uvicorn's own state of the connection, which is why `process` names the two protocols that Uvicorn
shall use.
"""

import asyncio
import math
from typing import cast

from uvicorn.protocols.http.h11_impl import H11Protocol, RequestResponseCycle

from services.tablet.page_socket import PageSocket

REQUEST_S = 20.0
"""A browser asks at once, but also opens connections that it may never need."""
ANSWER_S = 60.0
"""The page has 0.75 MB: over a network that takes longer for that no figure would move."""


def stage(transport: asyncio.Transport) -> tuple[object, float]:
    """What a connection is at, equal for as long as that is the same, and how many seconds it may be."""
    protocol = transport.get_protocol()
    if transport.is_closing():
        # What was said last is still to be taken.
        return "closing", REQUEST_S
    if isinstance(protocol, PageSocket):
        # The figure's socket may stay; Uvicorn's pings find out whether somebody is there.
        return "socket", math.inf if protocol.handshake_complete else REQUEST_S
    # There is none before the first request.
    cycle: RequestResponseCycle | None = cast(H11Protocol, protocol).cycle
    if cycle is None or cycle.response_complete:
        return ("asking", cycle), REQUEST_S
    return ("answered", cycle), ANSWER_S
