"""Spares under the real supervisor: they wait, take over, are made anew, and never outlive the box."""

import os
import signal
from pathlib import Path

import psutil
import pytest

from tests.integration.box import NAMES, Box, HealthWatch
from tests.integration.waiting import until

pytestmark = pytest.mark.slow


def spares(box: Box) -> dict[str, int]:
    """Process ids of the spares that are there, by the process that they would be, those that have taken over left out."""
    found = {}
    for child in psutil.Process(box.process.pid).children():
        words = child.cmdline()
        if "--spare" in words:
            name = words[words.index("services.cli.child") + 1]
            if child.pid not in box.pids(name):
                found[name] = child.pid
    return found


def test_a_spare_takes_over_and_is_followed_by_another(tmp_path: Path) -> None:
    with Box(tmp_path) as box:
        box.wait_started()
        until(lambda: set(spares(box)) == {"fusion", "tablet"}, "both spares")
        before = spares(box)
        os.kill(box.pid("fusion"), signal.SIGKILL)
        box.wait_restarted("fusion")
        assert box.pid("fusion") == before["fusion"]
        with HealthWatch(box) as watch:
            for name in NAMES:
                watch.wait_for(name, "ok", box.pid(name))
        until(lambda: "fusion" in spares(box), "the next spare")
        left = [psutil.Process(pid) for pid in spares(box).values()]
        assert box.end() == 0
        assert not [each for each in left if each.is_running() and each.status() != psutil.STATUS_ZOMBIE]


def test_a_spare_that_dies_is_no_fault_of_the_box(tmp_path: Path) -> None:
    with Box(tmp_path) as box:
        box.wait_started()
        until(lambda: "tablet" in spares(box), "a spare")
        os.kill(spares(box)["tablet"], signal.SIGKILL)
        os.kill(box.pid("tablet"), signal.SIGKILL)
        box.wait_restarted("tablet")
        with HealthWatch(box) as watch:
            watch.wait_for("tablet", "ok", box.pid("tablet"))
        assert box.end() == 0


def test_a_site_may_do_without(tmp_path: Path) -> None:
    with Box(tmp_path, more="[supervisor]\nspares = false\n") as box:
        box.wait_started()
        with HealthWatch(box) as watch:
            heard = watch.wait_for("fusion", "ok")
            watch.wait_for("fusion", "ok", after_ns=heard.t_ns + 5_000_000_000)
        assert spares(box) == {}


def test_spares_die_with_a_supervisor_that_was_killed(tmp_path: Path) -> None:
    with Box(tmp_path) as box:
        box.wait_started()
        until(lambda: set(spares(box)) == {"fusion", "tablet"}, "both spares")
        left = [psutil.Process(pid) for pid in spares(box).values()]
        box.process.kill()
        _, alive = psutil.wait_procs(left, timeout=30)
        assert not alive


def test_a_spare_that_is_stopped_makes_no_outage(tmp_path: Path) -> None:
    with Box(tmp_path) as box:
        box.wait_started()
        until(lambda: "fusion" in spares(box), "a spare")
        stopped = spares(box)["fusion"]
        os.kill(stopped, signal.SIGSTOP)
        # Who waits for a CPU stops only when it gets one.
        until(lambda: psutil.Process(stopped).status() == psutil.STATUS_STOPPED, "the spare to be stopped")
        os.kill(box.pid("fusion"), signal.SIGKILL)
        box.wait_restarted("fusion")
        assert box.pid("fusion") != stopped
        with HealthWatch(box) as watch:
            watch.wait_for("fusion", "ok", box.pid("fusion"))
        assert box.end() == 0


def test_a_spare_that_is_stopped_as_it_takes_over_is_found_out_in_seconds(tmp_path: Path) -> None:
    with Box(tmp_path, {"fusion": "stop the second"}) as box:
        box.wait_started()
        log = box.data / "logs" / "kinebox.log"
        until(lambda: "a spare of fusion is ready" in log.read_text(), "a spare that is ready")
        os.kill(box.pid("fusion"), signal.SIGKILL)
        box.wait_restarted("fusion", starts=3)
        assert box.end() == 0
        assert "fusion hung and is started again" in box.errors.read_text()


def test_a_process_that_is_stopped_before_it_was_ever_heard_is_found_out_in_seconds(tmp_path: Path) -> None:
    with Box(tmp_path, {"fusion": "stop the second"}, more="[supervisor]\nspares = false\n") as box:
        box.wait_started()
        os.kill(box.pid("fusion"), signal.SIGKILL)
        box.wait_restarted("fusion", starts=3)
        assert box.end() == 0
        assert "fusion hung and is started again" in box.errors.read_text()
