"""The supervisor on the bus. It joins beside its loop, since the router is a process that the loop has yet to start."""

import threading

from models.errors import UserError
from models.messages import codec, topics
from models.messages.addressed import read_health
from models.messages.health import Health, MachineHealth, State, SupervisorHealth
from models.messages.trouble import Trouble, messages_refused
from models.process import Bus, Subscription
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


class BusLink:
    """Hears how the processes are and says how the supervisor is; until the bus is there it does neither.

    Args:
        endpoint: of the bus.
    """

    def __init__(self, endpoint: str) -> None:
        self.present: set[str] = set()
        """The processes that are at work: got ready, and on the bus."""
        self._endpoint = endpoint
        self._refused = 0
        self._stop = threading.Event()
        self._is_client = True
        self._bus: Bus | None = None
        self._subscription: Subscription | None = None
        self._beats: Subscription | None = None
        self._reporter: HealthReporter | None = None
        self._opener = threading.Thread(target=self._open, name="bus", daemon=True)
        self._opener.start()

    @property
    def routes(self) -> bool:
        """Whether everybody is heard through us."""
        return not self._is_client and self._bus is not None

    def route(self) -> None:
        """Be the router from now on: the process that was it is given up, and without one nobody hears that."""
        if not self._is_client:
            return
        self._leave()
        self._is_client = False
        self._stop.clear()
        self._opener = threading.Thread(target=self._open_router, name="bus", daemon=True)
        self._opener.start()

    def heard(self) -> list[Health]:
        """What has come in since the last call."""
        if self._subscription is None:
            return []
        healths, refused = unread_healths(self._subscription)
        self._refused += refused
        return healths

    def beats(self) -> list[tuple[str, Beat]]:
        """The processes whose loops have said since the last call that they go round, or that they end."""
        if self._beats is None:
            return []
        beats, refused = unread_beats(self._beats)
        self._refused += refused
        return beats

    def say(
        self, troubles: tuple[Trouble, ...], failed: dict[str, Trouble], machine: MachineHealth | None, supervisor: SupervisorHealth
    ) -> None:
        """Once a second, publish how the box is held together.

        Args:
            troubles: what is being mended, or is wrong with the machine; makes the state "degraded".
            failed: why, by name, processes are given up, for which nobody else speaks now; makes it "failed".
            machine: its newest measurement.
            supervisor: what became of the processes.
        """
        bus, reporter = self._bus, self._reporter
        if bus is None or reporter is None or not reporter.due():
            return
        refused, self._refused = self._refused, 0
        troubles = (*troubles, messages_refused(refused)) if refused else troubles
        given_up = tuple(Trouble("given_up", f"{name} is given up: {trouble.words}") for name, trouble in failed.items())
        state: State = "failed" if failed else "degraded" if troubles else "ok"
        own = reporter.report(state, (*given_up, *troubles), machine=machine, supervisor=supervisor)
        for name, trouble in failed.items():
            message = Health(name, own.pid, own.t_ns, "failed", (trouble,), cpu_cores=0.0, rss_mib=0.0)
            bus.publish(topics.health(name), codec.encode(message))

    def close(self) -> None:
        """Leave the bus."""
        self._leave()

    def _leave(self) -> None:
        self._stop.set()
        self._opener.join()
        bus, self._bus, self._subscription, self._beats, self._reporter = self._bus, None, None, None, None
        if bus is not None:
            bus.close()
        self.present.clear()

    def _open(self) -> None:
        from services.bus.zenoh_bus import BusError, open_client  # noqa: PLC0415 - importing takes time in which processes can start

        # A link may break before all is declared on it. A supervisor that stayed deaf would take everybody for hung.
        while self._bus is None and (bus := open_client(self._endpoint, self._stop)) is not None:
            try:
                self._join(bus)
            except BusError:
                bus.close()
                self._stop.wait(_AGAIN_S)

    def _open_router(self) -> None:
        from services.bus.zenoh_bus import BusError, open_router  # noqa: PLC0415 - as above

        while self._bus is None and not self._stop.is_set():
            try:
                bus = open_router(self._endpoint)
            except UserError:  # What the dead process held is not free yet.
                self._stop.wait(_AGAIN_S)
                continue
            try:
                self._join(bus)
            except BusError:
                bus.close()

    def _join(self, bus: Bus) -> None:
        subscription = bus.subscribe(topics.ALL_HEALTH, keep=_KEEP)
        beats = bus.subscribe(topics.ALL_BEATS, keep=1)
        bus.watch_alive(topics.ALL_ALIVE, self._seen)
        bus.declare_alive(topics.alive(NAME))
        self._reporter = HealthReporter(NAME, bus, ResourceMeter())
        self._subscription, self._beats, self._bus = subscription, beats, bus

    def _seen(self, topic: str, alive: bool) -> None:
        (self.present.add if alive else self.present.discard)(topics.process_of(topic))
