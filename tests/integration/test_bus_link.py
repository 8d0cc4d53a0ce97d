"""How the supervisor joins a real bus whose link breaks in between."""

from typing import Any

import pytest
import zenoh

from models.messages import codec, topics
from models.messages.health import Health, SupervisorHealth
from services.bus import zenoh_bus
from services.supervisor.bus_link import BusLink
from tests.integration.waiting import free_port, until

OWN = SupervisorHealth("test", 1, ())


def test_a_link_that_breaks_while_the_supervisor_joins_does_not_leave_it_deaf(monkeypatch: pytest.MonkeyPatch) -> None:
    truly, failures = zenoh_bus.ZenohBus.declare_alive, [zenoh.ZError("broken"), zenoh.ZError("broken again")]

    def declare_alive(bus: Any, topic: str) -> None:
        if topic == topics.alive("supervisor") and failures:
            raise failures.pop()
        truly(bus, topic)

    monkeypatch.setattr(zenoh_bus.ZenohBus, "declare_alive", declare_alive)
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    router = zenoh_bus.open_router(endpoint)
    said = router.subscribe(topics.health("supervisor"), keep=1)
    router.declare_alive(topics.alive("fusion"))
    link = BusLink(endpoint)
    try:
        until(lambda: "fusion" in link.present, "who is present to be known")

        def speaks() -> bool:
            link.say((), {}, None, OWN)
            return said.receive(0.05) is not None

        until(speaks, "the supervisor to speak")
        fusion = Health("fusion", 1, 1, "ok", (), 0.0, 0.0)

        def hears() -> bool:
            router.publish(topics.health("fusion"), codec.encode(fusion))
            return fusion in link.heard()

        until(hears, "the supervisor to hear")
        assert failures == []
    finally:
        link.close()
        router.close()
