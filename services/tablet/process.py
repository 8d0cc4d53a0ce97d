"""The tablet server's process: takes motions and health from the bus, serves the page."""

import asyncio
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

import structlog
import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol

from models.config.site import TabletConfig
from models.errors import UserError
from models.messages import codec, topics
from models.messages.addressed import read_health
from models.messages.attempts import AttemptsBegin, FeedbackRequest, RememberedFeedback
from models.messages.feedback import ActivityRequest, Feedback
from models.messages.motion import Motion
from models.messages.pupil import PupilCorrections, PupilTurn
from models.messages.trouble import messages_refused
from models.process import Bus, Delivery, ProcessContext, Subscription
from services.support import listening
from services.support.health import PERIOD_S, HealthReporter
from services.tablet.door import Door, places
from services.tablet.page import PAGE, require_page
from services.tablet.page_socket import PageSocket
from services.tablet.room_state import RoomState
from services.tablet.server import TabletServer, Told, create_app
from services.tablet.taught import AGAIN_AFTER_S, Taught

_RECEIVE_TIMEOUT_S = 0.1
_SHUTDOWN_S = 1
_BEAT_S = 0.1
_KEEP = 2
_MAX_CLIENT_MESSAGE_BYTES = 4096

log = structlog.get_logger()


def main(context: ProcessContext) -> None:
    """Serve the page until `context.stop` is set.

    Raises:
        UserError: the page is not built, or the port cannot be listened on.
        Exception: what one of the server's parts failed with; without it the page would show a past for ever.
    """
    require_page(PAGE)
    site = context.site
    taught = Taught(context.data, site.evaluation)
    listener = listen(site.tablet)
    cameras = tuple(camera.name for camera in site.cameras)
    room = RoomState(site.name, cameras, site.fusion.live_hz, time.monotonic_ns(), context.playback)
    server = TabletServer(room, time.monotonic_ns, taught.words, lambda told: _tell(context.bus, told))
    try:
        asyncio.run(_serve(context, server, listener, taught))
    finally:
        listener.close()


def listen(config: TabletConfig) -> socket.socket:
    """Bind the page's port, so that a port that is taken is found before anything is started.

    Raises:
        UserError: the port is taken, forbidden, or the address is none of this machine's.
    """
    where = f"tablet: cannot listen on {config.host} port {config.port}"
    try:
        return listening.listen(config.host, config.port)
    except listening.NoAddressError as error:
        raise UserError(f"{where}: {error.strerror}; correct 'host' under [tablet] in the site file") from error
    except OSError as error:
        remedy = "end the program that uses it, or set another 'port' under [tablet] in the site file"
        raise UserError(f"{where}: {error.strerror}; {remedy}") from error


def _tell(bus: Bus, told: Told) -> None:
    match told:
        case ActivityRequest():
            bus.publish(topics.activity_request(), codec.encode(told))
        case PupilTurn():
            bus.publish(topics.pupil_turn(), codec.encode(told))
        case PupilCorrections():
            bus.publish(topics.pupil_corrections(), codec.encode(told))
        case AttemptsBegin():
            bus.publish(topics.attempts_begin(), codec.encode(told))
        case FeedbackRequest():
            bus.publish(topics.feedback_request(), codec.encode(told))


class _Uvicorn(uvicorn.Server):
    """Uvicorn that leaves signals to the command line, which sets `context.stop`, and connections to the `Door`."""

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        yield

    def protocol(self) -> asyncio.Protocol:
        """Serves one connection, as those do that Uvicorn lets in itself."""
        return H11Protocol(self.config, self.server_state, app_state={})


