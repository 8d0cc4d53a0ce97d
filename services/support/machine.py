"""Measures the machine: processor, memory, disk, temperature and whether somebody set its clock."""

import os
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import psutil

from models.messages.health import MachineHealth
from services.support.cpu import CpuMeter
from services.support.memory import free_memory_mib

WINDOW_NS = 60_000_000_000
"""A clock that was set and a processor that was slowed down are told for so long."""
STEP_MS = 100.0
"""Smaller jumps come from a process that was held up between two clocks, not from a hand."""
SLEW_MS_S = 100.0
"""A time service turns the wall clock faster or slower by at most this (chrony's `maxslewrate` is 83 ms/s)."""

_PROCESSOR_SENSORS = ("coretemp", "k10temp", "zenpower", "cpu_thermal", "cpu-thermal", "soc_thermal", "acpitz")
"""Linux's names of sensors that are in or at the processor; the first that is there counts."""
_SYSFS = Path("/sys/devices")
_INTEL_COUNTS = "system/cpu/cpu*/thermal_throttle/*_throttle_count"
_RASPBERRY_BITS = "platform/soc*/soc*firmware/get_throttled"
_RASPBERRY_NOW = 0b1111
"""Too little voltage, frequency capped, throttled, soft temperature limit; the higher bits are about the past (`vcgencmd`)."""


@dataclass(frozen=True)
class Throttling:
    """What the machine says of a processor slowed down for its heat or for want of power.

    Attributes:
        count: times since it was switched on; only the difference of two readings means anything.
        now: it is slowed down at this moment.
    """

    count: int
    now: bool


def clocks_ns() -> tuple[int, int]:
    """CLOCK_REALTIME and CLOCK_MONOTONIC at one instant: of three readings the one with the least between its ends."""
    readings = []
    for _ in range(3):
        before_ns, wall_ns, after_ns = time.monotonic_ns(), time.time_ns(), time.monotonic_ns()
        readings.append((after_ns - before_ns, wall_ns, (before_ns + after_ns) // 2))
    _, wall_ns, monotonic_ns = min(readings)
    return wall_ns, monotonic_ns


def free_disk_mib(folder: Path) -> float:
    """Room for this user in the file system of `folder`, or of the nearest folder above that exists; NaN if it cannot be known."""
    for existing in (folder, *folder.absolute().parents):
        try:
            return os.statvfs(existing).f_bavail * os.statvfs(existing).f_frsize / 2**20
        except FileNotFoundError:
            continue
        except OSError:
            break
    return float("nan")


def temperature_c() -> float | None:
    """The warmest place of the processor; None where the machine does not say."""
    sensors = psutil.sensors_temperatures()
    for name in _PROCESSOR_SENSORS:
        readings = [reading.current for reading in sensors.get(name, ()) if reading.current]
        if readings:
            return float(max(readings))
    return None


def throttling(sysfs: Path = _SYSFS) -> Throttling:
    """What Intel's thermal counters and the Raspberry Pi's firmware say; nothing on other machines."""
    count = sum(_number(file, 10) for file in sysfs.glob(_INTEL_COUNTS))
    bits = [_number(file, 16) for file in sysfs.glob(_RASPBERRY_BITS)]
    return Throttling(count, any(value & _RASPBERRY_NOW for value in bits))


def _number(file: Path, base: int) -> int:
    try:
        return int(file.read_text().strip(), base)
    except (OSError, ValueError):
        return 0


@dataclass(frozen=True)
class Sensors:
    """Everything that is read from outside."""

    clocks_ns: Callable[[], tuple[int, int]] = clocks_ns
    free_disk_mib: Callable[[Path], float] = free_disk_mib
    free_memory_mib: Callable[[], float] = free_memory_mib
    temperature_c: Callable[[], float | None] = temperature_c
    throttling: Callable[[], Throttling] = throttling


@dataclass
class _LastMinute:
    """Figures with the CLOCK_MONOTONIC at which they came."""

    entries: deque[tuple[int, float]] = field(default_factory=deque)

    def largest(self, now_ns: int) -> float:
        """The figure that is furthest from 0, of two the newer; 0 if there is none."""
        while self.entries and now_ns - self.entries[0][0] > WINDOW_NS:
            self.entries.popleft()
        return max((figure for _, figure in reversed(self.entries)), key=abs, default=0.0)


class MachineMeter:
    """Reads the machine, about once a second.

    Args:
        data: the data folder, where lessons and logs are kept.
        sensors: what is read.
    """

    def __init__(self, data: Path, sensors: Sensors | None = None) -> None:
        self._data = data
        self._sensors = sensors or Sensors()
        self._cpu = CpuMeter()
        self._before: tuple[int, int] | None = None
        self._steps_ms = _LastMinute()
        self._throttle_count = self._sensors.throttling().count
        self._throttled = _LastMinute()

    def __call__(self) -> MachineHealth:
        """The machine now."""
        wall_ns, now_ns = self._sensors.clocks_ns()
        return MachineHealth(
            used_cores=self._cpu.used_cores(),
            granted_cores=self._cpu.granted_cores,
            memory_free_mib=self._sensors.free_memory_mib(),
            disk_free_mib=self._sensors.free_disk_mib(self._data),
            temperature_c=self._sensors.temperature_c(),
            wall_minus_monotonic_ns=wall_ns - now_ns,
            clock_step_ms=self._clock_step_ms(wall_ns - now_ns, now_ns),
            throttled=self._was_throttled(now_ns),
        )

    def _clock_step_ms(self, offset_ns: int, now_ns: int) -> float:
        if self._before is not None:
            offset_before_ns, before_ns = self._before
            step_ms, elapsed_s = (offset_ns - offset_before_ns) * 1e-6, (now_ns - before_ns) * 1e-9
            if abs(step_ms) > STEP_MS + SLEW_MS_S * elapsed_s:
                self._steps_ms.entries.append((now_ns, step_ms))
        self._before = (offset_ns, now_ns)
        # Not their sum: a clock that was set forwards and back was set twice, and next to nothing is left of that.
        return self._steps_ms.largest(now_ns)

    def _was_throttled(self, now_ns: int) -> bool:
        reading = self._sensors.throttling()
        if reading.now or reading.count > self._throttle_count:
            self._throttled.entries.append((now_ns, 1.0))
        self._throttle_count = reading.count
        return self._throttled.largest(now_ns) > 0
