"""The web application: the page's files, the state over REST, and the socket that carries the live figure."""

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from fastapi import FastAPI, Request, Response, WebSocket
from fastapi.staticfiles import StaticFiles
from pydantic.json_schema import models_json_schema

from models.messages.health import Health
from models.messages.motion import Motion
from services.tablet import metrics, motion_frame
from services.tablet.audience import Audience, Session
from services.tablet.messages import Ack, Ping, Pong, Status
from services.tablet.room_state import RoomState

STATUS_PERIOD_S = 0.5
TOGETHER_S = 0.05
"""Tokens that go together are told together: the first that the router's end takes along would read as a fault of its own."""

_HEADERS = {
    # The page loads nothing from elsewhere and nobody may frame it: the box works without internet and calls nobody.
    "Content-Security-Policy": "default-src 'self'; img-src 'self' data:; frame-ancestors 'none'; base-uri 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
}
_POLICY_VIOLATION = 1008
_TRY_AGAIN_LATER = 1013


class TabletServer:
    """The room's state and the clients that watch it, joined. Used from the event loop's thread only."""

    def __init__(self, room: RoomState, clock_ns: Callable[[], int]) -> None:
        self.room = room
        self.audience = Audience()
        self._clock_ns = clock_ns
        self._soon: asyncio.TimerHandle | None = None

    def receive_motion(self, motion: Motion) -> None:
        """A live motion arrived: show it to everyone."""
        now_ns = self._clock_ns()
        try:
            frame = motion_frame.pack(motion_frame.from_motion(motion, now_ns))
        except motion_frame.MotionFrameError:
            self.reject_bus_message()
            return
        self.room.receive_motion(motion, now_ns)
        self.audience.show_motion(frame)

    def receive_health(self, health: Health) -> None:
        """A process said how it is."""
        self.room.receive_health(health, self._clock_ns())

    def set_alive(self, process: str, alive: bool) -> None:
        """A process joined or left the bus. Everyone is told soon: an outage may end before the next status is due."""
        self.room.set_alive(process, alive, self._clock_ns())
        if self._soon is None:
            self._soon = asyncio.get_running_loop().call_later(TOGETHER_S, self._show_presence)

    def reject_bus_message(self) -> None:
        """A message could not be read."""
        self.room.rejected_bus_messages += 1

    def status(self) -> Status:
        """The room now."""
        return self.room.status(self._clock_ns(), len(self.audience))

    def healths(self) -> list[Health]:
        """What each process that is heard says of itself."""
        return self.room.healths(self._clock_ns())

    def session(self, socket: WebSocket) -> Session:
        """A session for a client whose malformed messages are counted here."""
        return Session(socket, self._clock_ns, self._reject_client_message)

    def show_status(self) -> None:
        """Show the room's state to everyone."""
        self.audience.show_status(self.status().model_dump_json())

    def _show_presence(self) -> None:
        self._soon = None
        self.show_status()

    async def show_statuses(self) -> None:
        """Show the room's state to everyone twice a second, for ever."""
        while True:
            self.show_status()
            await asyncio.sleep(STATUS_PERIOD_S)

    def _reject_client_message(self) -> None:
        self.room.rejected_client_messages += 1


def create_app(server: TabletServer, page: Path | None) -> FastAPI:
    """The application.

    Args:
        server: state and clients.
        page: folder of the built page; None serves the interfaces alone.
    """

    # No interactive documentation: its page would load scripts from another host.
    app = FastAPI(
        title="KineBox tablet server",
        version="1",
        docs_url=None,
        redoc_url=None,
        openapi_url="/api/openapi.json",
    )

    @app.middleware("http")
    async def harden(request: Request, call_next: Callable[[Request], Awaitable[Response]]) -> Response:
        response = await call_next(request)
        response.headers.update(_HEADERS)
        # Built files carry a hash of their content in their names; everything else may change with the next update.
        immutable = request.url.path.startswith("/assets/") and response.status_code == 200
        response.headers["Cache-Control"] = "public, max-age=31536000, immutable" if immutable else "no-cache"
        return response

    @app.get("/api/status")
    async def read_status() -> Status:
        """The room now: cameras, rates, latency, failures."""
        return server.status()

    @app.get("/metrics", include_in_schema=False)
    async def read_metrics() -> Response:
        """The room in Prometheus's text format, see docs/metrics.md."""
        return Response(metrics.render(server), media_type=metrics.CONTENT_TYPE)

    @app.websocket("/ws")
    async def watch(socket: WebSocket) -> None:
        if not _same_origin(socket):
            await socket.close(_POLICY_VIOLATION, "this page is not the box's")
            return
        await socket.accept()
        if server.audience.full:
            await socket.close(_TRY_AGAIN_LATER, "too many tablets")
            return
        session = server.session(socket)
        session.offer_status(server.status().model_dump_json())
        await server.audience.attend(session)

    if page is not None:
        app.mount("/", StaticFiles(directory=page, html=True), name="page")
    _describe_socket(app)
    return app


def _same_origin(socket: WebSocket) -> bool:
    """A browser names the page that opens a socket; only the box's own page may. Other programs send no origin."""
    origin = socket.headers.get("origin")
    return origin is None or urlsplit(origin).netloc == socket.headers.get("host")


def _describe_socket(app: FastAPI) -> None:
    """Add the socket's messages to the OpenAPI description, which leaves sockets out, so that the page's types cover them."""
    describe = app.openapi

    def openapi() -> dict[str, Any]:
        document = describe()
        modes: list[tuple[type[Any], Any]] = [
            (Status, "serialization"),
            (Pong, "serialization"),
            (Ack, "validation"),
            (Ping, "validation"),
        ]
        _, definitions = models_json_schema(modes, ref_template="#/components/schemas/{model}")
        document.setdefault("components", {}).setdefault("schemas", {}).update(definitions["$defs"])
        return document

    app.openapi = openapi  # type: ignore[method-assign]  # FastAPI's documented way to extend the description
