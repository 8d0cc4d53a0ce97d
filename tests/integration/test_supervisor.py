"""`kinebox run` with real processes that crash, hang and refuse."""

import contextlib
import fcntl
import os
import pty
import re
import signal
import termios
import time
from collections.abc import Callable
from pathlib import Path

import msgspec
import pytest

from services.logs.write_behind import HELD_UP
from tests.integration.box import NAMES, Box, HealthWatch
from tests.integration.waiting import until

pytestmark = pytest.mark.slow


def test_a_box_starts_tells_where_its_page_is_and_ends_cleanly(tmp_path: Path) -> None:
    with Box(tmp_path) as box:
        box.wait_started()
        box.wait_page()
        assert f"http://127.0.0.1:{box.page_port}" in box.output.read_text()
        with HealthWatch(box) as watch:
            for name in (*NAMES, "supervisor"):
                watch.wait_for(name, "ok")
        assert box.end() == 0
        assert box.running() == []
        assert len(box.start_times_ns()) == 1


def test_a_disk_that_stalls_under_the_log_holds_up_no_restart_and_is_said(tmp_path: Path) -> None:
    logs = tmp_path / "data" / "logs"
    logs.mkdir(parents=True)
    os.mkfifo(logs / "kinebox-000001.log")  # It holds up whoever writes to it until somebody reads.
    reader = os.open(logs / "kinebox-000001.log", os.O_RDONLY | os.O_NONBLOCK)
    fcntl.fcntl(reader, fcntl.F_SETPIPE_SZ, 4096)
    writer = os.open(logs / "kinebox-000001.log", os.O_WRONLY | os.O_NONBLOCK)
    os.write(writer, b"." * 4095 + b"\n")
    os.close(writer)
    with Box(tmp_path) as box:
        box.wait_started()
        with HealthWatch(box) as watch:
            watch.wait_for("edge-a", "ok")
            os.kill(box.pid("edge-a"), signal.SIGKILL)
            box.wait_restarted("edge-a")
            back = watch.wait_for("edge-a", "ok", box.pid("edge-a"))

            def says_why() -> bool:
                return HELD_UP in watch.wait_for("supervisor", "degraded", after_ns=back.t_ns).reason

            until(says_why, "the supervisor's word about the disk")
            told_ns = time.monotonic_ns()
            fcntl.fcntl(reader, fcntl.F_SETPIPE_SZ, 1 << 20)
            kept = os.read(reader, 1 << 20)
            watch.wait_for("supervisor", "ok", after_ns=told_ns)
        assert box.end() == 0
        kept += os.read(reader, 1 << 20)
    os.close(reader)
    events = [msgspec.json.decode(line)["event"] for line in kept.splitlines()[1:]]
    assert any(event.startswith("starting ") for event in events)
    assert any(event.startswith("edge-a was ended by SIGKILL") for event in events)
    assert events[-1] == "ended"


def full_pipe() -> tuple[int, int]:
    """A pager at its first page: where it would read, and where nothing more can be written."""
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(writer, b"." * 1024)
    os.set_blocking(writer, True)
    return reader, writer


def stopped_terminal() -> tuple[int, int]:
    """A terminal after Ctrl-S: its screen, and where nothing can be written."""
    screen, terminal = pty.openpty()
    termios.tcflow(terminal, termios.TCOOFF)
    return screen, terminal


@pytest.mark.parametrize("make", [full_pipe, stopped_terminal])
def test_a_console_that_nobody_reads_keeps_nobody_from_being_restarted_nor_the_box_from_ending(
    tmp_path: Path, make: Callable[[], tuple[int, int]]
) -> None:
    reader, console = make()
    with Box(tmp_path, {"edge-b": "noise"}, console=console) as box:
        os.close(console)
        box.wait_started()
        with HealthWatch(box) as watch:
            watch.wait_for("edge-a", "ok")
            os.kill(box.pid("edge-a"), signal.SIGKILL)
            box.wait_restarted("edge-a")
            watch.wait_for("edge-a", "ok", box.pid("edge-a"))
        assert box.end() == 0
        assert box.running() == []
        said = (box.data / "logs" / "kinebox.log").read_text()
        assert "edge-a was ended by SIGKILL and is started again" in said
    os.close(reader)


def test_ctrl_c_ends_the_box_cleanly(tmp_path: Path) -> None:
    with Box(tmp_path) as box:
        box.wait_started()
        # As a terminal does it: to the whole foreground group.
        os.killpg(box.process.pid, signal.SIGINT)
        assert box.process.wait(60.0) == 0
        assert box.running() == []
        assert "Traceback" not in box.errors.read_text()


