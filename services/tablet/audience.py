"""The tablets that watch: one session each, none of which can hold up another or the box."""

import asyncio
from collections.abc import Callable

from pydantic import ValidationError
from starlette.websockets import WebSocket, WebSocketDisconnect

from services.tablet.credit import CreditError, NewestFirst
from services.tablet.messages import CLIENT_MESSAGE, Ack, Ping, Pong, Wish
from services.tablet.pace import Pace

MOTION_CREDIT = 2
STATUS_CREDIT = 1
MAX_CLIENTS = 50
MAX_OF_ONE_ADDRESS = 40
"""Behind one address may be a school's proxy; but nobody alone keeps all others out."""
READ_HZ = 120
"""Messages of a client that are read a second: a page answers every figure and status, at most about forty."""
READ_BURST = 120


class Session:
    """One connected client: two lanes and the list of attempts to it; its acknowledgements, wishes and pings back.

    Args:
        socket: that it has opened.
        clock_ns: CLOCK_MONOTONIC.
        reject: told of a message that cannot be understood.
        wish: told what somebody at the client wants of the box.
    """

    def __init__(
        self,
        socket: WebSocket,
        clock_ns: Callable[[], int],
        reject: Callable[[], None],
        wish: Callable[[Wish], None],
    ) -> None:
        self._socket = socket
        self._clock_ns = clock_ns
        self._reject = reject
        self._wish = wish
        self._motions: NewestFirst[bytes] = NewestFirst(MOTION_CREDIT)
        self._statuses: NewestFirst[str] = NewestFirst(STATUS_CREDIT)
        # Whole each time: the newest is all that a client needs, and few come.
        self._attempts: str | None = None
        self._ping: Ping | None = None
        self._work = asyncio.Event()
        self._pace = Pace(READ_HZ, READ_BURST)

    def offer_motion(self, frame: bytes) -> None:
        """Have a packed motion frame sent as soon as the client has credit."""
        self._motions.offer(frame)
        self._work.set()

    def offer_status(self, text: str) -> None:
        """Have a status sent as soon as the client has credit."""
        self._statuses.offer(text)
        self._work.set()

    def offer_attempts(self, text: str) -> None:
        """Have the list of attempts sent, in the place of one that waits."""
        self._attempts = text
        self._work.set()

    async def run(self) -> None:
        """Serve the client until it leaves. Its end is the end of the receiving side; sending is cancelled with it."""
        sender = asyncio.create_task(self._send())
        try:
            while True:
                message = await self._socket.receive()
                if message["type"] == "websocket.disconnect":
                    return
                self._receive(message.get("text"))
                if (wait_s := self._pace.wait_s(self._clock_ns() * 1e-9)) > 0:
                    await asyncio.sleep(wait_s)
        finally:
            sender.cancel()
            await asyncio.gather(sender, return_exceptions=True)

    def _receive(self, text: str | None) -> None:
        try:
            message = CLIENT_MESSAGE.validate_json(text or "")
            if isinstance(message, Ack):
                self._motions.acknowledge(message.motions)
                self._statuses.acknowledge(message.statuses)
            elif isinstance(message, Ping):
                self._ping = message
            else:
                self._wish(message)
        except (ValidationError, CreditError):
            self._reject()
        self._work.set()

    async def _send(self) -> None:
        try:
            while True:
                await self._work.wait()
                self._work.clear()
                await self._send_what_may_go()
        except (WebSocketDisconnect, RuntimeError):
            return  # the client left between two sends; `run` learns of it too

    async def _send_what_may_go(self) -> None:
        if self._ping is not None:
            ping, self._ping = self._ping, None
            await self._socket.send_text(Pong(id=ping.id, box_time_us=self._clock_ns() // 1000).model_dump_json())
        # Each take comes directly before its send: what waits may be replaced while an earlier send is held up.
        while (frame := self._motions.take()) is not None:
            await self._socket.send_bytes(frame)
        if (text := self._statuses.take()) is not None:
            await self._socket.send_text(text)
        if self._attempts is not None:
            attempts, self._attempts = self._attempts, None
            await self._socket.send_text(attempts)


class Audience:
    """All sessions. Used from the event loop's thread only."""

    def __init__(self) -> None:
        self._sessions: dict[Session, str] = {}

    def __len__(self) -> int:
        return len(self._sessions)

    def has_room_for(self, address: str) -> bool:
        """Whether one more client from an address may join."""
        addresses = list(self._sessions.values())
        return len(addresses) < MAX_CLIENTS and addresses.count(address) < MAX_OF_ONE_ADDRESS

    async def attend(self, session: Session, address: str) -> None:
        """Serve one client until it leaves."""
        self._sessions[session] = address
        try:
            await session.run()
        finally:
            del self._sessions[session]

    def show_motion(self, frame: bytes) -> None:
        """Offer a motion frame to everyone."""
        for session in self._sessions:
            session.offer_motion(frame)

    def show_status(self, text: str) -> None:
        """Offer a status to everyone."""
        for session in self._sessions:
            session.offer_status(text)

    def show_attempts(self, text: str) -> None:
        """Have the list of attempts sent to everyone."""
        for session in self._sessions:
            session.offer_attempts(text)
