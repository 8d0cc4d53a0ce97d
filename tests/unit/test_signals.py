"""Being told to stop, by real signals to a real process."""

import signal
import subprocess
import sys
from collections.abc import Iterator

import pytest

from tests.installed import ROOT
from tests.integration.waiting import until

STOPS = """
import sys
from services.support.signals import stop_on_signals
stop = stop_on_signals()
print("runs", flush=True)
stop.wait()
print("stops", flush=True)
sys.stdin.readline()
print("has stopped", flush=True)
"""


@pytest.fixture
def process() -> Iterator[subprocess.Popen[str]]:
    with subprocess.Popen(
        [sys.executable, "-c", STOPS], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=ROOT
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "runs\n"
        yield process
        process.kill()


def test_two_signals_at_once_are_one_wish(process: subprocess.Popen[str]) -> None:
    # As `timeout` sends them: to the process, then to its group.
    process.send_signal(signal.SIGTERM)
    process.send_signal(signal.SIGCONT)
    process.send_signal(signal.SIGTERM)
    process.send_signal(signal.SIGHUP)
    output, _ = process.communicate("\n", timeout=30.0)
    assert output == "stops\nhas stopped\n"
    assert process.returncode == 0


def test_who_asks_again_is_not_kept_waiting(process: subprocess.Popen[str]) -> None:
    assert process.stdout is not None
    process.send_signal(signal.SIGTERM)
    assert process.stdout.readline() == "stops\n"

    def ends() -> bool:
        process.send_signal(signal.SIGTERM)
        return process.poll() is not None

    until(ends, "the end of a process that was told to end several times")
    assert process.returncode == 128 + signal.SIGTERM
