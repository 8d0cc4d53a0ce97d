"""The bus when processes die or hang: real processes, real signals."""

import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator

import pytest

from models.errors import UserError
from models.process import Bus
from services.bus.zenoh_bus import open_client, open_router
from tests.integration.waiting import until
from tests.ports import free_port

pytestmark = pytest.mark.slow

Start = Callable[[str, str], "subprocess.Popen[str]"]


@pytest.fixture
def endpoint() -> str:
    return f"tcp/127.0.0.1:{free_port()}"


@pytest.fixture
def start(endpoint: str) -> Iterator[Start]:
    """Starts a member of the bus (role, token) and waits until it is ready."""
    members: list[subprocess.Popen[str]] = []

    def start_one(role: str, token: str) -> "subprocess.Popen[str]":
        command = [sys.executable, "-m", "tests.integration.bus_member", role, endpoint, token]
        member = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        members.append(member)
        assert member.stdout is not None
        assert member.stdout.readline() == "ready\n"
        return member

    yield start_one
    for member in members:
        member.kill()
        member.wait()
        assert member.stdout is not None
        member.stdout.close()


def client(endpoint: str) -> Bus:
    bus = open_client(endpoint, threading.Event())
    assert bus is not None
    return bus


def answers(bus: Bus) -> Callable[[], bool]:
    """Whether a question asked now is answered by the other process."""
    subscription = bus.subscribe("gym/answer", keep=8)

    def ask() -> bool:
        bus.publish("gym/ask", b"?")
        return subscription.receive(0.05) is not None

    return ask


def test_the_token_of_a_killed_process_goes(endpoint: str, start: Start) -> None:
    bus = open_router(endpoint)
    seen: list[tuple[str, bool]] = []
    bus.watch_alive("gym/alive/*", lambda topic, alive: seen.append((topic, alive)))
    member = start("client", "gym/alive/edge-a")
    until(lambda: seen == [("gym/alive/edge-a", True)], "the token")
    member.send_signal(signal.SIGKILL)
    until(lambda: seen[-1:] == [("gym/alive/edge-a", False)], "the token of the killed process to go")
    bus.close()


def test_the_token_of_a_hung_process_goes_and_comes_back_with_it(endpoint: str, start: Start) -> None:
    bus = open_router(endpoint)
    seen: list[bool] = []
    bus.watch_alive("gym/alive/*", lambda _topic, alive: seen.append(alive))
    member = start("client", "gym/alive/edge-a")
    until(lambda: seen == [True], "the token")
    member.send_signal(signal.SIGSTOP)
    until(lambda: seen == [True, False], "the token of the hung process to go")
    member.send_signal(signal.SIGCONT)
    until(lambda: seen == [True, False, True], "the token to come back")
    bus.close()


def test_after_the_router_was_killed_subscriptions_and_tokens_work_again(endpoint: str, start: Start) -> None:
    router = start("router", "gym/alive/fusion")
    bus, other = client(endpoint), client(endpoint)
    other.declare_alive("gym/alive/edge-a")
    seen: list[tuple[str, bool]] = []
    bus.watch_alive("gym/alive/*", lambda topic, alive: seen.append((topic, alive)))
    ask = answers(bus)
    until(ask, "an answer of the first router")
    until(lambda: {("gym/alive/fusion", True), ("gym/alive/edge-a", True)} == set(seen), "both tokens")

    seen.clear()
    router.kill()
    until(lambda: {("gym/alive/fusion", False), ("gym/alive/edge-a", False)} == set(seen), "both tokens to go")
    assert not ask()

    seen.clear()
    start("router", "gym/alive/fusion")
    until(ask, "an answer of the second router")
    until(lambda: {("gym/alive/fusion", True), ("gym/alive/edge-a", True)} == set(seen), "both tokens again")
    other.close()
    bus.close()


def test_a_client_waits_for_its_router_and_can_be_told_to_stop_waiting(endpoint: str) -> None:
    stop = threading.Event()
    opened: list[Bus | None] = []
    waiting = threading.Thread(target=lambda: opened.append(open_client(endpoint, stop)))
    waiting.start()
    stop.set()
    waiting.join(30.0)
    assert opened == [None]

    patient = threading.Thread(target=lambda: opened.append(open_client(endpoint, threading.Event())))
    patient.start()
    router = open_router(endpoint)
    patient.join(30.0)
    late = opened[1]
    assert late is not None
    late.close()
    router.close()


def test_a_hung_receiver_does_not_hold_up_the_sender(endpoint: str, start: Start) -> None:
    bus = open_router(endpoint)
    member = start("client", "gym/alive/edge-a")
    ask = answers(bus)
    until(ask, "an answer")
    member.send_signal(signal.SIGSTOP)
    megabyte = bytes(2**20)

    def flood() -> None:
        # More than any socket buffers: without dropping, this would wait for the receiver for ever.
        for _ in range(50):
            bus.publish("gym/ask", megabyte)

    flooding = threading.Thread(target=flood)
    flooding.start()
    flooding.join(60.0)
    assert not flooding.is_alive()
    bus.close()


def test_an_endpoint_that_is_taken_is_named_with_what_to_do(endpoint: str) -> None:
    first = open_router(endpoint)
    with pytest.raises(UserError, match=rf"^bus endpoint {endpoint} is in use already; stop .* or change bus\.endpoint"):
        open_router(endpoint)
    first.close()


def test_an_endpoint_of_another_machine_is_refused() -> None:
    with pytest.raises(UserError, match=r"cannot be listened on"):
        open_router("tcp/192.0.2.77:7447")
