"""The page's server on real sockets: in a thread of its own, which a test stops and starts again; and what its pages see."""

import json
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest
from websockets.sync.client import connect

from services.tablet import process
from tests.browser.room import tablet_context
from tests.integration.test_recorder_process import ZenohRoom
from tests.integration.waiting import DEADLINE_S, until
from tests.ports import free_port


@contextmanager
def page_server(room: ZenohRoom, folder: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """The tablet process on the same bus, with a page of one line; its address."""
    (folder / "page").mkdir(exist_ok=True)
    (folder / "page" / "index.html").write_text("<title>page</title>")
    monkeypatch.setattr(process, "PAGE", folder / "page")
    port, stop = free_port(), threading.Event()
    with ExitStack() as stack:
        bus = room.open()
        stack.callback(bus.close)
        thread = threading.Thread(target=process.main, args=(tablet_context(bus, port, stop),), daemon=True)
        thread.start()
        stack.callback(thread.join, DEADLINE_S)
        stack.callback(stop.set)
        address = f"http://127.0.0.1:{port}/"
        until(lambda: answers(address), "the page's server")
        yield address


def answers(address: str) -> bool:
    """Whether there is a server."""
    try:
        return httpx.get(f"{address}api/status").is_success
    except httpx.TransportError:
        return False


def hears(address: str, part: str) -> bool:
    """Whether the server has heard of a process: it listens to pages earlier than to the bus."""
    return any(process["name"] == part for process in httpx.get(f"{address}api/status").json()["processes"])


def listed(address: str) -> dict[str, Any]:
    """The list of attempts as a page gets it that opens now."""
    with connect(address.replace("http", "ws") + "ws") as tablet:
        return next_list(tablet)


def next_list(tablet: Any, at_least: int = 0) -> dict[str, Any]:
    """The next list that a tablet is sent with so many attempts."""
    while True:
        message = tablet.recv(timeout=DEADLINE_S)
        said: dict[str, Any] = json.loads(message) if isinstance(message, str) else {}
        if said.get("type") == "attempts" and len(said["attempts"]) >= at_least:
            return said


def numbers(address: str) -> list[tuple[int, int | None]]:
    """Names and numbers of the attempts on the list."""
    return [(attempt["id"], attempt["number"]) for attempt in httpx.get(f"{address}api/attempts").json()]
