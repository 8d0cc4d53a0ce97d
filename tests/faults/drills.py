"""The drills: each does one thing to a running box that a lesson must survive, and measures what a tablet saw of it."""

import contextlib
import os
import random
import signal
import socket
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, Literal

import psutil

from models.messages import codec, topics
from models.messages.lesson import LessonRequest
from models.process import RECORDER, Bus
from tests.faults.box import Box
from tests.faults.client import Client
from tests.faults.garbage import garbage_for, on_every_topic, truncated, unheard
from tests.integration.waiting import until

CAMERA = "cam02"
"""Falls ill by the site's script."""
VICTIM = "cam03"
"""Its process is killed and stopped."""
PERIOD_S = 36.0
ILL_S = 3.0
AT_S = {"stall": 24.0, "repeat": 33.0, "jump": 42.0, "end": 51.0}
SPARE_READY_S = 3.0
"""Younger than this, a spare that rests may only be waiting for the disk."""
RECOVERS_WITHIN_S = 60.0
WATCHED_S = 3.0
"""After a recovery: what comes back must stay."""
CLOCK_STEP_S = 10
RSS_SLACK_MB = 40.0


def faults_of_site() -> str:
    """The script by which one camera falls ill, each way once a period, as lines of a site file."""
    return "".join(
        f'[[faults]]\ncamera = "{CAMERA}"\nkind = "{kind}"\nat_s = {at_s}\nfor_s = {ILL_S}\nevery_s = {PERIOD_S}\n'
        for kind, at_s in AT_S.items()
    )


@dataclass
class Outcome:
    """What one run of a drill showed.

    Attributes:
        drill: its name.
        fault_s: CLOCK_MONOTONIC of the fault.
        recovery_s: the longest that the figure was away because of it, until it was back for good; 0 if it never was.
        pause_s: the longest pause of the figure since the fault, the seams of the footage included.
        said_s: until the box said that something was wrong, on the page's socket or by cutting it; None if it never did.
        rss_mb: of all processes, afterwards.
        lost_s: what is missing in the record although there was a figure; None if nothing was recorded.
        still_s: the longest that a page showed the figure in colour although no motion came; None if no page was watched.
        away_s: the longest that a page showed no live figure; likewise.
    """

    drill: str
    fault_s: float
    recovery_s: float
    pause_s: float
    said_s: float | None
    rss_mb: float
    lost_s: float | None = None
    still_s: float | None = None
    away_s: float | None = None


@dataclass
class Stage:
    """Where drills are played: a box, somebody who watches, and a place on the bus."""

    box: Box
    client: Client
    bus: Bus
    chance: random.Random = field(default_factory=lambda: random.Random(0))  # noqa: S311 - no secret
    old_faults: set[float] = field(default_factory=set)

    def settle(self) -> None:
        """Until there is a figure, every process is heard and the spares wait: each fault is one of its own."""
        until(self._spares_wait, "spares that wait", 60.0)
        self.client.wait_figure(time.monotonic())
        until(lambda: set(self._expected()) <= self._healthy(), "every process to be well", 60.0)

    def record(self, action: Literal["start", "stop"]) -> None:
        """Have a lesson begin, of which something is safe then, or end."""

        def is_done() -> bool:
            self.bus.publish(topics.lesson_request(), codec.encode(LessonRequest(action, "drills")))
            time.sleep(0.3)
            recording = self.client.status()["recording"]
            return recording is None if action == "stop" else recording is not None and recording["recorded_s"] > 0

        until(is_done, f"the lesson to {action}")

    def outcome(self, drill: str, fault_s: float, said: Callable[[dict[str, Any]], bool]) -> Outcome:
        """Watch what comes after a fault that is over, and sum up."""
        over_s = time.monotonic()
        self.client.wait_figure(time.monotonic(), RECOVERS_WITHIN_S)
        time.sleep(WATCHED_S)  # observed, not waited for: what comes back must stay
        self.client.wait_figure(time.monotonic(), RECOVERS_WITHIN_S)
        client = self.client
        signs = [at for at in client.seen.cut_s if at > fault_s]
        signs += [at for at, status in began(client.seen.statuses, said) if at > fault_s]
        return Outcome(
            drill,
            fault_s,
            client.recovery_s(fault_s, over_s),
            client.longest_pause_s(fault_s),
            min(signs) - fault_s if signs else None,
            self.box.rss_mb(),
        )

    def _expected(self) -> list[str]:
        return [name for name in self.box.children() if not name.endswith("-spare")]

    def _healthy(self) -> set[str]:
        return {each["name"] for each in self.client.status()["processes"] if each["state"] in ("ok", "degraded")}

    def _spares_wait(self) -> bool:
        children = self.box.children()
        with contextlib.suppress(psutil.NoSuchProcess):
            return all(_waits(children.get(f"{name}-spare")) for name in ("fusion", "tablet"))
        return False


