"""What a lesson's motions depend on to the last bit, beside the lesson itself: the processor, the libraries, and our own code.

Kernels are compiled for the processor that they run on, with sums reordered so that they vectorise; another processor or another
compiler rounds otherwise in the last digits. The code is told by its content, since a version number outlives many changes.
"""

import hashlib
import platform
import zlib
from importlib.metadata import version
from pathlib import Path

from services.support.processor import Processor, processor

_LIBRARIES = ("numpy", "scipy", "numba", "llvmlite")
_ROOT = Path(__file__).parents[2]
_CODE = ("models/*.py", "models/camera/*.py", "models/messages/*.py", "models/skeleton/*.py", "services/fusion/*.py")
_SEPARATOR = "; "


def machine() -> str:
    """This machine and what is installed on it, as `LessonHeader.machine` keeps it: facts with semicolons between them."""
    libraries = [f"{name} {version(name)}" for name in _LIBRARIES]
    return _SEPARATOR.join([_told(processor()), f"Python {platform.python_version()}", *libraries, f"fusion code {_code(_ROOT)}"])


def differences(recorded: str, here: str) -> list[str]:
    """What is not the same, each in words; empty if a replay must give the same bits.

    Args:
        recorded: `machine()` where the lesson was recorded.
        here: `machine()` where it is replayed.
    """
    before, now = recorded.split(_SEPARATOR), here.split(_SEPARATOR)
    if len(before) != len(now):
        return [f"recorded on {recorded}; this is {here}"]
    return [f"recorded with {was}, this is {is_now}" for was, is_now in zip(before, now, strict=True) if was != is_now]


def _told(found: Processor) -> str:
    """The processor's name, and its features as a check sum: a virtual machine may hide some of them."""
    name = found.name or platform.machine()
    features = " ".join(sorted(found.features))
    return f"{name.replace(_SEPARATOR, ', ')}, features {zlib.crc32(features.encode()):08x}"


def _code(root: Path) -> str:
    """Check sum of the sources that fusion consists of."""
    total = hashlib.sha256()
    for pattern in _CODE:
        for file in sorted(root.glob(pattern)):
            total.update(f"{file.relative_to(root)}\0".encode() + file.read_bytes() + b"\0")
    return total.hexdigest()[:8]
