"""Recovery of all lessons that were left, one after the other, as a recorder does it in part beside its loop."""

import threading
from pathlib import Path

from services.lesson.lesson_file import LessonWriter
from services.lesson.recovery import Left


def recover(folder: Path, run_ns: int) -> LessonWriter | None:
    """Complete all but the lesson that is to be gone on with; that one."""
    left = Left(folder)
    goes_on = left.cut_short(run_ns)
    left.complete(threading.Event())
    return goes_on