async def _serve(context: ProcessContext, server: TabletServer, listener: socket.socket, taught: Taught) -> None:
    web = _Uvicorn(
        uvicorn.Config(
            create_app(server, PAGE),
            ws_per_message_deflate=False,  # frames of 206 bytes gain nothing and cost CPU
            ws_max_size=_MAX_CLIENT_MESSAGE_BYTES,
            timeout_graceful_shutdown=_SHUTDOWN_S,
            log_config=None,
            access_log=False,
            server_header=False,
            http=H11Protocol,
            ws=PageSocket,
            lifespan="off",
            # Whoever sends what cannot be read is answered so; a line of the log for each of them would be a flood.
            log_level="error",
        )
    )
    door = Door(listener, web.protocol, places())
    loop = asyncio.get_running_loop()

    def hand_over(action: Callable[[], None]) -> None:
        # The bus may outlive this server, and its news of tokens with it: nobody is left to tell then.
        with suppress(RuntimeError):
            loop.call_soon_threadsafe(action)

    def seen(topic: str, alive: bool) -> None:
        hand_over(lambda: server.set_alive(topics.process_of(topic), alive))

    def end(part: "asyncio.Task[None]") -> None:
        web.should_exit = True
        entrance.cancel()
        if not part.cancelled() and (error := part.exception()) is not None:
            log.error("a part of the server failed", part=part.get_name(), error=repr(error))

    heard = (topics.motion("live"), topics.feedback(), topics.remembered_feedback(), topics.ALL_HEALTH)
    subscription = context.bus.subscribe(*heard, keep=_KEEP)
    context.bus.watch_alive(topics.ALL_ALIVE, seen)
    context.bus.declare_alive(topics.alive(context.name))
    receiver = asyncio.create_task(asyncio.to_thread(_receive, context, subscription, server, hand_over), name="bus")
    entrance = asyncio.create_task(door.let_in(), name="door")
    endless = (
        asyncio.create_task(server.show_statuses(), name="statuses"),
        asyncio.create_task(_publish_health(context, server, taught), name="health"),
        asyncio.create_task(_read_again(taught, server), name="words"),
        asyncio.create_task(_beat(context), name="beat"),
        asyncio.create_task(door.show_out(), name="connections"),
        entrance,
    )
    for part in (receiver, *endless):
        part.add_done_callback(end)
    try:
        await web.serve(sockets=[])  # The door has the listener.
    finally:
        context.stop.set()
        for part in endless:
            part.cancel()
        ends = await asyncio.gather(receiver, *endless, return_exceptions=True)
        subscription.close()
    for error in ends:
        if isinstance(error, Exception):
            raise error


def _receive(
    context: ProcessContext,
    subscription: Subscription,
    server: TabletServer,
    hand_over: Callable[[Callable[[], None]], None],
) -> None:
    """Bus to event loop, in a thread of its own, until the process shall stop."""
    while not context.stop.is_set():
        delivery = subscription.receive(_RECEIVE_TIMEOUT_S)
        if delivery is not None:
            hand_over(decoded(delivery, server))


def decoded(delivery: Delivery, server: TabletServer) -> Callable[[], None]:
    """What the event loop shall do about a delivery; decoding happens here, in the caller's thread."""
    try:
        if delivery.topic == topics.motion("live"):
            motion = codec.decode(delivery.payload, Motion)
            return lambda: server.receive_motion(motion)
        if delivery.topic == topics.feedback():
            feedback = codec.decode(delivery.payload, Feedback)
            return lambda: server.receive_feedback(feedback)
        if delivery.topic == topics.remembered_feedback():
            remembered = codec.decode(delivery.payload, RememberedFeedback)
            return lambda: server.receive_remembered(remembered)
        health = read_health(delivery.topic, delivery.payload)
        return lambda: server.receive_health(health)
    except codec.CodecError:
        return server.reject_bus_message


async def _beat(context: ProcessContext) -> None:
    """Say that the event loop goes round."""
    while True:
        context.beat()
        await asyncio.sleep(_BEAT_S)


async def _read_again(taught: Taught, server: TabletServer) -> None:
    """Take the school's words as soon as somebody has mended them; those that could be read at the start are kept to."""
    while True:
        await asyncio.sleep(AGAIN_AFTER_S)
        if taught.troubles:
            await asyncio.to_thread(taught.read)
            server.teach(taught.words)


async def _publish_health(context: ProcessContext, server: TabletServer, taught: Taught) -> None:
    """Say how this process is, once a second: degraded if words cannot be read, or, since it last said so, messages."""
    reporter = HealthReporter(context.name, context.bus, context.resources)
    counted = 0
    while True:
        rejected, counted = server.room.rejected_bus_messages - counted, server.room.rejected_bus_messages
        troubles = (*taught.troubles, *([messages_refused(rejected)] if rejected else []))
        reporter.report("degraded" if troubles else "ok", troubles)
        await asyncio.sleep(PERIOD_S)
