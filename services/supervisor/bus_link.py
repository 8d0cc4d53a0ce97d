"""The supervisor on the bus. It joins beside its loop, since the router is a process that the loop has yet to start."""

import contextlib
import threading
from typing import Literal

from models.messages import codec, topics
from models.messages.addressed import read_health
from models.messages.health import Health, MachineHealth, SupervisorHealth
from models.process import Bus, Subscription
from services.support.health import HealthReporter, ResourceMeter
from services.support.heartbeat import Beat, read_beat

NAME = "supervisor"
_KEEP = 4
_AGAIN_S = 0.2


def unread_healths(subscription: Subscription) -> list[Health]:
    """What a subscription to health has for us now. Who speaks unintelligibly is silent, and treated as such."""
    healths: list[Health] = []
    while (delivery := subscription.receive(0.0)) is not None:
        with contextlib.suppress(codec.CodecError):
            healths.append(read_health(delivery.topic, delivery.payload))
    return healths


def unread_beats(subscription: Subscription) -> list[tuple[str, Beat]]:
    """What a subscription to beats has for us now, by process. What is no beat is not counted as one."""
    beats: list[tuple[str, Beat]] = []
    while (delivery := subscription.receive(0.0)) is not None:
        if (beat := read_beat(delivery.payload)) is not None:
            beats.append((topics.process_of(delivery.topic), beat))
    return beats


class BusLink:
    """Hears how the processes are and says how the supervisor is; until the bus is there it does neither.

    Args:
        endpoint: of the bus.
    """

    def __init__(self, endpoint: str) -> None:
        self.present: set[str] = set()
        """The processes that are at work: got ready, and on the bus."""
        self._endpoint = endpoint
        self._stop = threading.Event()
        self._bus: Bus | None = None
        self._subscription: Subscription | None = None
        self._beats: Subscription | None = None
        self._reporter: HealthReporter | None = None
        self._opener = threading.Thread(target=self._open, name="bus", daemon=True)
        self._opener.start()

    def heard(self) -> list[Health]:
        """What has come in since the last call."""
        return [] if self._subscription is None else unread_healths(self._subscription)

    def beats(self) -> list[tuple[str, Beat]]:
        """The processes whose loops have said since the last call that they go round, or that they end."""
        return [] if self._beats is None else unread_beats(self._beats)

    def say(
        self, fault: str, trouble: str, failed: dict[str, str], machine: MachineHealth | None, supervisor: SupervisorHealth
    ) -> None:
        """Once a second, publish how the box is held together.

        Args:
            fault: what is given up; makes the state "failed".
            trouble: what is being mended, or is wrong with the machine; makes it "degraded".
            failed: reasons by name of the processes that are given up, for which nobody else speaks now.
            machine: its newest measurement.
            supervisor: what became of the processes.
        """
        bus, reporter = self._bus, self._reporter
        if bus is None or reporter is None or not reporter.due():
            return
        state: Literal["ok", "degraded", "failed"] = "failed" if fault else "degraded" if trouble else "ok"
        own = reporter.report(state, fault or trouble, machine=machine, supervisor=supervisor)
        for name, reason in failed.items():
            message = Health(name, own.pid, own.t_ns, "failed", reason, cpu_cores=0.0, rss_mb=0.0)
            bus.publish(topics.health(name), codec.encode(message))

    def close(self) -> None:
        """Leave the bus."""
        self._stop.set()
        self._opener.join()
        if self._bus is not None:
            self._bus.close()

    def _open(self) -> None:
        from services.bus.zenoh_bus import BusError, open_client  # noqa: PLC0415 - importing takes time in which processes can start

        # A link may break before all is declared on it. A supervisor that stayed deaf would take everybody for hung.
        while self._bus is None and (bus := open_client(self._endpoint, self._stop)) is not None:
            try:
                self._join(bus)
            except BusError:
                bus.close()
                self._stop.wait(_AGAIN_S)

    def _join(self, bus: Bus) -> None:
        subscription = bus.subscribe(topics.ALL_HEALTH, keep=_KEEP)
        beats = bus.subscribe(topics.ALL_BEATS, keep=1)
        bus.watch_alive(topics.ALL_ALIVE, self._seen)
        bus.declare_alive(topics.alive(NAME))
        self._reporter = HealthReporter(NAME, bus, ResourceMeter())
        self._subscription, self._beats, self._bus = subscription, beats, bus

    def _seen(self, topic: str, alive: bool) -> None:
        (self.present.add if alive else self.present.discard)(topics.process_of(topic))
