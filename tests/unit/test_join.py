"""Joining a box's bus from outside: whoever waits for it is answered in time, and leaves nothing open."""

import threading
from types import SimpleNamespace

import pytest

from services.bus import zenoh_bus
from services.bus.join import join
from tests.integration.waiting import DEADLINE_S


def test_a_router_that_hangs_is_not_waited_for_and_a_session_that_opens_late_is_closed(monkeypatch: pytest.MonkeyPatch) -> None:
    goes_on, closed = threading.Event(), threading.Event()

    def hang(_endpoint: str, _stop: threading.Event) -> SimpleNamespace:
        goes_on.wait()
        return SimpleNamespace(close=closed.set)

    monkeypatch.setattr(zenoh_bus, "open_client", hang)
    assert join("tcp/127.0.0.1:1", within_s=0.05) is None
    goes_on.set()
    assert closed.wait(DEADLINE_S), "the session stays open"


def test_where_nobody_is_the_search_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    ended = threading.Event()

    def search(_endpoint: str, stop: threading.Event) -> None:
        stop.wait()
        ended.set()

    monkeypatch.setattr(zenoh_bus, "open_client", search)
    assert join("tcp/127.0.0.1:1", within_s=0.05) is None
    assert ended.wait(DEADLINE_S), "a thread goes on searching"


def test_what_goes_wrong_while_joining_is_told_to_who_joins(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(_endpoint: str, _stop: threading.Event) -> None:
        raise ValueError("no endpoint")

    monkeypatch.setattr(zenoh_bus, "open_client", fail)
    with pytest.raises(ValueError, match="no endpoint"):
        join("nonsense", within_s=DEADLINE_S)
