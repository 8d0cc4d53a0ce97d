"""Health, logs and the page's addresses: what every process says about itself."""

import io
import logging
import os
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest
import structlog

from models.config.site import TabletConfig
from models.messages import codec, topics
from models.messages.health import Health
from models.messages.trouble import Trouble
from models.process import Resources
from services.bus.memory import MemoryRouter
from services.logs import of_process
from services.supervisor.child import ChildSpec, name_of
from services.supervisor.journal import Journal
from services.supervisor.page import addresses
from services.support.health import HealthReporter, ResourceMeter
from tests.installed import ROOT


@pytest.fixture
def stream() -> Iterator[io.StringIO]:
    root = logging.getLogger()
    handlers, level = root.handlers[:], root.level
    root.handlers = []
    yield io.StringIO()
    structlog.reset_defaults()
    root.handlers, root.level = handlers, level


def test_health_is_published_on_the_process_own_topic_and_due_once_a_second() -> None:
    now_ns = 5_000_000_000
    bus = MemoryRouter().open()
    subscription = bus.subscribe(topics.ALL_HEALTH, keep=2)
    reporter = HealthReporter("edge-a", bus, lambda: Resources(0.5, 100.0), lambda: now_ns)
    assert reporter.due()
    said = reporter.report("degraded", (Trouble("camera_ended", "slow"),))
    delivery = subscription.receive(0.0)
    assert delivery is not None
    assert delivery.topic == topics.health("edge-a")
    assert codec.decode(delivery.payload, Health) == said
    assert (said.pid, said.t_ns, said.state, said.reason, said.cpu_cores) == (os.getpid(), now_ns, "degraded", "slow", 0.5)
    now_ns += 999_999_999
    assert not reporter.due()
    now_ns += 1
    assert reporter.due()


def test_a_process_measures_its_own_cpu_and_memory() -> None:
    wall_s = time.monotonic()
    meter = ResourceMeter()
    cpu_s = time.process_time()
    while time.process_time() - cpu_s < 0.05:
        pass
    used = meter()
    assert used.cpu_cores * (time.monotonic() - wall_s) >= 0.05
    assert used.rss_mib > 10


def test_our_logs_and_the_libraries_come_out_alike(stream: io.StringIO) -> None:
    of_process.configure("edge-a", stream)
    structlog.get_logger().info("ours", rate_hz=15)
    logging.getLogger("library").warning("theirs %d", 7)
    ours, theirs = (msgspec.json.decode(line) for line in stream.getvalue().splitlines())
    assert (ours["process"], ours["level"], ours["event"], ours["rate_hz"]) == ("edge-a", "info", "ours", 15)
    assert (theirs["process"], theirs["level"], theirs["event"]) == ("edge-a", "warning", "theirs 7")
    assert list(ours) == ["time", "process", "level", "event", "rate_hz"]
    assert list(theirs) == ["time", "process", "level", "event"]
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{6}Z", ours["time"])


def test_a_traceback_stays_within_one_line(stream: io.StringIO) -> None:
    of_process.configure("edge-a", stream)
    try:
        raise RuntimeError("broken")
    except RuntimeError:
        structlog.get_logger().exception("it failed")
    (line,) = stream.getvalue().splitlines()
    assert "RuntimeError: broken" in msgspec.json.decode(line)["exception"]


ENDINGS = {
    "an exception": ("raise RuntimeError('broken\\nin two')", "RuntimeError: broken"),
    "an exception in a thread": (
        "import threading; t = threading.Thread(target=lambda: 1 / 0, name='loop'); t.start(); t.join()",
        "ZeroDivisionError: division by zero",
    ),
    "native code": ("import ctypes; ctypes.string_at(0)", "Fatal Python error: Segmentation fault"),
}


@pytest.mark.parametrize("ending", ENDINGS)
def test_what_ends_a_process_is_one_record_in_the_log(tmp_path: Path, ending: str) -> None:
    program, event = ENDINGS[ending]
    set_up = "from services.logs.of_process import configure, log_what_ends_us; configure('edge-a'); log_what_ends_us()"
    said = subprocess.run(
        [sys.executable, "-c", f"{set_up}\n{program}"], cwd=ROOT, capture_output=True, text=True, check=False
    ).stderr
    journal = Journal(tmp_path, io.StringIO())
    for line in said.splitlines():
        journal.child_said("edge-a", line)
    journal.close()
    (entry,) = (msgspec.json.decode(line) for line in journal.path.read_text().splitlines())
    assert (entry["process"], entry["level"], entry["event"]) == ("edge-a", "critical", event)
    assert 'File "<string>", line 2' in entry["exception"]


def test_the_address_of_one_host_is_given_as_it_is() -> None:
    assert addresses(TabletConfig(host="10.0.0.7", port=81)) == ["http://10.0.0.7:81"]


def test_the_address_of_an_ipv6_host_is_one_that_a_browser_takes() -> None:
    assert addresses(TabletConfig(host="fd00::7", port=81)) == ["http://[fd00::7]:81"]


def test_a_page_on_every_network_is_found_on_this_machine_first() -> None:
    found = addresses(TabletConfig(port=8080))
    assert found[0] == "http://localhost:8080"
    assert not any("127." in address for address in found)


@pytest.mark.parametrize("spec", [ChildSpec("fusion"), ChildSpec("edge", "cam01")])
def test_a_process_is_known_by_its_command_line(spec: ChildSpec, tmp_path: Path) -> None:
    assert name_of(spec.command(tmp_path, tmp_path, 1)) == spec.name
    assert name_of(["/usr/bin/python3", "-m", "http.server"]) is None


@pytest.mark.parametrize(
    "command",
    [
        "grep services.cli.child",
        "grep services.cli.child log",
        "python -m services.cli.child",
        "pgrep -af services.cli.child --camera",
    ],
)
def test_somebody_who_looks_for_our_processes_is_none_of_them(command: str) -> None:
    assert name_of(command.split()) is None
