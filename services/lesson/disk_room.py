"""Whether a disk has room for a lesson: the recorder goes by it, and the doctor foretells it. Pure."""

from pathlib import Path

from models.config.site import LessonsConfig
from services.support.amount import megabytes

LESSON_MB = 200
"""A lesson of 45 minutes takes up to 150 MB (`make bench-lessons`), and others write beside it."""


def shortage(free_mib: float, config: LessonsConfig) -> str:
    """Why a disk with so much left takes no lesson; empty if it does, or if how much is left is not known (NaN)."""
    free_mb = megabytes(free_mib)
    if not free_mb < config.least_free_mb:
        return ""
    return f"{free_mb:.0f} MB are left on the disk, lessons.least_free_mb is {config.least_free_mb}"


def make_room(folder: Path, config: LessonsConfig) -> str:
    """What to do about it: where, and how much the next lesson needs."""
    needed_mb = config.least_free_mb + LESSON_MB
    return f"remove lessons that are not needed, or other files on the disk of {folder}, until {needed_mb} MB are free"
