"""`kinebox lessons`: what has been recorded; finding one, and removing one."""

import sys
from pathlib import Path

import msgspec
import typer
from rich.console import Console
from rich.table import Table

from models.config.site import LessonsConfig
from models.errors import UserError
from services.cli.duration import clock
from services.cli.printed import print_for_programs
from services.lesson.index import NAME, LessonIndex, LessonRow
from services.lesson.layout import PART_SUFFIX, SUFFIX
from services.lesson.lesson_file import ENDED_SUFFIX
from services.lesson.lesson_reader import FINISHING
from services.lesson.local_time import local_time
from services.lesson.readable_names import readable
from services.logs.printable import printable
from services.site_file.reading import read_site
from services.support.called import as_called

_PIPE_WIDTH = 200


def folder_of(data: Path, site: Path | None) -> Path:
    """Where lessons are kept, from the root: as the site file says, or by default; UserError if that cannot be read."""
    config = LessonsConfig() if site is None else read_site(site)[0].lessons
    return (data / config.folder).resolve()


def require_data(data: Path) -> None:
    """Raise UserError if there is no data folder: an empty list would be no answer."""
    if not data.is_dir():
        raise UserError(f"there is no data folder {data.resolve()}; name the box's with --data")


def listed(folder: Path, *, json: bool) -> None:
    """Print the lessons of a folder, the newest first."""
    rows = LessonIndex(folder).lessons() if folder.is_dir() else []
    if json:
        entries = msgspec.json.encode([_entry(folder, row) for row in rows])
        print_for_programs(f"{msgspec.json.format(entries).decode()}\n")
        return
    if not rows:
        typer.echo(as_called(f"no lesson in {printable(str(folder))}; 'kinebox record' records one"))
        return
    table = Table(box=None, header_style="bold", pad_edge=False)
    table.add_column("lesson", no_wrap=True)  # it is copied from here
    for column in ("title", "begun", "length", "MB", "state", "gaps"):
        table.add_column(column, justify="right" if column in {"length", "MB", "gaps"} else "left")
    for row in rows:
        begun = f"{local_time(row.started_s):%Y-%m-%d %H:%M}"
        table.add_row(
            printable(row.lesson),
            printable(row.title),
            begun,
            clock(row.seconds),
            f"{row.bytes / 1e6:.1f}",
            row.state,
            str(row.gaps),
        )
    # A pipe has no edge: a line a lesson there.
    Console(highlight=False, markup=False, width=None if sys.stdout.isatty() else _PIPE_WIDTH).print(table)
    for row in rows:
        if row.problem:
            typer.echo(as_called(printable(f"{row.lesson}: {row.problem}")), err=True)


def find(lesson: str, folder: Path) -> Path:
    """The file of a lesson that is named by its path or its name in the list.

    Raises:
        UserError: there is none.
    """
    path = Path(lesson)
    if path.exists() or path.suffix == SUFFIX or len(path.parts) > 1:
        return path
    for suffix in (SUFFIX, PART_SUFFIX, ENDED_SUFFIX):
        if (folder / f"{lesson}{suffix}").is_file():
            return folder / f"{lesson}{suffix}"
    raise UserError(f"no lesson '{lesson}' in {folder}; 'kinebox lessons' lists what there is")


def delete(lesson: str, folder: Path, *, sure: bool) -> None:
    """Remove a finished lesson for good, after a question unless `sure`.

    Raises:
        UserError: there is none of that name, it is being recorded, or it cannot be removed.
    """
    file = folder / f"{lesson}{SUFFIX}"
    if Path(lesson).name != lesson or not file.is_file():
        if any((folder / f"{Path(lesson).name}{suffix}").is_file() for suffix in (PART_SUFFIX, ENDED_SUFFIX)):
            raise UserError(f"lesson '{lesson}' is not finished; {FINISHING}")
        raise UserError(f"no lesson '{lesson}' in {folder}; 'kinebox lessons' lists what there is")
    if not sure and not typer.confirm(f"Remove {printable(str(file))} for good?"):
        typer.echo("nothing was removed")
        return
    try:
        file.unlink()
    except OSError as error:
        raise UserError(f"{file} cannot be removed: {error.strerror}; correct its permissions") from error
    if (folder / NAME).is_file():
        LessonIndex(folder).lessons()
    typer.echo(f"removed {printable(str(file))}")


def _entry(folder: Path, row: LessonRow) -> dict[str, object]:
    """A lesson as programs read it."""
    return {
        "lesson": row.lesson,
        "title": row.title,
        "begun": local_time(row.started_s).isoformat(timespec="seconds"),
        "seconds": round(row.seconds, 3),
        "bytes": row.bytes,
        "state": row.state,
        "gaps": row.gaps,
        "segments": row.segments,
        "problem": row.problem,
        "file": readable(str(folder / row.file)),
    }
