"""`kinebox export`: a recorded lesson's motion, or one attempt of it, for other programs."""

import errno
from dataclasses import dataclass, replace
from pathlib import Path

import typer

from models.errors import UserError
from models.messages.pupil import NOBODY
from services.cli.attempt_number import attempt_in, require_attempt, told
from services.cli.duration import clock
from services.cli.lesson_attempts import attempts_of, recorded_feedbacks
from services.cli.progress import ProgressLine
from services.cli.pupil_option import written
from services.evaluation.report.document import Source
from services.evaluation.track import Track
from services.lesson.export.formats import files_of
from services.lesson.export.kinds import Format
from services.lesson.export.take import Take, TakeError
from services.lesson.layout import SUFFIX
from services.lesson.lesson_reader import Lesson, open_lesson
from services.lesson.replay import configuration
from services.lesson.stretches import LessonAttempt, Stretch, stretches
from services.logs.printable import printable
from services.support.new_file import write_new


@dataclass(frozen=True)
class Order:
    """What is asked for.

    Attributes:
        kind: the format.
        folder: where to; it is made if it is not there.
        attempt: of the lesson's attempts, counted from 1 as `kinebox report` does; all of the lesson if None.
        pupil: code that is put into the files; of one attempt, whose it was if this is empty.
        again: attempts are those that evaluation finds now, whatever was said on the day.
    """

    kind: Format
    folder: Path
    attempt: int | None = None
    pupil: str = NOBODY
    again: bool = False


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
    pupil = NOBODY if order.pupil == NOBODY else written(order.pupil)
    name = file.name.removesuffix(SUFFIX)
    with open_lesson(file) as lesson, ProgressLine() as progress:
        found = _stretches(lesson, data, site, progress, order)
        header = lesson.header
    if order.attempt is None:
        if len(found) > 1:
            typer.echo(_why_several(found), err=True)
        takes = _all(found, name, pupil, file)
        said = [f"{_size(take)}, {len(take.attempts)} attempt{'' if len(take.attempts) == 1 else 's'}" for take in takes]
    else:
        stretch, each = attempt_in(found, order.attempt, file, "export another")
        takes = [_one(stretch, each, name, pupil, file)]
        said = [f"{_size(takes[0])}, attempt {each.number}: {told(header, each)}"]
    files: dict[Path, bytes] = {}
    for take in takes:
        try:
            files |= {order.folder / label: content for label, content in files_of(take, order.kind).items()}
        except TakeError as error:
            raise UserError(f"{take.name} of lesson {file} {error}; choose trc or c3d, which need no bones") from error
    _write(files, order.folder)
    for take, what in zip(takes, said, strict=True):
        typer.echo(printable(f"{order.folder / f'{take.name}.{order.kind}'}: {what}"))


def _stretches(lesson: Lesson, data: Path, site: Path | None, progress: ProgressLine, order: Order) -> list[Stretch]:
    """With the attempts that were told on the day; if one is asked for and there are none, or `again`, with those found now."""
    frame_s = configuration(lesson.header.preset).frame_s
    lesson.require_entries()
    feedbacks = () if order.again else recorded_feedbacks(lesson)

    def watch(t_ns: int) -> None:
        progress.show(f"read {clock(max(t_ns - lesson.header.started_ns, 0) * 1e-9)}")

    source: Source = "recorded"
    if order.again or (order.attempt is not None and not feedbacks):
        attempts = attempts_of(lesson, data, site, progress, again=order.again)
        feedbacks, source = attempts.feedbacks, attempts.source
    if order.attempt is not None:
        numbers = range(1, len(feedbacks) + 1)
        require_attempt(numbers, order.attempt, lesson.path, "leave out --attempt", source, again=order.again)
    found = stretches(lesson.parts(), frame_s, feedbacks, watch, only=order.attempt)
    if not found and order.attempt is None:
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


def _why_several(found: list[Stretch]) -> str:
    """No figure is measured across a gap, nor across the end of a film that begins again."""
    gaps = found[-1].segment - found[0].segment
    begun = len(found) - len({stretch.segment for stretch in found})  # A segment between two gaps may hold no motion.
    why = [f"its recording has {gaps} gap{'' if gaps == 1 else 's'}"] if gaps else []
    why += [f"its film or its cameras began anew {begun} time{'' if begun == 1 else 's'}"] if begun else []
    return f"note: the lesson is in {len(found)} pieces, each with its own time from 0: {', and '.join(why)}"


def _one(stretch: Stretch, attempt: LessonAttempt, name: str, pupil: str, file: Path) -> Take:
    try:
        return _take(stretch.of_attempt(attempt), f"{name}-attempt{attempt.number}", pupil or attempt.pupil)
    except TakeError as error:
        raise UserError(f"attempt {attempt.number} of lesson {file} {error}; export another") from error


def _take(stretch: Stretch, name: str, pupil: str) -> Take:
    """Times count from the first frame."""
    first_s, track = float(stretch.track.t_s[0]), stretch.track
    moved = Track(track.t_s - first_s, track.joints_m, track.covariance_m2, track.states)
    attempts = []
    for each in stretch.attempts:
        start, exertion, peak, end = (min(max(t_s - first_s, 0.0), float(moved.t_s[-1])) for t_s in each.found.moments_s)
        attempts.append(replace(each.found, moments_s=(start, exertion, peak, end)))
    return Take(moved, name, pupil, tuple(attempts))


def _size(take: Take) -> str:
    return f"{len(take.track)} frames, {clock(len(take.track) / take.rate_hz)}"


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
