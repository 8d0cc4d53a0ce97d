"""The tablet process over real sockets: what a client gets, what a bad one cannot do, and what stops a start."""

import itertools
import json
import queue
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack
from importlib import resources
from pathlib import Path
from typing import Any

import httpx
import pytest
from prometheus_client.parser import text_string_to_metric_families
from websockets.exceptions import ConnectionClosed, ConnectionClosedError, InvalidStatus
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Origin

import models.teaching
from models.config.site import TabletConfig
from models.errors import UserError
from models.messages import codec, topics
from models.messages.health import Health
from models.process import Subscription
from services.tablet import motion_frame, openapi, page_socket, process
from services.tablet.audience import MAX_CLIENTS, MAX_OF_ONE_ADDRESS, READ_BURST, READ_HZ
from services.tablet.server import TabletServer
from tests.browser import room as room_module
from tests.browser.room import CAMERAS, Room, tablet_context
from tests.integration import waiting
from tests.taught import shipped

GENEROUS_S = 30.0


@pytest.fixture
def room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Room]:
    """A room whose page is one line, so that these tests do not need it built."""
    (tmp_path / "index.html").write_text("<title>page</title>", encoding="utf-8")
    (tmp_path / "assets").mkdir()
    (tmp_path / "assets" / "index-1.js").write_text("", encoding="utf-8")
    monkeypatch.setattr(process, "PAGE", tmp_path)
    with Room() as made:
        yield made


def join(room: Room, origin: Origin | None = None, of: str = "127.0.0.1") -> AbstractContextManager[ClientConnection]:
    address = room.page.replace("http", "ws") + "ws"
    return connect(address, compression=None, proxy=None, origin=origin, source_address=(of, 0))


def next_motion(client: ClientConnection) -> motion_frame.MotionFrame:
    while True:
        message = client.recv(timeout=GENEROUS_S)
        if isinstance(message, bytes):
            return motion_frame.unpack(message)


def next_motion_forever(client: ClientConnection) -> None:
    while True:
        next_motion(client)


def motions_that_wait(client: ClientConnection) -> int:
    """Motions that have already arrived."""
    count = 0
    while True:
        try:
            count += isinstance(client.recv(timeout=0), bytes)
        except TimeoutError:
            return count


def next_json(client: ClientConnection, kind: str) -> dict[str, Any]:
    while True:
        message = client.recv(timeout=GENEROUS_S)
        if isinstance(message, str) and json.loads(message)["type"] == kind:
            said: dict[str, Any] = json.loads(message)
            return said


def acknowledge(client: ClientConnection, motions: int, statuses: int = 0) -> None:
    client.send(json.dumps({"type": "ack", "motions": motions, "statuses": statuses}))


def until(room: Room, key: str, at_least: float) -> dict[str, Any]:
    deadline_s = time.monotonic() + GENEROUS_S
    while time.monotonic() < deadline_s:
        status: dict[str, Any] = httpx.get(room.page + "api/status").json()
        if status[key] is not None and status[key] >= at_least:
            return status
        time.sleep(0.05)
    raise AssertionError(f"'{key}' never reached {at_least}")


def test_a_client_learns_of_the_room_and_then_sees_it_move(room: Room) -> None:
    with join(room) as client:
        assert [camera["name"] for camera in next_json(client, "status")["cameras"]] == list(CAMERAS)
        first = next_motion(client)
        now_ns = time.monotonic_ns()
        assert 0 < first.t_newest_ns < now_ns, "a client on the box measures latency on the box's own clock"
        acknowledge(client, 1)
        assert next_motion(client).sequence > first.sequence


@pytest.mark.slow
def test_a_client_that_does_not_answer_gets_two_frames_and_then_the_newest(room: Room) -> None:
    with join(room) as client, join(room) as quick:
        stalled = [next_motion(client), next_motion(client)]
        for answered in range(1, 31):
            newest = next_motion(quick)
            acknowledge(quick, answered)
        assert motions_that_wait(client) == 0
        acknowledge(client, 2)
        assert next_motion(client).sequence >= newest.sequence > stalled[-1].sequence + 20


