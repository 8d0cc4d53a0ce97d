"""How the supervisor joins a real bus whose link breaks in between."""

import threading
from collections.abc import Callable
from typing import Any

import pytest
import zenoh

from models.messages import codec, topics
from models.messages.health import Health, SupervisorHealth
from models.messages.trouble import Trouble
from services.bus import zenoh_bus
from services.supervisor.bus_link import BusLink
from tests.integration.waiting import DEADLINE_S, until
from tests.ports import free_port

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


def test_a_supervisor_in_the_place_of_a_router_that_is_given_up_hears_all_and_is_heard() -> None:
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    router = zenoh_bus.open_router(endpoint)
    camera = zenoh_bus.open_client(endpoint, threading.Event())
    assert camera is not None
    camera.declare_alive(topics.alive("edge-a"))
    said = camera.subscribe(topics.health("fusion"), keep=1)
    link = BusLink(endpoint)
    edge = Health("edge-a", 2, 2, "ok", (), 0.0, 0.0)
    try:
        until(lambda: "edge-a" in link.present, "who is present to be known")
        router.close()
        assert not link.routes
        link.route()
        link.route()  # once is enough

        def hears() -> bool:
            camera.publish(topics.health("edge-a"), codec.encode(edge))
            return edge in link.heard()

        until(hears, "the supervisor to hear the others again")
        until(lambda: "edge-a" in link.present, "who is present to be known again")
        assert link.routes
        heard: list[Health] = []

        def is_heard() -> bool:
            link.say((), {"fusion": Trouble("given_up", "ended 6 times")}, None, OWN)
            if (delivery := said.receive(0.05)) is not None:
                heard.append(codec.decode(delivery.payload, Health))
            return bool(heard)

        until(is_heard, "the others to hear that fusion is given up")
        assert (heard[0].state, heard[0].reason) == ("failed", "ended 6 times")
    finally:
        link.close()
        camera.close()


def test_a_supervisor_that_never_met_a_router_can_be_it() -> None:
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    link = BusLink(endpoint)
    link.route()
    try:
        camera = zenoh_bus.open_client(endpoint, threading.Event())
        assert camera is not None
        camera.declare_alive(topics.alive("edge-a"))
        until(lambda: "edge-a" in link.present, "who is present to be known")
        camera.close()
    finally:
        link.close()


class SilentRouter:
    """A router whose port accepts and says nothing: who opens a client hangs until `goes_on`, and has one then all the same."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.asked, self.goes_on, self.closed = threading.Event(), threading.Event(), threading.Event()
        self._others = zenoh_bus.open_router(f"tcp/127.0.0.1:{free_port()}")
        monkeypatch.setattr(zenoh_bus, "open_client", self._open)

    def _open(self, _endpoint: str, _stop: threading.Event) -> Any:
        self.asked.set()
        self.goes_on.wait()
        truly_close = self._others.close

        def close() -> None:
            truly_close()
            self.closed.set()

        self._others.close = close  # type: ignore[method-assign]
        return self._others

    def end(self) -> None:
        """Answer at last, and see that nothing stays open."""
        self.goes_on.set()
        assert self.closed.wait(DEADLINE_S), "the session that opened late stays open"


def returns(call: Callable[[], object]) -> bool:
    """Whether a call returns, while what it may wait for does not come."""
    caller = threading.Thread(target=call, daemon=True)
    caller.start()
    caller.join(DEADLINE_S)
    return not caller.is_alive()


def test_the_end_of_the_box_does_not_wait_for_a_router_that_hangs(monkeypatch: pytest.MonkeyPatch) -> None:
    router = SilentRouter(monkeypatch)
    link = BusLink("tcp/127.0.0.1:1")
    try:
        assert router.asked.wait(DEADLINE_S)
        assert returns(link.close), "close() waits for the router"
    finally:
        router.end()


def test_the_supervisor_takes_the_place_of_a_router_that_never_answered_without_waiting_for_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    open_client = zenoh_bus.open_client
    router = SilentRouter(monkeypatch)
    link = BusLink(endpoint)
    try:
        assert router.asked.wait(DEADLINE_S)
        assert returns(link.route), "route() waits for the router"
        camera = open_client(endpoint, threading.Event())
        assert camera is not None
        camera.declare_alive(topics.alive("edge-a"))
        until(lambda: "edge-a" in link.present, "who is present to be known")
        router.end()
        assert link.routes
        assert "edge-a" in link.present, "the session that opened late took the router's place"
        camera.close()
    finally:
        router.goes_on.set()
        link.close()


def test_a_session_that_holds_up_who_publishes_does_not_hold_up_the_supervisor(monkeypatch: pytest.MonkeyPatch) -> None:
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    router = zenoh_bus.open_router(endpoint)
    router.declare_alive(topics.alive("fusion"))
    said = router.subscribe(topics.health("supervisor"), keep=1)
    truly, asked, goes_on = zenoh_bus.ZenohBus.publish, threading.Event(), threading.Event()

    def publish(bus: Any, topic: str, payload: bytes) -> None:
        if topic == topics.health("supervisor"):
            asked.set()
            goes_on.wait()
        truly(bus, topic, payload)

    monkeypatch.setattr(zenoh_bus.ZenohBus, "publish", publish)
    link = BusLink(endpoint)
    try:
        until(lambda: "fusion" in link.present, "who is present to be known")

        def speak() -> None:
            link.say((), {}, None, OWN)

        assert returns(speak), "say() waits for the session"
        assert asked.wait(DEADLINE_S)
        assert returns(speak), "say() waits for what was said before"
        assert returns(link.heard)
        assert said.receive(0.0) is None
        goes_on.set()
        until(lambda: said.receive(0.05) is not None, "what was held up")
    finally:
        goes_on.set()
        link.close()
        router.close()
