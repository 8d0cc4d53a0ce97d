"""The web application: the page's files, the state over REST, and the socket that carries the live figure."""

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from fastapi import FastAPI, Request, Response, WebSocket
from fastapi.staticfiles import StaticFiles
from pydantic.json_schema import models_json_schema

from models.messages.feedback import ANY, ActivityRequest, Feedback
from models.messages.health import Health
from models.messages.motion import Motion
from models.process import EVALUATION
from services.tablet import metrics, motion_frame, teaching_routes
from services.tablet.attempts import Attempts
from services.tablet.audience import Audience, Session
from services.tablet.messages import Ack, Attempt, Choose, Ping, Pong, Status, Teaching
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


NOTHING_TAUGHT = Teaching(languages=[], actions={})


class TabletServer:
    """The room's state and the clients that watch it, joined. Used from the event loop's thread only.

    Args:
        room: its state.
        clock_ns: CLOCK_MONOTONIC.
        teaching: what can be chosen, and the words of it.
        ask: takes a choice to the evaluation.
    """

    def __init__(
        self,
        room: RoomState,
        clock_ns: Callable[[], int],
        teaching: Teaching = NOTHING_TAUGHT,
        ask: Callable[[ActivityRequest], None] = lambda _: None,
    ) -> None:
        self.room = room
        self.audience = Audience()
        self.attempts = Attempts()
        self.teaching = teaching
        self._ask = ask
        self._chosen: ActivityRequest | None = None
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
        """A process said how it is. Which action is asked for is shown at once: somebody is waiting for it."""
        asked = self.room.asked
        self.room.receive_health(health, self._clock_ns())
        if self.room.asked != asked:
            self.show_status()

    def receive_feedback(self, feedback: Feedback) -> None:
        """An attempt ended: keep it and show it to everyone."""
        attempt = self.attempts.take(feedback)
        if attempt is not None:
            self.audience.show_attempt(attempt.model_dump_json())

    def choose(self, activity: str | None) -> None:
        """A tablet says what pupils shall do; None for whichever it is."""
        if activity is not None and activity not in self.teaching.actions:
            self._reject_client_message()
            return
        self._chosen = ActivityRequest(activity or ANY)
        self._ask(self._chosen)

    def set_alive(self, process: str, alive: bool) -> None:
        """A process joined or left the bus. Everyone is told soon: an outage may end before the next status is due."""
        self.room.set_alive(process, alive, self._clock_ns())
        if process == EVALUATION and alive and self._chosen is not None:
            self._ask(self._chosen)  # It was started again, and begins with what the site file says.
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
        return Session(socket, self._clock_ns, self._reject_client_message, self.choose)

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

    app.include_router(teaching_routes.routes(server.attempts, server.teaching))

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
        for attempt in server.attempts.shown:
            session.offer_attempt(attempt.model_dump_json())
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
            (Attempt, "serialization"),
            (Ack, "validation"),
            (Choose, "validation"),
            (Ping, "validation"),
        ]
        _, definitions = models_json_schema(modes, ref_template="#/components/schemas/{model}")
        document.setdefault("components", {}).setdefault("schemas", {}).update(definitions["$defs"])
        return document

    app.openapi = openapi  # type: ignore[method-assign]  # FastAPI's documented way to extend the description