@pytest.mark.slow
def test_statuses_wait_for_an_answer_too(room: Room) -> None:
    with join(room) as client:
        first = next_json(client, "status")
        until(room, "box_time_us", first["box_time_us"] + 3_000_000)
        acknowledge(client, 0, statuses=1)
        assert next_json(client, "status")["box_time_us"] > first["box_time_us"] + 2_000_000, "the ones between were replaced"


@pytest.mark.slow
def test_many_clients_each_see_every_step_forward(room: Room) -> None:
    seen: queue.Queue[list[int]] = queue.Queue()

    def watch() -> None:
        with join(room) as client:
            sequences = []
            for answered in range(1, 16):
                sequences.append(next_motion(client).sequence)
                acknowledge(client, answered)
            seen.put(sequences)

    watchers = [threading.Thread(target=watch) for _ in range(10)]
    for watcher in watchers:
        watcher.start()
    for _ in watchers:
        sequences = seen.get(timeout=GENEROUS_S)
        assert sequences == sorted(set(sequences))
    for watcher in watchers:
        watcher.join()
    assert httpx.get(room.page + "api/status").json()["rejected_client_messages"] == 0


def test_malformed_messages_are_counted_and_kill_nothing(room: Room) -> None:
    bad: list[str | bytes] = ["", "{", "[]", "null", '{"type":"ack"}', '{"type":"nonsense"}', b"\x00\xff"]
    bad += ['{"type":"ack","motions":999999,"statuses":0}', '{"type":"ping","id":-1}', '{"type":"ping","id":1,"extra":2}']
    with join(room) as client:
        for message in bad:
            client.send(message)
        assert until(room, "rejected_client_messages", len(bad))["rejected_client_messages"] == len(bad)
        client.send('{"type":"ping","id":5}')
        assert next_json(client, "pong")["id"] == 5


def test_an_endless_message_costs_its_sender_the_connection_and_nobody_else(room: Room) -> None:
    with join(room) as client, join(room) as other:
        client.send("x" * 100_000)
        with pytest.raises(ConnectionClosedError, match="1009"):
            next_motion_forever(client)
        next_motion(other)


def test_another_sites_page_may_not_watch(room: Room) -> None:
    with pytest.raises(InvalidStatus, match="403"), join(room, origin=Origin("http://elsewhere.example")):
        pass
    with join(room, origin=Origin(room.page.rstrip("/"))) as client:
        next_motion(client)


def test_a_page_of_no_readable_address_may_not_watch_and_is_no_defect(room: Room, caplog: pytest.LogCaptureFixture) -> None:
    for origin in ("http://[::1", "http://[x]", "null", "http://\u00e4", "//", ""):
        with pytest.raises(InvalidStatus, match="403"), join(room, origin=Origin(origin)):
            pass
    assert not caplog.records


def test_a_request_that_is_odd_is_no_defect(room: Room, caplog: pytest.LogCaptureFixture) -> None:
    paths = ("", "api/status", "metrics", "assets/", "%00", "%ff", "%ed%a0%80", "api/attempts/" + "9" * 5000 + "/replay")
    for path, host in itertools.product(paths, ("[::1", "[x]:99999999", "\xff", "")):
        with socket.create_connection(("127.0.0.1", room.port), timeout=GENEROUS_S) as client:
            client.sendall(f"GET /{path} HTTP/1.1\r\nHost: {host}\r\n\r\n".encode("latin-1"))
            assert client.recv(10) in {b"HTTP/1.1 2", b"HTTP/1.1 4"}, (path, host)
    assert not caplog.records


def test_a_full_house_is_said_to_be_full(room: Room) -> None:
    with ExitStack() as clients:
        for number in range(MAX_CLIENTS):
            clients.enter_context(join(room, of=f"127.0.0.{2 + number % 2}"))
        until(room, "clients", MAX_CLIENTS)
        with join(room) as late, pytest.raises(ConnectionClosed, match="too many tablets"):
            late.recv(timeout=GENEROUS_S)


def test_tablets_of_one_address_keep_no_tablet_of_another_one_out(room: Room) -> None:
    with ExitStack() as clients:
        for _ in range(MAX_OF_ONE_ADDRESS):
            clients.enter_context(join(room))
        until(room, "clients", MAX_OF_ONE_ADDRESS)
        with join(room) as late, pytest.raises(ConnectionClosed, match="too many tablets"):
            late.recv(timeout=GENEROUS_S)
        with join(room, of="127.0.0.2") as other:
            next_motion(other)


