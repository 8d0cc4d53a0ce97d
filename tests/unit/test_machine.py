"""What is said of the machine: a full disk, a set clock and a hot processor must be found, and nothing that is not there."""

import errno
import os
import re
import time
from dataclasses import dataclass, field, replace
from pathlib import Path

import msgspec
import pytest

from models.config.site import LessonsConfig
from models.messages.health import MachineHealth
from services.lesson.disk_room import shortage
from services.supervisor.machine_watch import MachineWatch
from services.support.machine import MachineMeter, Sensors, Throttling, clocks_ns, free_disk_mib, throttling
from services.support.machine_troubles import machine_troubles
from services.support.memory import free_memory_mib

S = 1_000_000_000
WALL_NS = 1_700_000_000 * S
GOOD = MachineHealth(1.0, 4.0, 4000.0, 50_000.0, 55.0, WALL_NS, 0.0)


@dataclass
class Machine:
    """A machine whose clocks go as the test says."""

    monotonic_ns: int = 1000 * S
    wall_ns: int = WALL_NS
    throttling: Throttling = field(default_factory=lambda: Throttling(7, now=False))

    def meter(self) -> MachineMeter:
        return MachineMeter(Path(), replace(Sensors(), clocks_ns=self.clocks_ns, throttling=lambda: self.throttling))

    def clocks_ns(self) -> tuple[int, int]:
        return self.wall_ns, self.monotonic_ns

    def pass_s(self, seconds: float, wall_s: float | None = None) -> None:
        self.monotonic_ns += round(seconds * S)
        self.wall_ns += round((seconds if wall_s is None else wall_s) * S)


@pytest.mark.parametrize("step_s", [3600.0, -7200.0, 0.5, -0.5])
def test_a_clock_that_is_set_is_told_for_a_minute_and_no_longer(step_s: float) -> None:
    machine = Machine()
    meter = machine.meter()
    assert meter().clock_step_ms == 0
    machine.pass_s(1.0)
    machine.wall_ns += round(step_s * S)
    assert meter().clock_step_ms == pytest.approx(step_s * 1e3)
    machine.pass_s(59.0)
    assert meter().clock_step_ms == pytest.approx(step_s * 1e3)
    machine.pass_s(2.0)
    assert meter().clock_step_ms == 0


def test_a_clock_that_a_time_service_makes_faster_is_not_set() -> None:
    machine = Machine()
    meter = machine.meter()
    for _ in range(100):
        machine.pass_s(1.0, wall_s=1.08)
        assert meter().clock_step_ms == 0


@pytest.mark.parametrize(
    ("steps_s", "told"),
    [
        ((10.0, -4.0), "forwards by 10.0 s"),
        ((4.0, -10.0), "back by 10.0 s"),
        ((10.0, -10.0), "back by 10.0 s"),
        ((10.0, -10.000_000_3), "back by 10.0 s"),
        ((-10.000_01, 10.0), "back by 10.0 s"),
    ],
)
def test_a_clock_that_is_set_forwards_and_back_is_not_told_as_if_it_had_hardly_been_set(
    steps_s: tuple[float, float], told: str
) -> None:
    machine = Machine()
    meter = machine.meter()
    meter()
    for step_s in steps_s:
        machine.pass_s(20.0, wall_s=20.0 + step_s)
        meter()
    (trouble,) = machine_troubles(msgspec.structs.replace(GOOD, clock_step_ms=meter().clock_step_ms))
    assert trouble.words == f"the clock was set {told} in the last minute"
    machine.pass_s(41.0)
    assert meter().clock_step_ms == pytest.approx(steps_s[1] * 1e3), "the first is too long ago, the second is not"
    machine.pass_s(20.0)
    assert meter().clock_step_ms == 0


def test_the_real_clocks_are_the_systems() -> None:
    wall_ns, monotonic_ns = clocks_ns()
    assert abs((wall_ns - monotonic_ns) - (time.time_ns() - time.monotonic_ns())) < S


def test_throttling_is_told_for_a_minute_after_the_count_rose() -> None:
    machine = Machine()
    meter = machine.meter()
    assert not meter().throttled, "what was before the start is no news"
    machine.throttling = Throttling(8, now=False)
    assert meter().throttled
    machine.pass_s(59.0)
    assert meter().throttled
    machine.pass_s(2.0)
    assert not meter().throttled


def test_intels_counts_and_the_raspberrys_bits_are_read(tmp_path: Path) -> None:
    assert throttling(tmp_path) == Throttling(0, now=False)
    for cpu, count in enumerate((3, 4)):
        folder = tmp_path / f"system/cpu/cpu{cpu}/thermal_throttle"
        folder.mkdir(parents=True)
        (folder / "core_throttle_count").write_text(f"{count}\n")
    firmware = tmp_path / "platform/soc/soc:firmware"
    firmware.mkdir(parents=True)
    (firmware / "get_throttled").write_text("50000\n")
    assert throttling(tmp_path) == Throttling(7, now=False), "only the low bits are about now"
    (firmware / "get_throttled").write_text("50005\n")
    assert throttling(tmp_path) == Throttling(7, now=True)


