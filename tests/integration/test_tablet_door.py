"""The page's server over real sockets, and somebody on the network who means it no good."""

import json
import logging
import re
import resource
import socket
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

import httpx
import psutil
import pytest
from websockets.sync.client import ClientConnection, connect

from services.tablet import door, patience, process
from tests.browser.room import Room
from tests.integration.waiting import until

HALF_A_REQUEST = b"GET / HTTP/1.1\r\nHost: x\r\n"
SOCKET = (
    b"Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
)
GENEROUS_S = 30.0

pytestmark = pytest.mark.slow


@pytest.fixture
def room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Room]:
    """A room whose page is one line, and a door that is looked after more often than it need be."""
    (tmp_path / "index.html").write_text("<title>page</title>", encoding="utf-8")
    (tmp_path / "large.bin").write_bytes(bytes(20_000_000))
    monkeypatch.setattr(process, "PAGE", tmp_path)
    monkeypatch.setattr(door, "_LOOK_S", 0.05)
    with Room() as made:
        yield made


def caller(room: Room, said: bytes = b"", of: str = "127.0.0.1") -> socket.socket:
    made = socket.create_connection(("127.0.0.1", room.port), timeout=GENEROUS_S, source_address=(of, 0))
    made.sendall(said)
    return made


def is_ended(connection: socket.socket) -> bool:
    """Whether the server has ended it by now."""
    connection.setblocking(False)
    try:
        while connection.recv(65536):
            pass
    except BlockingIOError:
        return False
    except ConnectionError:
        pass
    return True


@contextmanager
def crowd(room: Room, count: int) -> Iterator[list[socket.socket]]:
    with ExitStack() as stack:
        made = [stack.enter_context(caller(room)) for _ in range(count)]
        for connection in made:
            # Whoever was turned away cannot say anything any more.
            with suppress(ConnectionError):
                connection.sendall(HALF_A_REQUEST)
        yield made


def watch(room: Room) -> ClientConnection:
    return connect(room.page.replace("http", "ws") + "ws", compression=None, proxy=None)


def see_motions(tablet: ClientConnection, count: int) -> None:
    """A tablet that is connected sees so many figures more."""
    motions = statuses = 0
    while motions < count:
        message = tablet.recv(timeout=GENEROUS_S)
        if isinstance(message, bytes):
            motions += 1
        else:
            statuses += json.loads(message)["type"] == "status"
        tablet.send(json.dumps({"type": "ack", "motions": motions, "statuses": statuses}))


def test_half_open_connections_of_one_address_take_neither_the_tablets_nor_anybody_elses_places(
    room: Room, capsys: pytest.CaptureFixture[str], caplog: pytest.LogCaptureFixture
) -> None:
    with watch(room) as tablet, crowd(room, 400) as connections:
        until(lambda: sum(map(is_ended, connections)) >= 400 - door.OF_ONE_ADDRESS, "those that are too many to be turned away")
        see_motions(tablet, 10)
        other = httpx.HTTPTransport(local_address="127.0.0.2")
        with httpx.Client(transport=other) as client:
            assert client.get(room.page).text == "<title>page</title>"
    said = capsys.readouterr().out
    assert said.count("turned away") == 1, "one line, whoever many there are"
    assert "127.0.0.1 has 128" in said
    assert not caplog.records


def test_a_place_is_free_again_once_its_connection_ended(room: Room) -> None:
    for _ in range(3):
        with crowd(room, door.OF_ONE_ADDRESS):
            pass
    until(lambda: httpx.get(room.page).text == "<title>page</title>", "a place")