@pytest.mark.slow
def test_a_client_that_sends_without_end_is_read_no_faster_and_loses_nothing(room: Room) -> None:
    with join(room) as client, join(room) as other:
        began = httpx.get(room.page + "api/status").json()
        count = 3 * READ_BURST
        for _ in range(count):
            client.send("no message")
        client.send('{"type":"ping","id":5}')
        status = until(room, "rejected_client_messages", count)
        passed_s = (status["box_time_us"] - began["box_time_us"]) * 1e-6
        assert count <= READ_BURST + READ_HZ * passed_s, "all that there was time for"
        assert next_json(client, "pong")["id"] == 5
        next_motion(other)


TOO_MANY = page_socket.BURST + 1


@pytest.mark.parametrize(
    "send",
    [
        lambda client: [client.ping() for _ in range(TOO_MANY)],
        lambda client: [client.pong() for _ in range(TOO_MANY)],
        lambda client: client.send([""] * TOO_MANY),
    ],
    ids=["pings", "pongs", "pieces"],
)
def test_a_client_that_sends_what_no_page_does_without_end_is_ended_with_a_reason(
    room: Room, send: Callable[[ClientConnection], object], monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(page_socket, "HZ", 1e-3)  # However slowly this machine sends them.
    with join(room) as client, join(room) as other:
        send(client)
        with pytest.raises(ConnectionClosed, match=r"1008.*too many pings or pieces"):
            next_motion_forever(client)
        next_motion(other)
    assert not caplog.records


def test_a_text_that_is_none_costs_its_sender_the_connection_and_leaves_no_traceback(
    room: Room, caplog: pytest.LogCaptureFixture
) -> None:
    with join(room) as client, join(room) as other:
        client.send(b"\xff\xfe", text=True)
        with pytest.raises(ConnectionClosed, match="1007"):
            next_motion_forever(client)
        next_motion(other)
    assert not caplog.records


@pytest.mark.slow
def test_broken_bus_messages_are_counted_and_reported(room: Room) -> None:
    bus = room.join_bus()
    reports = bus.subscribe(topics.health("tablet"), keep=10)
    # Of processes that say nothing else: a newer message of the same topic may take the place of one that was not read yet.
    bus.publish(topics.health("one"), b"\x02\x02 broken")
    bus.publish(topics.health("other"), b"")
    until(room, "rejected_bus_messages", 2)
    said = [next_health(reports)]
    while not (said[-1].state == "ok" and any(health.state == "degraded" for health in said)):
        said.append(next_health(reports))
    assert sum(int(health.reason.split()[0]) for health in said if health.state == "degraded") == 2, "each is told once"


def next_health(reports: Subscription) -> Health:
    delivery = reports.receive(GENEROUS_S)
    assert delivery is not None, "the tablet process fell silent"
    return codec.decode(delivery.payload, Health)


@pytest.mark.parametrize("part", ["show_statuses", "receive", "publish"])
def test_a_part_that_fails_ends_the_process_with_its_error(
    room: Room, monkeypatch: pytest.MonkeyPatch, part: str, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise ZeroDivisionError(part)

    room.stop_server()
    bus = room.join_bus()
    if part == "show_statuses":
        monkeypatch.setattr(TabletServer, "status", fail)
    elif part == "receive":
        monkeypatch.setattr(process, "decoded", fail)
    else:
        monkeypatch.setattr(bus, "publish", fail)
    with pytest.raises(ZeroDivisionError, match=part):
        process.main(tablet_context(bus, room.port, threading.Event()))
    assert "a part of the server failed" in capsys.readouterr().out


def test_the_process_is_alive_on_the_bus_while_it_runs(room: Room) -> None:
    seen: list[tuple[str, bool]] = []
    room.join_bus().watch_alive(topics.alive("tablet"), lambda topic, alive: seen.append((topic, alive)))
    room.stop_server()
    assert seen == [(topics.alive("tablet"), True), (topics.alive("tablet"), False)]


def test_the_page_is_served_with_headers_that_keep_it_to_itself(room: Room) -> None:
    front = httpx.get(room.page)
    assert front.text == "<title>page</title>"
    assert "default-src 'self'" in front.headers["content-security-policy"]
    assert front.headers["cache-control"] == "no-cache"
    assert "immutable" in httpx.get(room.page + "assets/index-1.js").headers["cache-control"]
    assert httpx.get(room.page + "docs").status_code == 404
    assert httpx.get(room.page + "../process.py").status_code == 404


def test_a_port_that_is_taken_is_named_with_what_to_do() -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        with pytest.raises(UserError, match=rf"port {port}.*\[tablet\] in the site file") as error:
            process.listen(TabletConfig(host="127.0.0.1", port=port))
        assert "\n" not in str(error.value)


def test_an_address_that_is_not_this_machines_is_named() -> None:
    with pytest.raises(UserError, match=r"cannot listen on 203\.0\.113\.9 port 8080: .*; correct 'host' under"):
        process.listen(TabletConfig(host="203.0.113.9", port=8080))


def test_a_page_that_is_not_built_stops_the_start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(process, "PAGE", tmp_path / "dist")
    with pytest.raises(UserError, match="make web"):
        process.main(None)  # type: ignore[arg-type]  # nothing else is looked at before


def test_the_description_for_the_page_is_current() -> None:
    written = openapi.FILE.read_text(encoding="utf-8")
    assert written == openapi.description(), "run `python -m services.tablet.openapi`, then `npm run types` in services/tablet/web"


def test_prometheus_reads_the_room_over_the_pages_port(room: Room) -> None:
    until(room, "cpu_load", 0.0)
    answer = httpx.get(room.page + "metrics")
    assert answer.headers["content-type"].startswith("text/plain; version=0.0.4")
    read = {metric.name: metric for metric in text_string_to_metric_families(answer.text)}
    states = {(s.labels["camera"], s.labels["state"]): s.value for s in read["kinebox_camera_state"].samples}
    assert {camera for camera, _ in states} == set(CAMERAS)
    assert read["kinebox_live_motion_hertz"].samples[0].value > 0
    assert read["kinebox_machine_temperature_celsius"].samples[0].value == 63.0


def test_a_server_that_cannot_read_its_words_shows_the_figure_names_the_file_and_takes_them_once_they_are_mended(
    room: Room, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Somebody was at work on the file as the server died: half of it was saved."""
    file = tmp_path / "data/school/actions/squat.toml"
    file.parent.mkdir(parents=True)
    file.write_text("version = 1\n")
    monkeypatch.setattr(room_module, "PAGE", tmp_path / "data")
    monkeypatch.setattr(process, "AGAIN_AFTER_S", 0.05)
    room.stop_server()
    room.start_server()
    with join(room) as client:
        assert next_motion(client).sequence >= 0
    waiting.until(lambda: said_of_itself(room)[0] == "degraded", "that something is wrong")
    assert "teaching file squat.toml: `action` is missing; add it" in said_of_itself(room)[1]
    assert english(room, "squat") == shipped().teachings["squat"].title.en
    before = revision(room)
    text = resources.files(models.teaching).joinpath("actions/squat.toml").read_text(encoding="utf-8")
    file.write_text(text.replace(f'en = "{english(room, "squat")}"', 'en = "Chair without a chair"', 1), encoding="utf-8")
    waiting.until(lambda: english(room, "squat") == "Chair without a chair", "the mended words")
    waiting.until(lambda: said_of_itself(room) == ("ok", ""), "that all is well")
    after = revision(room)
    assert after != before, "a page that has the words from before is not told that there are others"
    room.stop_server()
    room.start_server()
    assert revision(room) == after, "the same words are called others after a restart"


def said_of_itself(room: Room) -> tuple[str, str]:
    """State and reason of the page's server, as the page has them."""
    processes = httpx.get(f"{room.page}api/status").json()["processes"]
    return next(((one["state"], one["reason"]) for one in processes if one["name"] == "tablet"), ("", ""))


def revision(room: Room) -> str:
    """Of the words, as a page that joins is told."""
    with join(room) as client:
        return str(next_json(client, "status")["teaching"])


def english(room: Room, action: str) -> str:
    """An action's title on the page."""
    return str(httpx.get(f"{room.page}api/teaching").json()["actions"][action]["title"]["en"])