def began(
    statuses: Sequence[tuple[float, dict[str, Any]]], said: Callable[[dict[str, Any]], bool]
) -> Iterator[tuple[float, dict[str, Any]]]:
    """The statuses in which something is said that was not said just before: what stands there tells of no new fault."""
    for before, now in pairwise(statuses):
        if said(now[1]) and not said(before[1]):
            yield now


def _waits(spare: psutil.Process | None) -> bool:
    """Whether a spare has got ready: it then takes no more CPU. How much it took until then is the machine's matter."""
    if spare is None or time.time() - spare.create_time() < SPARE_READY_S:
        return False
    before = sum(spare.cpu_times()[:2])
    time.sleep(0.2)
    return sum(spare.cpu_times()[:2]) == before


def process_drill(name: str, number: signal.Signals) -> Callable[[Stage], Outcome]:
    """Kill a process, or stop it so that it hangs."""

    def play(stage: Stage) -> Outcome:
        stage.settle()
        victim = stage.box.child(name)
        restarts = _restarts(stage.client.status(), name)
        fault_s = time.monotonic()
        os.kill(victim.pid, number)
        until(lambda: not _alive(victim), f"the end of {name}", RECOVERS_WITHIN_S)
        stage.box.child(name)
        until(lambda: name in stage._healthy() and _newer(stage, fault_s), f"{name} to be well again", RECOVERS_WITHIN_S)

        def said(status: dict[str, Any]) -> bool:
            # A spare takes over so soon that the process is hardly missed, but that it had to is told.
            gone = any(each["name"] == name and each["state"] in ("gone", "silent", "failed") for each in status["processes"])
            return gone or _restarts(status, name) > restarts

        return stage.outcome(process_drill_name(name, number), fault_s, said)

    return play


def process_drill_name(name: str, number: signal.Signals) -> str:
    """What a drill of a process is called: "kill-edge"."""
    return f"{'kill' if number == signal.SIGKILL else 'stop'}-{name.partition('-')[0]}"


def _restarts(status: dict[str, Any], name: str) -> int:
    """How often the box says that it had to start a process again."""
    return sum(each["restarts"] or 0 for each in status["processes"] if each["name"] == name)


def _newer(stage: Stage, fault_s: float) -> bool:
    return stage.client.seen.statuses[-1][0] > fault_s + 0.5


def _alive(process: psutil.Process) -> bool:
    try:
        return process.is_running() and process.status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:  # it was waited for between the two questions
        return False


def source_drill(kind: str) -> Callable[[Stage], Outcome]:
    """One camera falls ill as the site's script says, and gets well."""

    def play(stage: Stage) -> Outcome:
        stage.settle()
        begin_s = stage.box.start_ns() * 1e-9 + AT_S[kind]
        while begin_s < time.monotonic() + 1.0:
            begin_s += PERIOD_S
        time.sleep(begin_s - time.monotonic())  # the script's time, not a guess
        until(lambda: _ill(stage.client.status()) and _newer(stage, begin_s), f"{CAMERA} to be called ill", ILL_S + 20)
        time.sleep(max(begin_s + ILL_S - time.monotonic(), 0))
        until(lambda: not _ill(stage.client.status()), f"{CAMERA} to be well", RECOVERS_WITHIN_S)
        return stage.outcome(f"source-{kind}", begin_s, _ill)

    return play


def _ill(status: dict[str, Any]) -> bool:
    camera = next(each for each in status["cameras"] if each["name"] == CAMERA)
    return camera["state"] == "lost" or f"camera '{CAMERA}'" in camera["detail"]


def full_disk(stage: Stage) -> Outcome:
    """The data folder has no byte left for some seconds. It must be a small file system of its own."""
    stage.settle()
    ballast = stage.box.data / "ballast"
    fault_s = time.monotonic()
    free = os.statvfs(ballast.parent)
    with ballast.open("wb") as file:
        os.posix_fallocate(file.fileno(), 0, free.f_bavail * free.f_frsize - (1 << 16))
    with ballast.open("ab", buffering=0) as file, contextlib.suppress(OSError):
        while True:
            file.write(b"0")
    time.sleep(4.0)  # how long it lasts
    ballast.unlink()
    return stage.outcome("full-disk", fault_s, disk_is_called_full)


def disk_is_called_full(status: dict[str, Any]) -> bool:
    """Whether a status says that the disk is full: of the machine, or of a lesson that had to end or could not begin."""
    machine = status["machine"]
    recorder = next((each for each in status["processes"] if each["name"] == RECORDER), None)
    if machine is not None and "disk_full" in machine["troubles"]:
        return True
    return (
        recorder is not None
        and recorder["state"] == "degraded"
        and any(words in recorder["reason"] for words in (" ended: ", "no lesson was begun"))
    )


def may_set_clock() -> bool:
    """Whether this process may set the machine's wall clock."""
    try:
        time.clock_settime_ns(time.CLOCK_REALTIME, time.clock_gettime_ns(time.CLOCK_REALTIME))
    except PermissionError:
        return False
    return True


