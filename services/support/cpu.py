"""How much CPU this box was granted (affinity and control-group quota) and how much of it is in use, by whomever."""

import os
import time
from pathlib import Path

import psutil

from services.support.cgroup import own_cgroup, upwards


class CpuMeter:
    """Cores granted to this process's control group, and cores in use on them since the last reading."""

    def __init__(self, cgroup: Path | None = None) -> None:
        self._cpus = sorted(os.sched_getaffinity(0))
        self._quota_cores, self._cgroup = _tightest_quota(cgroup if cgroup is not None else own_cgroup())
        self._read_at = time.monotonic()
        self._usage_s = _usage_s(self._cgroup)
        psutil.cpu_percent(percpu=True)

    @property
    def granted_cores(self) -> float:
        """CPU seconds a second that may be used."""
        cores = float(len(self._cpus))
        return cores if self._quota_cores is None else min(cores, self._quota_cores)

    def used_cores(self) -> float:
        """CPU seconds a second in use since the call before, on the granted cores; under a quota, by those who share it."""
        now = time.monotonic()
        percent = psutil.cpu_percent(percpu=True)
        on_cpus = sum(percent[cpu] for cpu in self._cpus if cpu < len(percent)) / 100
        elapsed, self._read_at = now - self._read_at, now
        usage_s = _usage_s(self._cgroup)
        before, self._usage_s = self._usage_s, usage_s
        if self._quota_cores is None or usage_s is None or before is None or elapsed <= 0:
            return min(on_cpus, self.granted_cores)
        # Whichever is closer to its limit is what limits us.
        by_quota = (usage_s - before) / elapsed
        return max(by_quota, on_cpus - (len(self._cpus) - self.granted_cores))


def _tightest_quota(cgroup: Path | None) -> tuple[float | None, Path | None]:
    """The smallest `cpu.max` from this control group up to the root, and the group that it is shared by."""
    smallest: float | None = None
    limited: Path | None = None
    for group in upwards(cgroup):
        try:
            quota, period = (group / "cpu.max").read_text().split()
            cores = float("inf") if quota == "max" else int(quota) / int(period)
        except (OSError, ValueError):
            cores = float("inf")
        if cores < (smallest or float("inf")):
            smallest, limited = cores, group
    return smallest, limited


def _usage_s(cgroup: Path | None) -> float | None:
    if cgroup is None:
        return None
    try:
        lines = (cgroup / "cpu.stat").read_text().splitlines()
        return next(int(line.split()[1]) for line in lines if line.startswith("usage_usec")) * 1e-6
    except (OSError, StopIteration, ValueError):
        return None
