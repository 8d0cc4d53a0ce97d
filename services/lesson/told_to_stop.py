"""That somebody ended a lesson holds for as long as the box runs, also for a recorder that is started again meanwhile.

An automatic recorder would else begin the next lesson a second after it died. The note is a name without a content, which a full
disk has room for, too, and is of one run of the box: the next one records by itself again.
"""

from pathlib import Path

SUFFIX = ".told-to-stop"


def note(folder: Path, run_ns: int) -> None:
    """Note that no lesson shall begin by itself in this run any more; notes of earlier runs go.

    Args:
        folder: of the lessons.
        run_ns: CLOCK_MONOTONIC at the start of this run of the box.

    Raises:
        OSError: it cannot be noted.
    """
    mine = _note(folder, run_ns)
    mine.touch()
    for other in set(folder.glob(f".*{SUFFIX}")) - {mine}:
        other.unlink(missing_ok=True)


def is_noted(folder: Path, run_ns: int) -> bool:
    """Whether that was noted in this run."""
    return _note(folder, run_ns).exists()


def _note(folder: Path, run_ns: int) -> Path:
    return folder / f".{run_ns}{SUFFIX}"
