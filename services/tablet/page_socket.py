"""The protocol of a page's socket, for those who send what no page can: they are ended with a code, and with no line in the log.

`audience` sees whole messages only, and reads them no faster than it likes (`pace`). Pings of the protocol, unasked pongs and
pieces of messages never get there, but each costs nearly as much.
"""

import asyncio
from typing import Any, Final

from uvicorn.config import Config
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from uvicorn.server import ServerState
from websockets.frames import CloseCode, Frame

from services.tablet.pace import Pace

HZ: Final = 5
BURST: Final = 20
"""A browser answers a ping in 20 s, and sends none; other programs send one in as long. Neither has anything to say in pieces."""


class PageSocket(WebSocketsSansIOProtocol):
    """Uvicorn's, with a bound on what is not a whole message."""

    def __init__(
        self, config: Config, server_state: ServerState, app_state: dict[str, Any], _loop: asyncio.AbstractEventLoop | None = None
    ) -> None:
        super().__init__(config, server_state, app_state, _loop)
        self._pace = Pace(HZ, BURST)

    def handle_ping(self) -> None:
        """Answer it."""
        if self._is_bearable():
            super().handle_ping()

    def handle_pong(self, event: Frame) -> None:
        """Somebody is there."""
        if self._is_bearable():
            super().handle_pong(event)

    def handle_cont(self, event: Frame) -> None:
        """A further piece of a message."""
        if self._is_bearable():
            super().handle_cont(event)

    def send_receive_event_to_app(self) -> None:
        """Pass on a whole message. Uvicorn logs a traceback for a text that is none."""
        if self.curr_msg_data_type == "text" and not _is_text(b"".join(self.frames)):
            self._end(CloseCode.INVALID_DATA, "a text is UTF-8")
        else:
            super().send_receive_event_to_app()

    def _is_bearable(self) -> bool:
        # What came in the same piece of the network's data as the last straw is not looked at any more.
        if self.transport.is_closing():
            return False
        if self._pace.wait_s(self.loop.time()) > 0:
            self._end(CloseCode.POLICY_VIOLATION, "too many pings or pieces")
            return False
        return True

    def _end(self, code: CloseCode, reason: str) -> None:
        self.conn.fail(code, reason)
        self.transport.write(b"".join(self.conn.data_to_send()))
        self.close_sent = True
        self.transport.close()


def _is_text(data: bytes) -> bool:
    try:
        data.decode()
    except UnicodeDecodeError:
        return False
    return True