def clock_step(stage: Stage) -> Outcome:
    """The wall clock of the machine is really set, forwards and back again, as by a time server."""
    stage.settle()
    until(lambda: not clock_is_called_set(stage.client.status()), "a clock set earlier to be no news", 120.0)  # told for a minute
    fault_s = time.monotonic()
    with _stepped(CLOCK_STEP_S):
        time.sleep(3.0)  # how long it lasts
    return stage.outcome("clock-step", fault_s, clock_is_called_set)


def clock_is_called_set(status: dict[str, Any]) -> bool:
    """Whether a status says that the wall clock was set."""
    return status["machine"] is not None and "clock_set" in status["machine"]["troubles"]


@contextlib.contextmanager
def _stepped(seconds: int) -> Iterator[None]:
    """The wall clock is that much ahead inside; afterwards it is right again, since the monotonic clock went on."""
    offset_ns = time.clock_gettime_ns(time.CLOCK_REALTIME) - time.monotonic_ns()
    time.clock_settime_ns(time.CLOCK_REALTIME, time.clock_gettime_ns(time.CLOCK_REALTIME) + seconds * 10**9)
    try:
        yield
    finally:
        time.clock_settime_ns(time.CLOCK_REALTIME, time.monotonic_ns() + offset_ns)


def slow_tablet(stage: Stage) -> Outcome:
    """Ten tablets join and read nothing: nobody else may notice, and nothing may pile up for them."""
    stage.settle()
    before_mb = stage.box.child("tablet").memory_info().rss / 2**20
    fault_s = time.monotonic()
    sockets = [_deaf_tablet(stage.box.port) for _ in range(10)]
    until(lambda: stage.client.status()["clients"] >= 11, "the slow tablets to be counted")
    time.sleep(6.0)  # 180 motions and 12 statuses for each
    grown_mb = stage.box.child("tablet").memory_info().rss / 2**20 - before_mb
    for one in sockets:
        one.close()
    assert grown_mb < RSS_SLACK_MB, f"the page's server grew by {grown_mb:.0f} MB for tablets that read nothing"
    until(lambda: stage.client.status()["clients"] < 11, "the slow tablets to be gone")
    return stage.outcome("slow-tablet", fault_s, lambda _: False)


def _deaf_tablet(port: int) -> socket.socket:
    connection = socket.create_connection(("127.0.0.1", port), 5)
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    connection.sendall(
        b"GET /ws HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        b"Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n\r\n"
    )
    return connection


def corrupt_bus(stage: Stage) -> Outcome:
    """For three seconds or more every topic of the real bus carries garbage and pieces of its messages, among the true ones."""
    stage.settle()
    heard = stage.bus.subscribe("gym/**", keep=1)
    samples: dict[str, bytes] = {}

    def all_heard() -> bool:
        """Whether cameras and processes are; on the other topics nobody may speak before he is asked."""
        return _collect(heard, samples) >= 12 and not any("*" in pattern for pattern in unheard(samples))

    until(all_heard, lambda: f"a word of everybody: {unheard(samples)} of {sorted(samples)}")
    heard.close()
    samples = on_every_topic(samples)
    rejected_before = stage.client.status()["rejected_bus_messages"]
    fault_s = time.monotonic()

    def counted() -> bool:
        for topic, payload in samples.items():
            stage.bus.publish(topic, garbage_for(payload, stage.chance))
            stage.bus.publish(topic, truncated(payload, stage.chance))
        long_enough = time.monotonic() > fault_s + 3.0
        return long_enough and stage.client.status()["rejected_bus_messages"] > rejected_before

    def uncounted() -> str:
        now = stage.client.status()
        counts = f"{rejected_before} before, {now['rejected_bus_messages']} now"
        return f"the page to count what it could not read: {counts}, of {sorted(samples)}"

    until(counted, uncounted, RECOVERS_WITHIN_S)

    def said(status: dict[str, Any]) -> bool:
        return any("could not be read" in each["reason"] for each in status["processes"])

    return stage.outcome("corrupt-bus", fault_s, said)


def _collect(heard: Any, samples: dict[str, bytes]) -> int:
    delivery = heard.receive(0.1)
    if delivery is not None:
        samples[delivery.topic] = delivery.payload
    return len(samples)


PROCESSES = ("fusion", "tablet", f"edge-{VICTIM}", "evaluation", "recorder")
DRILLS: dict[str, Callable[[Stage], Outcome]] = {
    **{
        process_drill_name(name, number): process_drill(name, number)
        for number in (signal.SIGKILL, signal.SIGSTOP)
        for name in PROCESSES
    },
    "slow-tablet": slow_tablet,
    "corrupt-bus": corrupt_bus,
    "full-disk": full_disk,
    "clock-step": clock_step,
    **{f"source-{kind}": source_drill(kind) for kind in AT_S},
}
"""By name, in the order in which they are played: so that no process is killed twice within the supervisor's window."""
