"""Prints which standards count (`kinebox standard list`), and lets one count again that counted before (`restore`)."""

import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final, Literal

import msgspec
import typer
from rich.console import Console
from rich.table import Table

from models.errors import UserError
from models.teaching.standard import Standard
from services.cli.lessons import require_data
from services.cli.printed import print_for_programs
from services.lesson.readable_names import readable
from services.logs.printable import printable
from services.site_file.reading import read_site
from services.support.called import as_called
from services.support.own_standards import OwnStandards
from services.support.teaching_files import folder_of_own, own_folder

SHIPPED: Final = "shipped"
AT_NEXT_START: Final = "the box goes by it from its next start on"
_PIPE_WIDTH: Final = 200
_MOST_DIGITS: Final = 255
"""A version's number is part of its file's name, which is no longer."""


@dataclass(frozen=True)
class Row:
    """A standard as it is listed. What follows `file` is None if it cannot be read.

    Attributes:
        action: of which it is.
        counts: whether it is the one that pupils are compared with.
        whose: the school's own, or KineBox's.
        file: where it is; None for what KineBox brings.
        version, origin, stature_m: see `models.teaching.standard.Standard`; the version of what cannot be read is that of its name.
        seconds: from start to end.
        problem: why it cannot be read; empty if it can.
    """

    action: str
    counts: bool
    whose: Literal["own", "shipped"]
    file: str | None
    version: int | None
    origin: str | None = None
    stature_m: float | None = None
    seconds: float | None = None
    problem: str = ""


def own_standards(data: Path, site: Path | None) -> OwnStandards:
    """The school's own standards, in the folder that a site file names, or in the usual one.

    Raises:
        UserError: there is no data folder, the site file cannot be read, or the folder that it names does not exist.
    """
    require_data(data)
    teaching = "" if site is None else read_site(site)[0].evaluation.teaching
    return OwnStandards(own_folder(data, teaching) or folder_of_own(data, teaching))


def listed(data: Path, site: Path | None, *, json: bool) -> None:
    """Print the standards of all actions: the one that counts, and those that can count again; UserError as `own_standards`."""
    own = own_standards(data, site)
    rows = [row for action in own.actions for row in _rows(own, action)]
    if json:
        print_for_programs(f"{msgspec.json.format(msgspec.json.encode([asdict(row) for row in rows])).decode()}\n")
        return
    table = Table(box=None, header_style="bold", pad_edge=False)
    table.add_column("action", no_wrap=True)
    for column in ("version", "counts", "whose", "stature", "length", "origin"):
        table.add_column(column, justify="right" if column in {"version", "stature", "length"} else "left")
    for row in rows:
        table.add_row(
            printable(row.action),
            "" if row.version is None else str(row.version),
            "yes" if row.counts else "",
            row.whose,
            "" if row.stature_m is None else f"{row.stature_m:.2f} m",
            "" if row.seconds is None else f"{row.seconds:.1f} s",
            "cannot be read" if row.origin is None else printable(row.origin),
        )
    # A pipe has no edge: a line a standard there.
    console = Console(highlight=False, markup=False, width=None if sys.stdout.isatty() else _PIPE_WIDTH)
    with console.capture() as drawn:
        console.print(table)
    typer.echo("\n".join(line.rstrip() for line in drawn.get().splitlines()))
    for row in rows:
        if row.problem:
            typer.echo(as_called(printable(row.problem)), err=True)


def restore(action: str, version: str | None, data: Path, site: Path | None) -> None:
    """Make another version of a standard count again.

    Args:
        action: its action.
        version: a number, or `SHIPPED`; None for the next lower number that is kept, and KineBox's own below all of them.
        data: the data folder.
        site: the site file, if it names another folder.

    Raises:
        UserError: there is no such action or version, or it cannot be read or written; nothing was changed then.
    """
    own = own_standards(data, site)
    own.require(action)
    chosen = _before(own, action) if version is None else _chosen(own, action, version)
    if chosen == _counting(own, action):
        typer.echo(f"{action}: {_told(chosen)} counts already; nothing was changed")
        return
    if chosen == SHIPPED:
        own.bring_back_shipped(action)
    else:
        own.bring_back(action, int(chosen))
    typer.echo(printable(f"{action}: {_told(chosen)} counts again ({own.counts(action).origin}); {AT_NEXT_START}"))


