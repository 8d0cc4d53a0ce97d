"""How this process is: what it uses, said once a second on the bus."""

import os
import time
from collections.abc import Callable
from pathlib import Path

from models.messages import codec, topics
from models.messages.health import (
    EvaluationHealth,
    FusionHealth,
    Health,
    MachineHealth,
    RecorderHealth,
    ReplayHealth,
    State,
    SupervisorHealth,
)
from models.messages.trouble import Trouble
from models.process import Bus, Resources

PERIOD_S = 1.0
_PAGE_MIB = os.sysconf("SC_PAGE_SIZE") / 2**20
_STATM = Path("/proc/self/statm")


class ResourceMeter:
    """CPU and memory of this process with all its threads. Each reading of the CPU covers the time since the one before.

    Memory that cannot be read is NaN.
    """

    def __init__(self) -> None:
        self._wall_s = time.monotonic()
        self._cpu_s = time.process_time()

    def __call__(self) -> Resources:
        """Read the clocks and the resident memory."""
        wall_s, cpu_s = time.monotonic(), time.process_time()
        elapsed_s, used_s = wall_s - self._wall_s, cpu_s - self._cpu_s
        self._wall_s, self._cpu_s = wall_s, cpu_s
        return Resources(used_s / elapsed_s if elapsed_s > 0 else 0.0, _resident_mib())


def _resident_mib() -> float:
    try:
        return int(_STATM.read_text().split()[1]) * _PAGE_MIB
    except OSError:  # A process that has no descriptor left goes on without this figure.
        return float("nan")


class HealthReporter:
    """Publishes the health of one process. A loop asks `due` as often as it likes and calls `report` when it says so.

    Args:
        process: its name on the bus.
        bus: where to say it.
        resources: measures the process.
        clock_ns: CLOCK_MONOTONIC.
    """

    def __init__(
        self, process: str, bus: Bus, resources: Callable[[], Resources], clock_ns: Callable[[], int] = time.monotonic_ns
    ) -> None:
        self._process = process
        self._bus = bus
        self._resources = resources
        self._clock_ns = clock_ns
        self._next_ns = clock_ns()

    def due(self) -> bool:
        """Whether a second has passed since the last report; true at first."""
        return self._clock_ns() >= self._next_ns

    def report(
        self,
        state: State = "ok",
        troubles: tuple[Trouble, ...] = (),
        *,
        fusion: FusionHealth | None = None,
        recorder: RecorderHealth | None = None,
        machine: MachineHealth | None = None,
        replay: ReplayHealth | None = None,
        supervisor: SupervisorHealth | None = None,
        evaluation: EvaluationHealth | None = None,
    ) -> Health:
        """Publish how this process is, and return what was published."""
        now_ns = self._clock_ns()
        self._next_ns = now_ns + round(PERIOD_S * 1e9)
        used = self._resources()
        health = Health(
            process=self._process,
            pid=os.getpid(),
            t_ns=now_ns,
            state=state,
            troubles=troubles,
            cpu_cores=used.cpu_cores,
            rss_mib=used.rss_mib,
            fusion=fusion,
            recorder=recorder,
            machine=machine,
            replay=replay,
            supervisor=supervisor,
            evaluation=evaluation,
        )
        self._bus.publish(topics.health(health.process), codec.encode(health))
        return health
