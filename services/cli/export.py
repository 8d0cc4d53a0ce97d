"""`kinebox export`: a recorded lesson's motion, or one attempt of it, for other programs."""

import errno
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import typer

from models.errors import UserError
from services.cli.duration import clock
from services.cli.lesson_attempts import attempts_of, recorded_feedbacks
from services.cli.progress import ProgressLine
from services.evaluation.track import Track
from services.lesson.export.formats import files_of
from services.lesson.export.kinds import Format
from services.lesson.export.take import Take, TakeError
from services.lesson.layout import SUFFIX
from services.lesson.lesson_reader import Lesson, open_lesson
from services.lesson.replay import configuration
from services.lesson.stretches import Stretch, stretches
from services.logs.printable import printable
from services.support.new_file import write_new

_LONGEST_CODE = 40


@dataclass(frozen=True)
class Order:
    """What is asked for.

    Attributes:
        kind: the format.
        folder: where to; it is made if it is not there.
        attempt: of the lesson's attempts, counted from 1 as `kinebox report` does; all of the lesson if None.
        pupil: code that is put into the files.
    """

    kind: Format
    folder: Path
    attempt: int | None = None
    pupil: str = ""


def export(file: Path, data: Path, site: Path | None, order: Order) -> None:
    """Write a lesson's motion into a folder, and say what was written.

    Args:
        file: of the lesson.
        data: the data folder, with the school's own teaching.
        site: the site file, if attempts shall be looked for by another than the lesson's own.
        order: what is asked for.

    Raises:
        UserError: the pupil has no code that can be written, the file is no lesson that can be read, there is nothing in it to
            export, there is no such attempt, or it cannot be written; nothing was written then, or only files before it, whole.
    """
    if not (order.pupil.isprintable() and len(order.pupil) <= _LONGEST_CODE):
        raise UserError(f"--pupil: a code has at most {_LONGEST_CODE} characters that can be printed; choose another")
    name = file.name.removesuffix(SUFFIX)
    with open_lesson(file) as lesson, ProgressLine() as progress:
        found = _stretches(lesson, data, site, progress, evaluate=order.attempt is not None)
    takes = _all(found, name, order.pupil, file) if order.attempt is None else [_one(found, order.attempt, name, order.pupil, file)]
    files: dict[Path, bytes] = {}
    for take in takes:
        try:
            files |= {order.folder / label: content for label, content in files_of(take, order.kind).items()}
        except TakeError as error:
            raise UserError(f"{take.name} of lesson {file} {error}; choose trc or c3d, which need no bones") from error
    _write(files, order.folder)
    for take in takes:
        typer.echo(printable(f"{order.folder / f'{take.name}.{order.kind}'}: {_told(take)}"))


def _stretches(lesson: Lesson, data: Path, site: Path | None, progress: ProgressLine, *, evaluate: bool) -> list[Stretch]:
    """Attempts are those that were told on the day; if there are none and `evaluate`, those that are found now."""
    frame_s = configuration(lesson.header.preset).frame_s
    lesson.require_entries()
    feedbacks = recorded_feedbacks(lesson)

    def watch(t_ns: int) -> None:
        progress.show(f"read {clock(max(t_ns - lesson.header.started_ns, 0) * 1e-9)}")

    if evaluate and not feedbacks:
        feedbacks = attempts_of(lesson, data, site, progress).feedbacks
    found = stretches(lesson.parts(), frame_s, feedbacks, watch)
    if not found:
        raise UserError(f"lesson {lesson.path} holds no motion: it ended too early; export a longer one")
    return found


def _all(found: list[Stretch], name: str, pupil: str, file: Path) -> list[Take]:
    """A take of each stretch in which something is known."""
    takes = []
    for number, stretch in enumerate(found, start=1):
        label = name if len(found) == 1 else f"{name}-{number}"
        try:
            takes.append(_take(stretch, label, pupil))
        except TakeError as error:
            reason = str(error)
            typer.echo(printable(f"left out: {label} {reason}"), err=True)
    if not takes:
        raise UserError(f"lesson {file} has nothing to export: nobody was seen in it; export one with a pupil")
    return takes


def _one(found: list[Stretch], attempt: int, name: str, pupil: str, file: Path) -> Take:
    numbers = [each.number for stretch in found for each in stretch.attempts]
    for stretch in found:
        for each in stretch.attempts:
            if each.number == attempt:
                try:
                    return _take(stretch.of_attempt(each), f"{name}-attempt{attempt}", pupil)
                except TakeError as error:
                    raise UserError(f"attempt {attempt} of lesson {file} {error}; export another") from error
    if not numbers:
        raise UserError(f"lesson {file} holds no attempts that were found; leave out --attempt")
    raise UserError(f"lesson {file} has no attempt {attempt}; it has {_ranges(numbers)}")


def _take(stretch: Stretch, name: str, pupil: str) -> Take:
    """Times count from the first frame."""
    first_s, track = float(stretch.track.t_s[0]), stretch.track
    moved = Track(track.t_s - first_s, track.joints_m, track.covariance_m2, track.states)
    attempts = []
    for each in stretch.attempts:
        start, exertion, peak, end = (min(max(t_s - first_s, 0.0), float(moved.t_s[-1])) for t_s in each.found.moments_s)
        attempts.append(replace(each.found, moments_s=(start, exertion, peak, end)))
    return Take(moved, name, pupil, tuple(attempts))


def _ranges(numbers: list[int]) -> str:
    """1-4, 6: whole numbers that rise."""

    def spans() -> Iterator[str]:
        first = last = numbers[0]
        for number in [*numbers[1:], -1]:
            if number != last + 1:
                yield f"{first}-{last}" if last > first else f"{first}"
                first = number
            last = number

    return ", ".join(spans())


def _told(take: Take) -> str:
    attempts = len(take.attempts)
    return f"{len(take.track)} frames, {clock(len(take.track) / take.rate_hz)}, {attempts} attempt{'' if attempts == 1 else 's'}"


def _write(files: dict[Path, bytes], folder: Path) -> None:
    for path in files:
        if path.exists():
            raise UserError(f"{path} is there already; remove it, or name another folder with --out")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for path, data in files.items():
            write_new(path, data)
    except OSError as error:
        remedy = "make room there" if error.errno == errno.ENOSPC else "name another folder with --out"
        raise UserError(
            f"{error.filename or folder} cannot be written: {error.strerror or 'it is there already'}; {remedy}"
        ) from error
