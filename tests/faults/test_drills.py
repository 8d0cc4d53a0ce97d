"""Every drill once, on one running box: the figure comes back, the box says what happened, and nothing is left behind.

How soon is for `make bench-faults` to measure; here deadlines are generous.
"""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import psutil
import pytest

from services.bus.zenoh_bus import open_client
from tests.faults.box import ISOLATED, running
from tests.faults.client import Client
from tests.faults.disk import may_mount
from tests.faults.drills import DRILLS, RECOVERS_WITHIN_S, VICTIM, Stage, faults_of_site, may_set_clock
from tests.faults.traces import Before, left_behind
from tests.installed import require_footage, require_networks
from tests.integration.waiting import until

pytestmark = [pytest.mark.faults, pytest.mark.slow, pytest.mark.timeout(600)]

NEEDS = {"full-disk": "mount a file system", "clock-step": "set the machine's clock"}
GROWTH_SHARE = 1.15
"""Memory after all drills over that before: processes that were started anew differ a little from old ones."""


@contextmanager
def staged(folder: Path, more: str, *, disk: bool) -> Iterator[Stage]:
    """A box with a client and a place on its bus."""
    require_networks()
    with running(folder, require_footage(), more, disk=disk) as box, Client(box.port) as client:
        bus = open_client(box.endpoint, threading.Event())
        assert bus is not None
        try:
            client.wait_figure(time.monotonic(), RECOVERS_WITHIN_S)
            yield Stage(box, client, bus)
        finally:
            bus.close()


@pytest.fixture(scope="module")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stage]:
    folder = tmp_path_factory.mktemp("box")
    before, processes = Before.look(), list[psutil.Process]()
    with staged(folder, ISOLATED + faults_of_site(), disk=may_mount(folder)) as made:
        made.settle()
        began_mb = made.box.rss_mb()
        yield made
        made.settle()
        assert made.box.rss_mb() < GROWTH_SHARE * began_mb
        processes += made.box.descendants()
        box = made.box
    assert left_behind(box, processes, before) == []


@pytest.mark.parametrize("name", list(DRILLS))
def test_the_figure_comes_back_and_what_happened_is_said(stage: Stage, name: str, tmp_path: Path) -> None:
    if (name == "full-disk" and not may_mount(tmp_path)) or (name == "clock-step" and not may_set_clock()):
        pytest.skip(f"this drill must be allowed to {NEEDS[name]}")
    outcome = DRILLS[name](stage)
    # That a tablet is slow is nobody's matter but its own.
    assert outcome.said_s is not None or name == "slow-tablet"


def test_a_storm_of_crashes_stops_at_its_limit_and_is_said(tmp_path: Path) -> None:
    limit = "[supervisor]\nmax_restarts = 2\nwindow_s = 600\n"
    with staged(tmp_path, limit, disk=False) as stage:
        name = f"edge-{VICTIM}"
        pids = set[int]()

        def given_up() -> bool:
            victim = stage.box.children().get(name)
            if victim is not None and victim.pid not in pids:
                pids.add(victim.pid)
                victim.kill()
            return any(each["name"] == name and each["state"] == "failed" for each in stage.client.status()["processes"])

        until(given_up, f"{name} to be given up", 120.0)
        assert len(pids) == 3, "the first start and two restarts"
        camera = next(each for each in stage.client.status()["cameras"] if each["name"] == VICTIM)
        assert (camera["state"], camera["reason"]) == ("lost", "given_up")
        assert "ended 3 times within 600 s" in camera["detail"]
        stage.client.wait_figure(time.monotonic())  # the others go on
