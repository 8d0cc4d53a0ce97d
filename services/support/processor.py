"""What Linux says of the processor."""

from dataclasses import dataclass
from pathlib import Path

_CPUINFO = Path("/proc/cpuinfo")


@dataclass(frozen=True)
class Processor:
    """The first one of the machine.

    Attributes:
        name: as its maker calls it, or the board if it has no name; empty if neither is known.
        features: what it can do ("avx2", "asimd"), in the kernel's order.
    """

    name: str
    features: tuple[str, ...]


def processor(cpuinfo: Path = _CPUINFO) -> Processor:
    """The processor by /proc/cpuinfo, which has other words on ARM than on x86; nothing is known where that cannot be read."""
    entries: dict[str, str] = {}
    try:
        for line in cpuinfo.read_text().splitlines():
            key, _, value = line.partition(":")
            entries.setdefault(key.strip(), value.strip())
    except OSError:
        pass
    features = entries.get("flags") or entries.get("Features") or ""
    return Processor(entries.get("model name") or entries.get("Model") or "", tuple(features.split()))
