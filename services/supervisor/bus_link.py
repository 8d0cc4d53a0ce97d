"""The supervisor on the bus. It joins beside its loop, since the router is a process that the loop has yet to start."""

import threading
from collections.abc import Callable
from collections.abc import Set as AbstractSet
from dataclasses import dataclass

from models.errors import UserError
from models.messages import codec, topics
from models.messages.addressed import read_health
from models.messages.health import Health, MachineHealth, State, SupervisorHealth
from models.messages.trouble import Trouble, messages_refused
from models.process import Bus, Subscription
from services.supervisor.speaker import Speaker
from services.support.health import HealthReporter, ResourceMeter
from services.support.heartbeat import Beat, read_beat

NAME = "supervisor"
_KEEP = 4
_AGAIN_S = 0.2


def unread_healths(subscription: Subscription) -> tuple[list[Health], int]:
    """What a subscription to health has for us now, and how many messages could not be read: who sends them is silent to us."""
    healths: list[Health] = []
    refused = 0
    while (delivery := subscription.receive(0.0)) is not None:
        try:
            healths.append(read_health(delivery.topic, delivery.payload))
        except codec.CodecError:
            refused += 1
    return healths, refused


def unread_beats(subscription: Subscription) -> tuple[list[tuple[str, Beat]], int]:
    """What a subscription to beats has for us now, by process; and how much came that is no beat."""
    beats: list[tuple[str, Beat]] = []
    refused = 0
    while (delivery := subscription.receive(0.0)) is not None:
        if (beat := read_beat(delivery.payload)) is not None:
            beats.append((topics.process_of(delivery.topic), beat))
        else:
            refused += 1
    return beats, refused


@dataclass(frozen=True)
class _Joined:
    """What the supervisor has on a bus that it joined."""

    bus: Bus
    healths: Subscription
    beats: Subscription
    present: set[str]
    reporter: HealthReporter
    speaker: Speaker


class BusLink:
    """Hears how the processes are and says how the supervisor is; until the bus is there it does neither.

    No method waits for the bus. A router that hangs accepts, and nothing follows: Zenoh then waits for ten seconds, and cannot be
    told to stop. Whoever opens is left behind then, and closes what he still opens.

    Args:
        endpoint: of the bus.
    """

    def __init__(self, endpoint: str) -> None:
        self._endpoint = endpoint
        self._refused = 0
        self._is_client = True
        self._joined: _Joined | None = None
        self._changes = threading.Lock()
        self._stop = self._begin(self._open)

    @property
    def present(self) -> AbstractSet[str]:
        """The processes that are at work: got ready, and on the bus."""
        joined = self._joined
        return frozenset() if joined is None else joined.present

    @property
    def routes(self) -> bool:
        """Whether everybody is heard through us."""
        return not self._is_client and self._joined is not None

    def route(self) -> None:
        """Be the router from now on: the process that was it is given up, and without one nobody hears that."""
        if not self._is_client:
            return
        self._leave()
        self._is_client = False
        self._stop = self._begin(self._open_router)

    def heard(self) -> list[Health]:
        """What has come in since the last call."""
        if self._joined is None:
            return []
        healths, refused = unread_healths(self._joined.healths)
        self._refused += refused
        return healths

    def beats(self) -> list[tuple[str, Beat]]:
        """The processes whose loops have said since the last call that they go round, or that they end."""
        if self._joined is None:
            return []
        beats, refused = unread_beats(self._joined.beats)
        self._refused += refused
        return beats

    def say(
        self, troubles: tuple[Trouble, ...], absent: dict[str, Trouble], machine: MachineHealth | None, supervisor: SupervisorHealth
    ) -> None:
        """Once a second, publish how the box is held together.

        Args:
            troubles: what is being mended, or is wrong with the machine; makes the state "degraded".
            absent: why, by name, processes are not there, for which nobody else speaks now; one that is given up makes it "failed".
            machine: its newest measurement.
            supervisor: what became of the processes.
        """
        joined = self._joined
        if joined is None or joined.speaker.busy or not joined.reporter.due():
            return
        refused, self._refused = self._refused, 0
        troubles = (*troubles, messages_refused(refused)) if refused else troubles
        given_up = tuple(
            Trouble("given_up", f"{name} is given up: {trouble.words}")
            for name, trouble in absent.items()
            if trouble.code == "given_up"
        )
        state: State = "failed" if given_up else "degraded" if troubles else "ok"

        def words() -> None:
            own = joined.reporter.report(state, (*given_up, *troubles), machine=machine, supervisor=supervisor)
            for name, trouble in absent.items():
                message = Health(name, own.pid, own.t_ns, "failed", (trouble,), cpu_cores=0.0, rss_mib=0.0)
                joined.bus.publish(topics.health(name), codec.encode(message))

        joined.speaker.say(words)

    def close(self) -> None:
        """Leave the bus."""
        self._leave()

    def _begin(self, opener: Callable[[threading.Event], None]) -> threading.Event:
        stop = threading.Event()
        # No daemon: one that comes back from Zenoh while the interpreter ends aborts the process. All have ended by then, so that
        # nobody is left who could keep it.
        threading.Thread(target=opener, args=(stop,), name="bus").start()
        return stop

    def _leave(self) -> None:
        with self._changes:
            self._stop.set()
            joined, self._joined = self._joined, None
        if joined is not None:
            joined.speaker.end()
            joined.bus.close()

    def _open(self, stop: threading.Event) -> None:
        from services.bus.zenoh_bus import BusError, open_client  # noqa: PLC0415 - importing takes time in which processes can start

        # A link may break before all is declared on it. A supervisor that stayed deaf would take everybody for hung.
        while (bus := open_client(self._endpoint, stop)) is not None:
            try:
                self._join(bus, stop)
            except BusError:
                bus.close()
                stop.wait(_AGAIN_S)
            else:
                return

    def _open_router(self, stop: threading.Event) -> None:
        from services.bus.zenoh_bus import BusError, open_router  # noqa: PLC0415 - as above

        while not stop.is_set():
            try:
                bus = open_router(self._endpoint)
            except UserError:  # What the dead process held is not free yet.
                stop.wait(_AGAIN_S)
                continue
            try:
                self._join(bus, stop)
            except BusError:
                bus.close()
            else:
                return

    def _join(self, bus: Bus, stop: threading.Event) -> None:
        """Declare what the supervisor has on a bus, unless `stop` is set: then the bus that it was is not wanted any more."""
        from services.bus.zenoh_bus import BusError  # noqa: PLC0415 - as above

        if stop.is_set():
            bus.close()
            return
        present: set[str] = set()

        def seen(topic: str, alive: bool) -> None:
            (present.add if alive else present.discard)(topics.process_of(topic))

        healths = bus.subscribe(topics.ALL_HEALTH, keep=_KEEP)
        beats = bus.subscribe(topics.ALL_BEATS, keep=1)
        bus.watch_alive(topics.ALL_ALIVE, seen)
        bus.declare_alive(topics.alive(NAME))
        joined = _Joined(bus, healths, beats, present, HealthReporter(NAME, bus, ResourceMeter()), Speaker(BusError))
        with self._changes:
            if not stop.is_set():
                self._joined = joined
                return
        joined.speaker.end()
        bus.close()