def test_that_the_crowd_is_gone_is_said_once_too(
    room: Room, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(door, "_OVER_AFTER_S", 0.2)
    with crowd(room, door.OF_ONE_ADDRESS + 7) as connections:
        until(lambda: sum(map(is_ended, connections)) >= 7, "those that are too many to be turned away")
    said = ""

    def everyone_is_counted() -> bool:
        nonlocal said
        said += capsys.readouterr().out
        # On a slow machine the crowd may come in several waves, each of which has its end.
        return sum(int(count) for count in re.findall(r"any more\s+.*turned_away=(\d+)", said)) == 7

    until(everyone_is_counted, lambda: f"the end to be said: {said}")


@pytest.mark.parametrize(
    "said",
    [
        b"",
        HALF_A_REQUEST,
        b"GET /api/status HTTP/1.1\r\nHost: x\r\n\r\n" + HALF_A_REQUEST,
        b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 100\r\n\r\n{",
        b"GET /ws HTTP/1.1\r\nHost: x\r\n" + SOCKET + b"".join(b"X%d: a\r\n" % i for i in range(300)) + b"\r\n",
        b"GET /ws HTTP/1.1\r\nHost: x\r\n" + SOCKET + b"Content-Length: 5\r\n\r\n",
    ],
    ids=[
        "nothing",
        "half a request",
        "half a second request",
        "half a body",
        "a socket with too many headers",
        "a socket with a body",
    ],
)
def test_a_request_that_never_comes_is_not_waited_for_for_ever(room: Room, monkeypatch: pytest.MonkeyPatch, said: bytes) -> None:
    monkeypatch.setattr(patience, "REQUEST_S", 1.0)
    with watch(room) as tablet, caller(room, said) as connection:
        until(lambda: is_ended(connection), "the connection to be ended")
        see_motions(tablet, 5)


def test_a_request_that_comes_letter_by_letter_is_not_waited_for_for_ever(room: Room, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(patience, "REQUEST_S", 1.0)
    with caller(room, HALF_A_REQUEST) as connection:
        until(lambda: is_ended(connection) or not connection.send(b"X"), "the connection to be ended")


def test_an_answer_that_nobody_takes_is_not_kept_for_ever(room: Room, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(patience, "ANSWER_S", 2.0)
    with caller(room, b"GET /large.bin HTTP/1.1\r\nHost: x\r\n\r\n") as connection:
        # What the network holds of the answer hides the end from who does not take it; the server has let go of it by then.
        own = connection.getsockname()

        def is_held() -> bool:
            return any(held.raddr == own for held in psutil.Process().net_connections("tcp"))

        until(is_held, "the connection to be accepted")
        until(lambda: not is_held(), "the connection to be ended")


def test_a_socket_may_stay_for_as_long_as_it_likes(room: Room, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(patience, "REQUEST_S", 1.0)
    monkeypatch.setattr(patience, "ANSWER_S", 1.0)
    with watch(room) as tablet:
        see_motions(tablet, 40)


def test_a_server_that_may_open_nothing_says_so_once_and_goes_on(
    room: Room, capsys: pytest.CaptureFixture[str], caplog: pytest.LogCaptureFixture
) -> None:
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    with watch(room) as tablet, ExitStack() as stack:
        callers = [stack.enter_context(socket.socket()) for _ in range(5)]
        try:
            # Descriptors above this are in use already.
            resource.setrlimit(resource.RLIMIT_NOFILE, (8, before[1]))
            for each in callers:
                each.connect(("127.0.0.1", room.port))
                each.sendall(b"GET / HTTP/1.1\r\nHost: x\r\n\r\n")
            see_motions(tablet, 30)
        finally:
            resource.setrlimit(resource.RLIMIT_NOFILE, before)
        for each in callers:
            each.settimeout(GENEROUS_S)
            assert each.recv(15) == b"HTTP/1.1 200 OK"
    assert capsys.readouterr().out.count("Too many open files") == 1
    assert not [record for record in caplog.records if record.levelno >= logging.WARNING]


@pytest.mark.parametrize(("may_open", "room_for"), [(20, 10), (1024, 256), (resource.RLIM_INFINITY, 256)])
def test_the_bus_keeps_half_of_what_the_process_may_open(monkeypatch: pytest.MonkeyPatch, may_open: int, room_for: int) -> None:
    monkeypatch.setattr(resource, "getrlimit", lambda _: (may_open, may_open))
    assert door.places() == room_for


def test_what_cannot_be_read_is_answered_and_leaves_no_line_in_the_log(room: Room, caplog: pytest.LogCaptureFixture) -> None:
    for said in (b"\x16\x03\x01\r\n\r\n", b"GET /\xff HTTP/1.1\r\nHost: x\r\n\r\n"):
        with caller(room, said) as connection:
            assert connection.recv(12) == b"HTTP/1.1 400"
    assert not caplog.records
