"""The web application: the page's files, the state over REST, and the socket that carries the live figure."""

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path

from fastapi import FastAPI, Request, Response, WebSocket
from fastapi.staticfiles import StaticFiles

from models.messages.attempts import AttemptsBegin, FeedbackRequest, RememberedFeedback
from models.messages.feedback import ANY, ActivityRequest, Feedback
from models.messages.health import EvaluationHealth, Health, RecorderHealth
from models.messages.motion import Motion
from models.messages.pupil import NOBODY, PupilCorrection, PupilCorrections, PupilTurn
from models.process import EVALUATION, RECORDER
from services.tablet import metrics, motion_frame, teaching_routes
from services.tablet.attempts import Attempts
from services.tablet.audience import Audience, Session
from services.tablet.lesson_so_far import LessonSoFar
from services.tablet.messages import AttemptList, Choose, Correction, Status, Teaching, Turn, Wish
from services.tablet.room_state import RoomState
from services.tablet.socket_description import describe_socket
from services.tablet.teaching_words import revision

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

AGREED_NS = 1_000_000_000
"""A choice has reached the evaluation by then, or is lost: what it says afterwards is what counts."""

Told = ActivityRequest | PupilTurn | PupilCorrections | AttemptsBegin | FeedbackRequest
"""What tablets have to say to the other processes."""
NOTHING_TAUGHT = Teaching(languages=[], actions={})


