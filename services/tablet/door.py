"""The door of the page's server: how many connections there may be, of whom, and for how long they may do nothing.

Uvicorn and asyncio let in everybody until the process can open nothing more, and then say so in thousands of lines. Here whoever
comes too many is turned away, which is said once, and those inside are not disturbed.
"""

import asyncio
import resource
import socket
from collections.abc import Callable
from typing import Final

import structlog

from services.tablet.patience import stage

PLACES: Final = 256
"""Fifty tablets that all load the page at once."""
OF_ONE_ADDRESS: Final = 128
"""Generous: behind one address may be a school's proxy, with every tablet. The other half is for the others."""
RECEIVE_BUFFER_BYTES: Final = 8192
"""A page says little; what is read in one go holds up the figure of everybody else."""

_LOOK_S = 1.0
_AGAIN_S = 0.5
_OVER_AFTER_S = 10.0

log = structlog.get_logger()


def places() -> int:
    """How many connections there is room for: at most half of what this process may open, which needs the rest for the bus."""
    may_open, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    return PLACES if may_open == resource.RLIM_INFINITY else min(PLACES, may_open // 2)


class Door:
    """Lets connections in, and out. Used from the event loop's thread only.

    Args:
        listener: where they come from.
        welcome: makes the protocol that serves one.
        most: connections that there may be.
    """

    def __init__(self, listener: socket.socket, welcome: Callable[[], asyncio.Protocol], most: int) -> None:
        self._listener = listener
        self._welcome = welcome
        self._most = most
        self._of_one = min(OF_ONE_ADDRESS, max(1, most // 2))
        self._inside: list[_Connection] = []
        self._turned_away = 0
        self._turned_away_s = 0.0

    async def let_in(self) -> None:
        """Let in whoever comes, for ever, one at a time: between two of them everybody inside has his turn."""
        loop = asyncio.get_running_loop()
        self._listener.setblocking(False)
        # A connection takes it over from its listener.
        self._listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER_BYTES)
        while True:
            try:
                connection, address = await loop.sock_accept(self._listener)
                await self._receive(connection, address[0])
            except ConnectionAbortedError:
                continue  # He left while he waited.
            except OSError as error:
                self._turn_away(f"{error.strerror}; restart the box if this lasts")
                await asyncio.sleep(_AGAIN_S)

    async def show_out(self) -> None:
        """End, for ever, the connections that are at one thing for too long, and say when nobody is turned away any more."""
        loop = asyncio.get_running_loop()
        while True:
            await asyncio.sleep(_LOOK_S)
            now_s = loop.time()
            self._forget_who_left()
            for connection in self._inside:
                connection.end_if_stuck(now_s)
            if self._turned_away and now_s - self._turned_away_s > _OVER_AFTER_S:
                log.info("no connection is turned away any more", turned_away=self._turned_away)
                self._turned_away = 0

    async def _receive(self, connection: socket.socket, address: str) -> None:
        loop = asyncio.get_running_loop()
        if reason := self._no_room_for(address):
            connection.close()
            self._turn_away(reason)
            await asyncio.sleep(0)
        else:
            transport, _ = await loop.connect_accepted_socket(self._welcome, connection)
            self._inside.append(_Connection(transport, address, loop.time()))

    def _no_room_for(self, address: str) -> str:
        """Why one more of an address cannot be let in; empty if it can."""
        self._forget_who_left()
        if sum(connection.address == address for connection in self._inside) >= self._of_one:
            return f"{address} has {self._of_one}, which is all that one address may have; find out what opens them there"
        if len(self._inside) >= self._most:
            return f"there are {self._most}, which is all that there may be; close pages that nobody looks at"
        return ""

    def _forget_who_left(self) -> None:
        self._inside = [connection for connection in self._inside if connection.is_open]

    def _turn_away(self, reason: str) -> None:
        if not self._turned_away:
            log.warning(f"connections to the page are turned away: {reason}")
        self._turned_away += 1
        self._turned_away_s = asyncio.get_running_loop().time()


class _Connection:
    """Somebody inside."""

    def __init__(self, transport: asyncio.Transport, address: str, now_s: float) -> None:
        self._transport = transport
        self._socket = transport.get_extra_info("socket")
        self._stage = stage(transport)[0]
        self._since_s = now_s
        self.address = address

    @property
    def is_open(self) -> bool:
        """Whether it still holds its descriptor: one that is closed does until the other side has taken what was said to it."""
        return bool(self._socket.fileno() >= 0)

    def end_if_stuck(self, now_s: float) -> None:
        """End it, if it is at one thing for longer than that may last."""
        now_at, longest_s = stage(self._transport)
        if now_at != self._stage:
            self._stage, self._since_s = now_at, now_s
        elif now_s - self._since_s > longest_s:
            self._transport.abort()
