"""Troubles of the processes of a box that runs."""

import os
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from services.doctor.finding import Examined
from tests.integration.box import Box, HealthWatch
from tests.integration.doctor_troubles.running_box import STANDING, all_well, running, until_told, wait_for
from tests.integration.doctor_troubles.trouble import Trouble


def _stop(*names: str) -> Callable[[Box], None]:
    """Stop processes while the supervisor, who would see to it, is stopped too."""

    def stage(box: Box) -> None:
        with HealthWatch(box) as watch:
            pids = [watch.wait_for(name, "ok").pid for name in names]  # The last ones that were started may be spares.
        box.process.send_signal(signal.SIGSTOP)
        for pid in pids:
            os.kill(pid, signal.SIGSTOP)

    return stage


def _kill_once(box: Box) -> None:
    all_well(box)
    pid = box.pid("edge-a")
    os.kill(pid, signal.SIGKILL)
    box.wait_restarted("edge-a")
    with HealthWatch(box) as watch:
        back = watch.wait_for("edge-a", "ok", box.pid("edge-a"))
        watch.wait_for("supervisor", "ok", after_ns=back.t_ns)


def _kill_unseen(box: Box) -> None:
    """The supervisor cannot start it anew."""
    box.process.send_signal(signal.SIGSTOP)
    os.kill(box.pid("edge-b"), signal.SIGKILL)


@contextmanager
def another_version(folder: Path) -> Iterator[Examined]:
    package = folder / "packages" / "kinebox-9.9.9.dist-info"
    package.mkdir(parents=True)
    (package / "METADATA").write_text("Metadata-Version: 2.1\nName: kinebox\nVersion: 9.9.9\n")
    with running(all_well)(folder) as found:
        yield found


@contextmanager
def log_that_cannot_be_written(folder: Path) -> Iterator[Examined]:
    (folder / "data").mkdir()
    (folder / "data" / "logs").write_text("a file where the folder should be")
    with running(until_told("supervisor", "degraded"))(folder) as found:
        yield found


PROCESSES: dict[str, Trouble] = {
    "a process crashes until it is given up": Trouble(
        running(lambda box: wait_for(box, "supervisor", "failed"), {"edge-b": "crash"}, "[supervisor]\nmax_restarts = 2\n"),
        "edge-b",
        "edge-b is given up and does not run any more: ended 3 times within 60 s; last, it ended with exit code 1",
        "start the box anew",
    ),
    "a process was killed": Trouble(
        running(_kill_once),
        "edge-a",
        r"edge-a was started again once; \d+ s ago it was ended by SIGKILL",
        "read what it said",
        "warning",
    ),
    "a process is missing": Trouble(STANDING.stage(_kill_unseen), "edge-b", "edge-b is missing", "it may be starting"),
    "a camera's process hangs": Trouble(
        STANDING.stage(_stop("edge-a")), "edge-a", r"edge-a \(process \d+\) is stopped", r"kill -CONT \d+"
    ),
    "the router hangs": Trouble(STANDING.stage(_stop("fusion")), "fusion", r"fusion \(process \d+\) is stopped", r"kill -CONT \d+"),
    "the supervisor hangs": Trouble(STANDING.stage(_stop()), "supervisor", r"supervisor \(process \d+\) is stopped", "kill -CONT"),
    "the page hangs": Trouble(
        STANDING.stage(_stop("tablet")), "tablet", r"the page at port \d+ does not answer", "wait some seconds"
    ),
    "the log cannot be written": Trouble(
        log_that_cannot_be_written, "log", r"nothing is kept in .*kinebox\.log: File exists", "what lies in its place"
    ),
    "the box is of another version": Trouble(
        another_version, "version", r"the box that runs is KineBox 9\.9\.9", "start it anew with this version", "warning"
    ),
}
