"""`kinebox report`: what stays of a lesson's attempts, for programs, the gradebook, or on paper."""

import errno
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final, TypeVar, get_args

import typer

from models.errors import UserError
from models.teaching.schema import Language
from services.cli.lesson_attempts import attempts_of
from services.cli.progress import ProgressLine
from services.cli.pupil_option import sought
from services.evaluation.report import csv_file, json_file, page
from services.evaluation.report.sheet import NOBODY as NOBODY_ON_PAPER
from services.evaluation.report.sheet import LessonFacts, Sheet, Tried, sheet_of
from services.lesson.layout import SUFFIX
from services.lesson.lesson_reader import open_lesson
from services.logs.printable import printable
from services.support.new_file import write_new

FORMS: Final[dict[str, Callable[[Sheet], bytes]]] = {
    "json": lambda sheet: json_file.encode(sheet.report),
    "csv": lambda sheet: csv_file.encode(sheet.report),
    "html": page.encode,
}
LANGUAGES: Final[tuple[Language, ...]] = get_args(Language)

Choice = TypeVar("Choice", bound=str)


@dataclass(frozen=True)
class Order:
    """What is asked for.

    Attributes:
        form: key of `FORMS`.
        language: one of `LANGUAGES`; None for the site's.
        pupil: only the attempts of this code; None for all.
        again: evaluate the recorded motion, whatever was said on the day.
    """

    form: str = "html"
    language: str | None = None
    pupil: str | None = None
    again: bool = False


def write_report(file: Path, data: Path, site: Path | None, order: Order, out: Path | None) -> None:
    """Report a lesson to a file that is not there yet, or to stdout.

    Raises:
        UserError: what is asked for is not known, the lesson cannot be read, has no motion or no attempt, or the file cannot be
            written; nothing was written.
    """
    _require("format", order.form, tuple(FORMS))
    if order.language is not None:
        _require("language", order.language, LANGUAGES)
    if out is not None and out.exists():
        raise UserError(f"{out} is there already; remove it, or name another file with --out")
    report = FORMS[order.form](sheet(file, data, site, order))
    if out is None:
        sys.stdout.buffer.write(report)
        sys.stdout.buffer.flush()
        return
    try:
        write_new(out, report)
    except OSError as error:
        remedy = "make room there" if error.errno == errno.ENOSPC else "name another file with --out"
        raise UserError(f"{out} cannot be written: {error.strerror or 'it is there already'}; {remedy}") from error
    typer.echo(printable(str(out)))


def sheet(file: Path, data: Path, site: Path | None, order: Order) -> Sheet:
    """The report of a lesson's file; UserError as for `write_report`."""
    wanted = None if order.pupil is None else sought(order.pupil)
    with open_lesson(file) as lesson, ProgressLine() as progress:
        lesson.require_entries()
        attempts = attempts_of(lesson, data, site, progress, again=order.again)
        header = lesson.header
        facts = LessonFacts(
            name=file.name.removesuffix(SUFFIX),
            title=header.title,
            begun=header.begun,
            begun_ns=header.started_ns,
            seconds=lesson.summary().seconds,
            kinebox=header.kinebox,
            source=attempts.source,
        )
    language = attempts.taught.language if order.language is None else _require("language", order.language, LANGUAGES)
    tried = [Tried(feedback, feedback.pupil or NOBODY_ON_PAPER) for feedback in attempts.feedbacks]
    held = {one.pupil for one in tried}
    pupil = None if wanted is None else next((code for code in wanted if code in held), wanted[-1])
    return sheet_of(facts, tried, attempts.teachings, language, pupil)


def _require(what: str, given: str, known: tuple[Choice, ...]) -> Choice:
    for one in known:
        if one == given:
            return one
    raise UserError(f"there is no {what} '{given}'; choose one of {', '.join(known)}")
