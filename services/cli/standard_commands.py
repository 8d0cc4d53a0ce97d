"""The command line of `kinebox standard`: list, record, import, restore. As in `main`, each imports what it needs when it runs."""

import os
from pathlib import Path
from typing import Annotated

import typer

from services.cli.data_option import DataFolder

Site = Annotated[
    Path | None,
    typer.Option("--site", help="The site file, if its 'teaching' names another folder than the usual one."),
]
Seconds = float | None

standard_app = typer.Typer(help="Standards: how an action is done well.", no_args_is_help=True)


def add_to(app: typer.Typer) -> None:
    """Make the commands part of `kinebox`."""
    app.add_typer(standard_app, name="standard")


@standard_app.command("list")
def standard_list(
    data: DataFolder = Path("build"),
    site: Site = None,
    json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.", show_default=False)] = False,
) -> None:
    """List which standards count, and which can count again."""
    from services.cli import standards  # noqa: PLC0415

    standards.listed(data, site, json=json)


@standard_app.command("record")
def standard_record(
    lesson: Annotated[str, typer.Argument(help="A lesson's name, as 'kinebox lessons' lists it, or a file.")],
    attempt: Annotated[int, typer.Option(min=1, help="The lesson's attempt of this number.", metavar="N", show_default=False)],
    action: Annotated[str | None, typer.Option(help="Of which action; the one that was tried if left out.")] = None,
    again: Annotated[
        bool, typer.Option("--again", help="Attempts are those that are found by what is taught today.", show_default=False)
    ] = False,
    data: DataFolder = Path("build"),
    site: Annotated[Path | None, typer.Option("--site", help="The site file to go by, in the place of the lesson's own.")] = None,
) -> None:
    """Make an attempt of a lesson the standard of its action."""
    from services.support.environment import process_environment  # noqa: PLC0415

    os.environ.update(process_environment(data))  # before numpy and numba are imported
    from services.cli import lessons, new_standards  # noqa: PLC0415

    order = new_standards.Record(attempt, action, again)
    new_standards.record(lessons.find(lesson, lessons.folder_of(data, site)), data, site, order)


@standard_app.command("import")
def standard_import(
    file: Annotated[Path, typer.Argument(help="A TRC, C3D or BVH file, or a standard of another school (.npz).", dir_okay=False)],
    action: Annotated[str, typer.Option(help="Of which action it is to be the standard.", show_default=False)],
    attempt: Annotated[int | None, typer.Option(min=1, help="Of several attempts, the one of this number.", metavar="N")] = None,
    unit: Annotated[str | None, typer.Option(help="Of a BVH file, which says none: m, cm, mm, in, or cmu.", metavar="UNIT")] = None,
    start: Annotated[Seconds, typer.Option(help="Keyframes, in seconds from the first frame: all four, or none.")] = None,
    exertion: Annotated[Seconds, typer.Option()] = None,
    peak: Annotated[Seconds, typer.Option()] = None,
    end: Annotated[Seconds, typer.Option()] = None,
    data: DataFolder = Path("build"),
    site: Site = None,
) -> None:
    """Make a motion or standard from elsewhere the standard.

    The motion of another program, or the standard of another school.
    """
    from services.support.environment import process_environment  # noqa: PLC0415

    os.environ.update(process_environment(data))  # before numpy and numba are imported
    from services.cli import new_standards  # noqa: PLC0415

    new_standards.bring_in(file, data, site, new_standards.Import(action, attempt, (start, exertion, peak, end), unit))


@standard_app.command("restore")
def standard_restore(
    action: Annotated[str, typer.Argument(help="Its action.")],
    version: Annotated[
        str | None, typer.Argument(help="A number from the list, or 'shipped'; if left out, the next lower number than counts now.")
    ] = None,
    data: DataFolder = Path("build"),
    site: Site = None,
) -> None:
    """Make a standard that counted before count again.

    The one that counts now is kept.
    """
    from services.cli import standards  # noqa: PLC0415

    standards.restore(action, version, data, site)