def test_a_box_that_is_told_to_end_while_it_starts_ends(tmp_path: Path) -> None:
    with Box(tmp_path) as box:
        box.wait_started("fusion")
        assert box.end() == 0
        assert box.running() == []


def test_a_camera_that_crashes_comes_back_and_the_others_do_not_notice(tmp_path: Path) -> None:
    with Box(tmp_path) as box:
        box.wait_started()
        with HealthWatch(box) as watch:
            watch.wait_for("edge-a", "ok")
            os.kill(box.pid("edge-a"), signal.SIGKILL)
            box.wait_restarted("edge-a")
            watch.wait_for("edge-a", "ok", box.pid("edge-a"))
            watch.wait_for("supervisor", "ok")
        assert [len(box.pids(name)) for name in NAMES] == [1, 2, 1, 1, 1, 1]
        # The camera takes up the common count again.
        assert len(box.start_times_ns()) == 1
        assert box.end() == 0
        assert "edge-a was ended by SIGKILL and is started again" in box.errors.read_text()


def test_the_router_comes_back_and_everybody_is_heard_again(tmp_path: Path) -> None:
    with Box(tmp_path) as box:
        box.wait_started()
        with HealthWatch(box) as watch:
            watch.wait_for("fusion", "ok")
            os.kill(box.pid("fusion"), signal.SIGKILL)
            box.wait_restarted("fusion")
            watch.wait_for("fusion", "ok", box.pid("fusion"))
            for name in NAMES:
                watch.wait_for(name, "ok", box.pid(name))
        assert [len(box.pids(name)) for name in NAMES] == [2, 1, 1, 1, 1, 1]
        assert box.end() == 0


@pytest.mark.parametrize("name", ["fusion", "edge-b"])
def test_a_process_that_hangs_is_killed_and_restarted_and_no_other(tmp_path: Path, name: str) -> None:
    with Box(tmp_path) as box:
        box.wait_started()
        with HealthWatch(box) as watch:
            for each in (*NAMES, "supervisor"):
                watch.wait_for(each, "ok")
            os.kill(box.pid(name), signal.SIGSTOP)
            box.wait_restarted(name)
            for each in NAMES:
                watch.wait_for(each, "ok", box.pid(each))
        assert [len(box.pids(each)) for each in NAMES] == [2 if each == name else 1 for each in NAMES]
        assert box.end() == 0
        assert f"{name} hung and is started again" in box.errors.read_text()


def test_a_loop_that_hangs_behind_a_living_network_is_found_too(tmp_path: Path) -> None:
    with Box(tmp_path, {"edge-a": "hang"}) as box:
        box.wait_started()
        with HealthWatch(box) as watch:
            heard = watch.wait_for("supervisor", "ok")
            # A message that the supervisor, too, has heard.
            watch.wait_for("edge-a", "ok", after_ns=heard.t_ns)
            (box.data / "hang").touch()
            box.wait_restarted("edge-a")
        assert box.end() == 0


@pytest.mark.parametrize("name", ["fusion", "edge-a"])
def test_a_process_that_ends_of_itself_slowly_is_not_taken_for_hung(tmp_path: Path, name: str) -> None:
    with Box(tmp_path, {name: "linger"}, "[supervisor]\nspares = false\n") as box:
        box.wait_started()
        box.wait_restarted(name)
        assert box.end() == 0
        assert f"{name} ended with exit code 0 and is started again" in box.errors.read_text()
        assert "hang" not in box.errors.read_text()


def test_a_process_that_keeps_crashing_is_given_up_and_the_rest_goes_on(tmp_path: Path) -> None:
    with Box(tmp_path, {"edge-b": "crash"}, "[supervisor]\nmax_restarts = 2\n") as box:
        box.wait_started()
        with HealthWatch(box) as watch:
            supervisor = watch.wait_for("supervisor", "failed")
            assert supervisor.reason.startswith("edge-b is given up: ended 3 times within 60 s")
            assert "ended 3 times" in watch.wait_for("edge-b", "failed").reason
            watch.wait_for("edge-a", "ok")
        assert len(box.pids("edge-b")) == 3
        assert box.end() == 0
        assert "crashed as ordered" in box.errors.read_text()


