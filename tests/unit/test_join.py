"""Joining a box's bus from outside: whoever waits for it is answered in time, and leaves nothing open."""

import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from services.bus import zenoh_bus
from services.bus.join import join
from tests.integration.waiting import DEADLINE_S
from tests.ports import free_port

ZENOH_WAITS_S = 10.0
"""For a router that accepts and says nothing, unless it is told otherwise."""


def test_a_router_that_hangs_is_not_waited_for() -> None:
    with socket.create_server(("127.0.0.1", 0)) as silent:
        began_s = time.monotonic()
        assert join(f"tcp/127.0.0.1:{silent.getsockname()[1]}", within_s=0.5) is None
        assert time.monotonic() - began_s < 3.0, f"alone it waits for {ZENOH_WAITS_S} s"


def test_a_program_that_gave_a_hanging_router_up_ends_as_it_says() -> None:
    with socket.create_server(("127.0.0.1", 0)) as silent:
        gives_up = f"join('tcp/127.0.0.1:{silent.getsockname()[1]}', 0.3) is None"
        program = f"from services.bus.join import join; assert {gives_up}; raise SystemExit(2)"
        ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=DEADLINE_S, check=False)
    assert (ended.returncode, ended.stderr) == (2, "")


def test_where_nobody_is_the_search_ends_and_no_thread_goes_on() -> None:
    assert join(f"tcp/127.0.0.1:{free_port()}", within_s=0.3) is None  # Zenoh keeps threads of its own from its first use on.
    before = _threads()
    assert join(f"tcp/127.0.0.1:{free_port()}", within_s=0.3) is None
    assert _threads() <= before


def _threads() -> int:
    """Of this process, also those that are not Python's."""
    return sum(1 for _ in Path("/proc/self/task").iterdir())


def test_a_router_that_comes_late_and_hangs_is_given_only_what_is_left_of_the_time(monkeypatch: pytest.MonkeyPatch) -> None:
    ends_s: list[float] = []

    def refused(_endpoint: str, answers_within_s: float) -> None:
        ends_s.append(time.monotonic() - began_s + answers_within_s)

    monkeypatch.setattr(zenoh_bus, "try_client", refused)
    began_s = time.monotonic()
    assert join("tcp/127.0.0.1:1", within_s=0.5) is None
    assert len(ends_s) > 1
    assert max(ends_s) < 0.8


def test_what_goes_wrong_while_joining_is_told_to_who_joins(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(_endpoint: str, **_: float) -> None:
        raise ValueError("no endpoint")

    monkeypatch.setattr(zenoh_bus, "try_client", fail)
    with pytest.raises(ValueError, match="no endpoint"):
        join("nonsense", within_s=DEADLINE_S)
