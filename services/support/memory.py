"""How much memory can still be had: what the machine has to give, and what a control group allows of it."""

from pathlib import Path

import psutil

from services.support.cgroup import own_cgroup, upwards


def free_memory_mib(own: Path | None = None) -> float:
    """Memory that can be had without swapping, in MiB.

    Args:
        own: folder of this process's control group; found if it is left out.
    """
    free_mib = psutil.virtual_memory().available / 2**20
    return min([free_mib, *(_free_in_mib(group) for group in upwards(own or own_cgroup()))])


def _free_in_mib(group: Path) -> float:
    """What a control group has left; its file cache can be given back and does not count as used."""
    try:
        limit = (group / "memory.max").read_text().strip()
        if limit == "max":
            return float("inf")
        used = int((group / "memory.current").read_text())
        statistics = dict(line.split() for line in (group / "memory.stat").read_text().splitlines())
        return (int(limit) - used + int(statistics.get("inactive_file", 0))) / 2**20
    except (OSError, ValueError):
        return float("inf")
