"""This process's control group (version 2), in which the machine's owner may limit what the box uses."""

from collections.abc import Iterator
from pathlib import Path

_ROOT = Path("/sys/fs/cgroup")


def own_cgroup() -> Path | None:
    """Folder of this process's control group; None where there is none."""
    try:
        line = Path("/proc/self/cgroup").read_text().splitlines()[-1]
    except (OSError, IndexError):
        return None
    folder = _ROOT / line.split(":")[-1].lstrip("/")
    return folder if folder.is_dir() else None


def upwards(group: Path | None) -> Iterator[Path]:
    """A control group and all above it: each may be the one that limits."""
    while group is not None and group != group.parent:
        yield group
        group = group.parent if group != _ROOT else None