def test_a_process_that_says_what_a_person_must_do_is_not_started_again(tmp_path: Path) -> None:
    line = "camera 'a': film.avi is missing; run 'make footage'"
    with Box(tmp_path, {"edge-a": "refuse"}) as box:
        box.wait_started()
        with HealthWatch(box) as watch:
            assert watch.wait_for("edge-a", "failed").reason == line
            assert watch.wait_for("supervisor", "failed").reason == f"edge-a is given up: {line}"
            watch.wait_for("edge-b", "ok")
        assert len(box.pids("edge-a")) == 1
        assert box.end() == 0
        assert line in box.errors.read_text()


def test_a_process_that_worked_and_cannot_for_a_while_is_told_with_its_line_and_comes_back_by_itself(tmp_path: Path) -> None:
    line = "camera 'a': film.avi is missing; run 'make footage'"
    with Box(tmp_path, {"edge-a": "refuse again"}, "[supervisor]\nmax_restarts = 1\n") as box:
        box.wait_started()
        with HealthWatch(box) as watch:
            heard = watch.wait_for("supervisor", "ok")
            watch.wait_for("edge-a", "ok", after_ns=heard.t_ns)
            (box.data / "refuse").touch()
            os.kill(box.pid("edge-a"), signal.SIGKILL)
            assert watch.wait_for("edge-a", "failed").reason == f"{line}; it is tried again"
            assert f"edge-a said: {line}; it is tried again" in watch.wait_for("supervisor", "degraded").reason
            box.wait_restarted("edge-a", 5)
            (box.data / "refuse").unlink()
            watch.wait_for("edge-a", "ok")
            watch.wait_for("supervisor", "ok")
        assert box.end() == 0
        assert "given up" not in box.errors.read_text()
        assert "edge-a runs again" in box.errors.read_text()


def test_no_process_outlives_a_supervisor_that_was_killed(tmp_path: Path) -> None:
    with Box(tmp_path, {"edge-a": "deaf"}) as box:
        box.wait_started()
        os.kill(box.pid("edge-b"), signal.SIGSTOP)
        box.process.kill()
        box.wait_gone()


def test_a_process_that_does_not_listen_is_killed_at_the_end(tmp_path: Path) -> None:
    with Box(tmp_path, {"edge-a": "deaf"}) as box:
        box.wait_started()
        with HealthWatch(box) as watch:
            watch.wait_for("edge-a", "ok")
        os.kill(box.pid("edge-b"), signal.SIGSTOP)
        assert box.end() == 0
        assert box.running() == []


def test_one_stream_holds_what_every_process_says(tmp_path: Path) -> None:
    with Box(tmp_path, {"edge-a": "noise", "edge-b": "crash"}, "[supervisor]\nmax_restarts = 0\n") as box:
        box.wait_started()
        until(lambda: "edge-b is given up" in box.errors.read_text(), "edge-b to be given up")
        assert box.end() == 0
        lines = (box.data / "logs" / "kinebox.log").read_text().splitlines()
        entries = [msgspec.json.decode(line, type=dict[str, str]) for line in lines]
        assert all({"process", "level", "event", "time"} <= entry.keys() for entry in entries)
        said = {(entry["process"], entry["event"]) for entry in entries}
        assert ("edge-a", "what a library printed") in said
        assert ("edge-b", "RuntimeError: crashed as ordered") in said
        shown = box.errors.read_text().splitlines()
        assert all(re.match(r"\d\d:\d\d:\d\d  (supervisor|camera [ab]) +  ", line) for line in shown), shown
        assert sum("what a library printed" in line for line in shown) == 1


def test_a_part_that_says_that_it_failed_is_among_the_warnings_of_the_log_and_its_recovery_is_not(tmp_path: Path) -> None:
    with Box(tmp_path, {"edge-a": "ail"}) as box:
        box.wait_started()
        (box.data / "ail").touch()
        until(lambda: "edge-a is failed: its pictures are black" in box.errors.read_text(), "the word")
        (box.data / "ail").unlink()
        until(lambda: "edge-a is ok" in box.errors.read_text(), "its recovery")
        assert box.end() == 0
        lines = (box.data / "logs" / "kinebox.log").read_text().splitlines()
        entries = [msgspec.json.decode(line, type=dict[str, str]) for line in lines]
        levels = {entry["event"]: entry["level"] for entry in entries if entry["event"].startswith("edge-a is ")}
        assert levels == {"edge-a is failed: its pictures are black": "error", "edge-a is ok": "info"}