def test_the_disk_is_that_of_the_folder_even_before_it_is_made(tmp_path: Path) -> None:
    real = os.statvfs(tmp_path)
    assert free_disk_mib(tmp_path / "not" / "there") == pytest.approx(real.f_bavail * real.f_frsize / 2**20, rel=0.05)


def test_memory_that_a_control_group_forbids_is_not_free(tmp_path: Path) -> None:
    group = tmp_path / "box" / "inner"
    group.mkdir(parents=True)
    (group / "memory.max").write_text("max\n")
    (group.parent / "memory.max").write_text(f"{300 * 2**20}\n")
    (group.parent / "memory.current").write_text(f"{250 * 2**20}\n")
    (group.parent / "memory.stat").write_text(f"anon 1\ninactive_file {20 * 2**20}\n")
    assert free_memory_mib(group) == pytest.approx(70.0)


@pytest.mark.parametrize(
    ("changes", "code", "words"),
    [
        ({"disk_free_mib": 150.0}, "disk_full", "the disk of the data folder is full: 157 MB are free"),
        ({"disk_free_mib": 1536.0}, "disk_low", "the disk of the data folder is nearly full: 1.6 GB are free"),
        ({"memory_free_mib": 90.0}, "memory_low", "memory is nearly gone: 94 MB are free"),
        ({"temperature_c": 96.2}, "hot", "the processor is too hot: 96 °C"),
        ({"throttled": True}, "throttled", "the processor was slowed down in the last minute, .* \\(it is at 55 °C\\)"),
        ({"clock_step_ms": -1500.0}, "clock_set", "the clock was set back by 1.5 s in the last minute"),
    ],
)
def test_each_trouble_is_named_with_its_figure(changes: dict[str, float], code: str, words: str) -> None:
    assert machine_troubles(GOOD) == ()
    (trouble,) = machine_troubles(msgspec.structs.replace(GOOD, **changes))
    assert trouble.code == code
    assert re.fullmatch(words, trouble.words)


def test_the_room_on_a_disk_is_the_same_figure_whoever_tells_it() -> None:
    (trouble,) = machine_troubles(msgspec.structs.replace(GOOD, disk_free_mib=128.0))
    assert "134 MB" in trouble.words
    assert "134 MB" in shortage(128.0, LessonsConfig())


def test_what_is_not_known_is_no_trouble() -> None:
    unknown = msgspec.structs.replace(GOOD, disk_free_mib=float("nan"), memory_free_mib=float("nan"), temperature_c=None)
    assert machine_troubles(unknown) == ()


def test_a_person_is_told_once_and_again_only_after_a_trouble_was_away() -> None:
    machine = GOOD
    watch = MachineWatch(lambda: machine)
    assert watch.look(0.0) == []
    machine = msgspec.structs.replace(GOOD, memory_free_mib=10.0)
    assert [trouble.code for trouble in watch.look(1.0)] == ["memory_low"]
    assert [trouble.words for trouble in watch.troubles] == ["memory is nearly gone: 10 MB are free"]
    assert watch.look(2.0) == []
    machine = GOOD
    assert watch.look(3.0) == []
    assert watch.troubles == ()
    machine = msgspec.structs.replace(GOOD, memory_free_mib=10.0)
    assert watch.look(4.0) == [], "it flickers"
    machine = GOOD
    watch.look(5.0)
    machine = msgspec.structs.replace(GOOD, memory_free_mib=10.0)
    assert len(watch.look(70.0)) == 1


def test_a_machine_that_cannot_be_measured_is_a_trouble_and_no_end() -> None:
    answers: list[MachineHealth | OSError] = [GOOD, OSError(errno.EMFILE, "Too many open files"), GOOD]

    def measure() -> MachineHealth:
        answer = answers.pop(0)
        if isinstance(answer, OSError):
            raise answer
        return answer

    watch = MachineWatch(measure)
    watch.look(0.0)
    assert [trouble.code for trouble in watch.look(1.0)] == ["machine_unmeasured"]
    assert watch.newest is None, "an old measurement would be taken for a new one"
    assert [(trouble.code, trouble.words) for trouble in watch.troubles] == [
        ("machine_unmeasured", "the machine cannot be measured (Too many open files)")
    ]
    assert watch.look(2.0) == []
    assert watch.troubles == ()


def test_the_machine_is_measured_once_a_second_and_not_with_every_look() -> None:
    measured = 0

    def measure() -> MachineHealth:
        nonlocal measured
        measured += 1
        return GOOD

    watch = MachineWatch(measure)
    for tenth in range(21):
        watch.look(tenth / 10)
    assert measured == 3