class TabletServer:
    """The room's state and the clients that watch it, joined. Used from the event loop's thread only.

    Args:
        room: its state.
        clock_ns: CLOCK_MONOTONIC.
        teaching: what can be chosen, and the words of it.
        tell: takes what tablets say to the bus.

    Attributes:
        listed: the list of attempts as every page has it; None while the evaluation has yet to tell what it remembers.
    """

    def __init__(
        self,
        room: RoomState,
        clock_ns: Callable[[], int],
        teaching: Teaching = NOTHING_TAUGHT,
        tell: Callable[[Told], None] = lambda _: None,
    ) -> None:
        self.room = room
        self.audience = Audience()
        self._so_far = LessonSoFar(tell, clock_ns())
        self.listed: AttemptList | None = None
        self.teach(teaching)
        self._tell = tell
        self._chosen: ActivityRequest | None = None
        self._chosen_ns = 0
        self._turn = PupilTurn(NOBODY, 0)
        self._recorder: RecorderHealth | None = None
        self._clock_ns = clock_ns
        self._soon: asyncio.TimerHandle | None = None

    @property
    def attempts(self) -> Attempts:
        """Those on the list."""
        return self._so_far.attempts

    def teach(self, teaching: Teaching) -> None:
        """These are the words from now on. Every page asks for them when the next status tells it that they are others."""
        self.teaching, self._teaching_revision = teaching, revision(teaching)

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
        """A process said how it is. Which action is asked for and who is up is shown at once: somebody is waiting for it."""
        asked, now_ns = self.room.asked, self._clock_ns()
        self.room.receive_health(health, now_ns)
        if health.process == EVALUATION and health.evaluation is not None:
            self._agree(health.evaluation, now_ns)
            self._so_far.hear_evaluation(health.evaluation, now_ns)
        if health.process == RECORDER and health.recorder is not None:
            self._so_far.hear_recorder(health.recorder, now_ns)
            self._correct_again(health.recorder)
        if self.room.asked != asked:
            self.show_status()
        if health.process in (EVALUATION, RECORDER):
            self.show_attempts()

    def receive_feedback(self, feedback: Feedback) -> None:
        """An attempt ended: keep it and show it to everyone."""
        self._so_far.take(feedback)
        self.show_attempts()

    def receive_remembered(self, remembered: RememberedFeedback) -> None:
        """The evaluation remembers an attempt."""
        self._so_far.hear_remembered(remembered, self._clock_ns())
        self.show_attempts()

    def wish(self, wish: Wish) -> None:
        """Somebody at a tablet wants something."""
        if isinstance(wish, Choose):
            self.choose(wish.activity)
        elif isinstance(wish, Turn):
            self.call(wish.pupil)
        elif isinstance(wish, Correction):
            self.correct(wish.attempt, wish.pupil)
        else:
            self.begin_anew()

    def choose(self, activity: str | None) -> None:
        """A tablet says what pupils shall do; None for whichever it is."""
        if activity is not None and activity not in self.teaching.actions:
            self._reject_client_message()
            return
        self._chosen, self._chosen_ns = ActivityRequest(activity or ANY), self._clock_ns()
        self._tell(self._chosen)

    def call(self, pupil: str | None) -> None:
        """A tablet says who is up; None for nobody who is named."""
        self._turn = PupilTurn(pupil or NOBODY, self._clock_ns())
        self._tell(self._turn)

    def correct(self, attempt: int, pupil: str | None) -> None:
        """A tablet says whose an attempt was after all."""
        if not self.attempts.correct(PupilCorrection(attempt, pupil or NOBODY)):
            self._reject_client_message()
            return
        self._tell(self.attempts.corrections)
        self.show_attempts(unchanged=True)  # Whoever asked for what is so already waits for an answer, too.

    def begin_anew(self) -> None:
        """A tablet says that the list of attempts begins anew. A lesson that may be recorded goes on with its numbers."""
        if not self.room.nothing_recorded(self._clock_ns()):
            self._reject_client_message()
            return
        self._so_far.begin(self._clock_ns())
        self.show_attempts()

    def _agree(self, evaluation: EvaluationHealth, now_ns: int) -> None:
        """Either process may have been started again, or a word have been lost on its way. Of two turns the later one counts."""
        if evaluation.chosen_by == "site":
            if self._chosen is not None:
                self._tell(self._chosen)
        elif now_ns - self._chosen_ns > AGREED_NS:
            self._chosen = ActivityRequest(evaluation.activity)
        said = PupilTurn(evaluation.pupil, evaluation.pupil_since_ns)
        if self._turn.t_ns < said.t_ns <= now_ns:
            self._turn = said
        elif said.t_ns < self._turn.t_ns:
            self._tell(self._turn)

    def _correct_again(self, recorder: RecorderHealth) -> None:
        """What was corrected during an interruption of the lesson is not in it yet."""
        before, self._recorder = self._recorder, recorder
        interrupted = before is not None and before.lesson == recorder.lesson and recorder.gaps > before.gaps
        if interrupted and self.attempts.corrections.corrections:
            self._tell(self.attempts.corrections)

    def set_alive(self, process: str, alive: bool) -> None:
        """A process joined or left the bus. Everyone is told soon: an outage may end before the next status is due."""
        self.room.set_alive(process, alive, self._clock_ns())
        if process == EVALUATION and alive:
            # It was started again, and begins with what the site file says; or the bus was away, and it has not heard the latest.
            if self._chosen is not None:
                self._tell(self._chosen)
            if self.attempts.corrections.corrections:
                self._tell(self.attempts.corrections)
        if self._soon is None:
            self._soon = asyncio.get_running_loop().call_later(TOGETHER_S, self._show_presence)

    def reject_bus_message(self) -> None:
        """A message could not be read."""
        self.room.rejected_bus_messages += 1

    def status(self) -> Status:
        """The room now."""
        return self.room.status(self._clock_ns(), len(self.audience), self._teaching_revision)

    def healths(self) -> list[Health]:
        """What each process that is heard says of itself."""
        return self.room.healths(self._clock_ns())

    def session(self, socket: WebSocket) -> Session:
        """A session for a client whose malformed messages are counted here."""
        return Session(socket, self._clock_ns, self._reject_client_message, self.wish)

    def show_status(self) -> None:
        """Show the room's state to everyone."""
        self.audience.show_status(self.status().model_dump_json())

    def show_attempts(self, *, unchanged: bool = False) -> None:
        """Show the list of attempts to everyone, if it is another one than was shown last, or is to be shown `unchanged`, too."""
        shown = self._so_far.shown(self._clock_ns(), restarted=self.room.restarted)
        if shown is not None and (unchanged or shown != self.listed):
            self.listed = shown
            self.audience.show_attempts(shown.model_dump_json())

    def _show_presence(self) -> None:
        self._soon = None
        self.show_status()

    async def show_statuses(self) -> None:
        """Show the room's state to everyone twice a second, for ever, and the list of attempts once nobody is waited for."""
        while True:
            self.show_status()
            self.show_attempts()
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

    app.include_router(teaching_routes.routes(server.attempts, lambda: server.teaching))

    @app.websocket("/ws")
    async def watch(socket: WebSocket) -> None:
        if not _same_origin(socket):
            await socket.close(_POLICY_VIOLATION, "this page is not the box's")
            return
        await socket.accept()
        if not server.audience.has_room_for(address := socket.client.host if socket.client else ""):
            await socket.close(_TRY_AGAIN_LATER, "too many tablets")
            return
        session = server.session(socket)
        session.offer_status(server.status().model_dump_json())
        if server.listed is not None:
            session.offer_attempts(server.listed.model_dump_json())
        await server.audience.attend(session, address)

    if page is not None:
        app.mount("/", StaticFiles(directory=page, html=True), name="page")
    describe_socket(app)
    return app


def _same_origin(socket: WebSocket) -> bool:
    """A browser names the page that opens a socket; only the box's own page may. Other programs send no origin."""
    origin, host = socket.headers.get("origin"), socket.headers.get("host")
    # Compared as texts: what a stranger writes there need be no address, and is not taken apart.
    return origin is None or origin in (f"http://{host}", f"https://{host}")