def _counting(own: OwnStandards, action: str) -> int | str | None:
    """The version of the own one that counts, or `SHIPPED`.

    None if nothing counts, if it cannot be read, or if it has the number of another one that is kept: somebody copied it there.
    """
    try:
        standard = own.own(action)
        if standard is None:
            return None if own.shipped(action) is None else SHIPPED
        same = [own.is_counting(action, kept) for kept in own.kept(action) if kept.number == standard.version]
    except UserError:
        return None
    return standard.version if all(same) else None


def _before(own: OwnStandards, action: str) -> int | str:
    """The one with the next lower number, whatever counted in between: so, asked again and again, it goes back through all."""
    counting, numbers = _counting(own, action), [one.number for one in own.kept(action)]
    if counting == SHIPPED:
        remedy = f"name one of {', '.join(map(str, numbers))}" if numbers else "no other is kept"
        raise UserError(f"of '{action}' KineBox's own standard counts already; {remedy}")
    older = [number for number in numbers if counting is None or number < int(counting)]
    if older:
        return older[-1]
    if own.shipped(action) is None:
        raise UserError(f"of '{action}' no older standard is kept, and KineBox brings none")
    return SHIPPED


def _chosen(own: OwnStandards, action: str, version: str) -> int | str:
    shipped = own.shipped(action)
    if version == SHIPPED and shipped is not None:
        return SHIPPED
    if version.isascii() and version.isdigit() and len(version) <= _MOST_DIGITS:
        number = int(version)
        if number == _counting(own, action) or number in {one.number for one in own.kept(action)}:
            return number
        if shipped is not None and number == shipped.version:
            return SHIPPED
    raise UserError(f"'{action}' has no version '{version}'; there are {_there(own, action)}")


def _there(own: OwnStandards, action: str) -> str:
    """All that can be named, in words."""
    counting = _counting(own, action)
    numbers = {one.number for one in own.kept(action)} | ({counting} if isinstance(counting, int) else set())
    return ", ".join([*map(str, sorted(numbers)), *([SHIPPED] if own.shipped(action) is not None else [])])


def _told(chosen: int | str) -> str:
    return "KineBox's own standard" if chosen == SHIPPED else f"version {chosen}"


def _rows(own: OwnStandards, action: str) -> Iterator[Row]:
    """Of one action: what counts, then those that are kept, the newest first, then what KineBox brings."""
    shipped, file = own.shipped(action), own.file(action)
    if file.exists():
        try:
            standard = own.counts(action)
        except UserError as error:
            yield Row(action, counts=True, whose="own", file=readable(str(file)), version=None, problem=str(error))
        else:
            yield _row(action, standard, file, counts=True)
    for kept in reversed(own.kept(action)):
        if own.is_counting(action, kept):
            continue  # It was brought back.
        try:
            yield _row(action, kept.read(), kept.file, counts=False, number=kept.number)
        except UserError as error:
            yield Row(action, counts=False, whose="own", file=readable(str(kept.file)), version=kept.number, problem=str(error))
    if shipped is not None:
        yield _row(action, shipped, None, counts=not file.exists())


def _row(action: str, standard: Standard, file: Path | None, *, counts: bool, number: int | None = None) -> Row:
    return Row(
        action,
        counts,
        "shipped" if file is None else "own",
        None if file is None else readable(str(file)),
        standard.version if number is None else number,
        standard.origin,
        round(standard.stature_m, 3),
        round(standard.moments_s[-1] - standard.moments_s[0], 3),
    )
