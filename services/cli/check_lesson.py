"""`kinebox replay FILE --check`: whether a lesson comes out of fusion again as it was, bit for bit, and if not, why."""

import time
from collections.abc import Iterable, Iterator
from pathlib import Path

import typer

from models.errors import UserError
from services.cli.duration import clock
from services.cli.progress import ProgressLine
from services.lesson import origin
from services.lesson.lesson_header import LessonHeader
from services.lesson.lesson_reader import open_lesson
from services.lesson.replay import Comparison, Replayed, compare, configuration, replay
from services.logs.printable import printable
from services.support.version import kinebox_version


def check_lesson(file: Path) -> bool:
    """Replay a lesson as fast as it goes and say what came out; whether all motions were equal.

    Raises:
        UserError: the file is no lesson that can be read and replayed, or there is nothing in it to compare.
    """
    with open_lesson(file) as lesson, ProgressLine() as progress:
        header = lesson.header
        changed = what_changed(header)
        # First of all: whoever reads on shall know what to expect.
        for line in changed:
            typer.echo(f"note: {line}", err=True)
        progress.show("getting ready; the first time on a machine, kernels are compiled for a minute or two")
        began_s = time.monotonic()
        items = replay(lesson.parts(), header.rig(), configuration(header.preset))
        lesson.require_entries()
        found = compare(_watched(items, header.started_ns, progress))
    if found.compared == 0:
        raise UserError(f"lesson {file} holds no motion that could be compared: it ended too early; check a longer one")
    typer.echo(report(found, header, changed, time.monotonic() - began_s))
    return found.first is None


def what_changed(header: LessonHeader) -> list[str]:
    """What is not as it was when the lesson was recorded, as far as motions depend on it."""
    here = kinebox_version()
    version = [] if header.kinebox == here else [f"recorded with KineBox {header.kinebox}, this is {here}"]
    return [printable(line) for line in version + origin.differences(header.machine, origin.machine())]


def report(found: Comparison, header: LessonHeader, changed: list[str], took_s: float) -> str:
    """The outcome in words.

    Args:
        found: the comparison.
        header: of the lesson.
        changed: as `what_changed` says.
        took_s: how long the replay took.
    """
    segments = f"{found.segments} segment{'' if found.segments == 1 else 's'}"
    if found.first is None:
        return f"all {found.compared} motions are equal bit for bit ({segments}, replayed in {took_s:.1f} s)"
    first = found.first
    lines = [
        f"{found.equal} of {found.compared} motions are equal ({segments}, replayed in {took_s:.1f} s)",
        f"the first that is not: number {first.sequence} of segment {first.segment + 1}, "
        f"{clock(max(first.t_ns - header.started_ns, 0) * 1e-9)} into the lesson: {first.what}",
    ]
    if changed:
        lines.append(f"likely cause: {'; '.join(changed)}")
    else:
        lines.append("machine and versions are the same, so the file was altered, or this is a fault of KineBox: please report it")
    return "\n".join(lines)


def _watched(items: Iterable[Replayed], started_ns: int, progress: ProgressLine) -> Iterator[Replayed]:
    for item in items:
        if item.entry.kind == "tick":
            progress.show(f"replayed {clock(max(item.entry.t_ns - started_ns, 0) * 1e-9)}")
        yield item
