"""The commands about lessons: record, replay, export, report, lessons. As in `main`, each imports what it needs when it runs."""

import os
from pathlib import Path
from typing import Annotated

import typer

from models.errors import UserError
from services.cli.data_option import DataFolder
from services.lesson.export.kinds import Format, format_of

SiteFile = Annotated[Path, typer.Option("--site", help="The site file of the box that runs.")]
LessonSite = Annotated[Path | None, typer.Option("--site", help="The site file, if it names another folder of lessons.")]
ReportSite = Annotated[Path | None, typer.Option("--site", help="The site file to go by, in the place of the lesson's own.")]

lessons_app = typer.Typer(help="List what was recorded, or remove some of it.")


def add_to(app: typer.Typer) -> None:
    """Make the commands part of `kinebox`."""
    app.command()(record)
    app.command()(replay)
    app.command()(export)
    app.command()(report)
    app.add_typer(lessons_app, name="lessons")


def record(
    site: SiteFile,
    data: DataFolder = Path("build"),
    title: Annotated[str, typer.Option(help="What people call the lesson.")] = "",
    length: Annotated[str | None, typer.Option("--for", help="End it after so long: 45m, 90s, 1h30m.", metavar="LENGTH")] = None,
    detach: Annotated[bool, typer.Option("--detach", help="Begin the lesson and leave it running.", show_default=False)] = False,
    stop: Annotated[bool, typer.Option("--stop", help="End the lesson that is being recorded.", show_default=False)] = False,
) -> None:
    """Have the running box record a lesson, and end it on Ctrl-C."""
    from services.cli import record as recording  # noqa: PLC0415
    from services.cli.duration import parse_duration  # noqa: PLC0415
    from services.logs import of_command  # noqa: PLC0415
    from services.site_file.reading import read_site  # noqa: PLC0415

    if stop and (detach or title or length):
        raise UserError("--stop goes with no other option of 'kinebox record' but --site and --data; leave the others out")
    if detach and length:
        raise UserError("--detach does not go with --for: nobody stays to end the lesson; end it with 'kinebox record --stop'")
    seconds = None if length is None else parse_duration(length, "--for")
    of_command.configure()
    box, _ = read_site(site)
    if stop:
        recording.end(box, data)
    elif detach:
        recording.begin(box, data, title)
    else:
        recording.record(box, data, title, seconds)


def replay(
    lesson: Annotated[str, typer.Argument(help="A lesson's name, as 'kinebox lessons' lists it, or a file.")],
    check: Annotated[
        bool, typer.Option("--check", help="Only compare what comes out with what was recorded; exit code 1 if it differs.")
    ] = False,
    speed: Annotated[float, typer.Option(min=0.1, max=8.0, help="Seconds of the lesson a second.")] = 1.0,
    loop: Annotated[bool, typer.Option("--loop/--once", help="Begin again at the end, or end.")] = True,
    host: Annotated[str, typer.Option(help="Where the page listens; 0.0.0.0 shows it to other machines too.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=1, max=65535, help="Port of the page.")] = 8080,
    data: DataFolder = Path("build"),
    site: LessonSite = None,
) -> None:
    """Play a lesson into the page, or check it bit for bit."""
    from services.support.environment import process_environment  # noqa: PLC0415

    os.environ.update(process_environment(data))  # before numpy and numba are imported
    from services.cli import lessons  # noqa: PLC0415

    file = lessons.find(lesson, lessons.folder_of(data, site))
    if check:
        from services.cli.check_lesson import check_lesson  # noqa: PLC0415

        raise typer.Exit(0 if check_lesson(file) else 1)
    from models.config.site import TabletConfig  # noqa: PLC0415
    from services.cli.replay import play  # noqa: PLC0415

    play(file, data, TabletConfig(host=host, port=port), speed, loop=loop)


def export(
    lesson: Annotated[str, typer.Argument(help="A lesson's name, as 'kinebox lessons' lists it, or a file.")],
    kind: Annotated[
        str, typer.Option("--format", help="What the other program reads.", metavar="|".join(Format), show_default=False)
    ],
    out: Annotated[Path, typer.Option(help="The folder to write into.", file_okay=False)] = Path(),
    attempt: Annotated[int | None, typer.Option(min=1, help="Only the lesson's attempt of this number.", metavar="N")] = None,
    pupil: Annotated[
        str, typer.Option(help="The pupil's code, to stand in the files; of one attempt, the lesson's if left out.")
    ] = "",
    again: Annotated[
        bool, typer.Option("--again", help="Attempts are those that are found by what is taught today.", show_default=False)
    ] = False,
    data: DataFolder = Path("build"),
    site: LessonSite = None,
) -> None:
    """Write a lesson's motion, or an attempt, for other programs.

    A lesson becomes one file; each gap, and each time that its film began anew, begins another.
    """
    from services.support.environment import process_environment  # noqa: PLC0415

    os.environ.update(process_environment(data))  # before numpy and numba are imported
    from services.cli import lessons  # noqa: PLC0415
    from services.cli.export import Order  # noqa: PLC0415
    from services.cli.export import export as write  # noqa: PLC0415

    order = Order(format_of(kind), out, attempt, pupil, again)
    write(lessons.find(lesson, lessons.folder_of(data, site)), data, site, order)


def report(
    lesson: Annotated[str, typer.Argument(help="A lesson's name, as 'kinebox lessons' lists it, or a file.")],
    form: Annotated[str, typer.Option("--format", help="html to print, csv for the gradebook, json for programs.")] = "html",
    out: Annotated[Path | None, typer.Option(help="The file to write; stdout if left out.")] = None,
    language: Annotated[str | None, typer.Option(help="en, zh, de or es; the site's if left out.")] = None,
    pupil: Annotated[str | None, typer.Option(help="Only the attempts of this code; - for those of nobody.")] = None,
    again: Annotated[
        bool, typer.Option("--again", help="Evaluate the recorded motion anew, by what is taught today.", show_default=False)
    ] = False,
    data: DataFolder = Path("build"),
    site: ReportSite = None,
) -> None:
    """Report a lesson's attempts: a page to print, a table, or JSON."""
    from services.support.environment import process_environment  # noqa: PLC0415

    os.environ.update(process_environment(data))  # before numpy and numba are imported
    from services.cli import lessons  # noqa: PLC0415
    from services.cli.report import Order, write_report  # noqa: PLC0415

    write_report(lessons.find(lesson, lessons.folder_of(data, site)), data, site, Order(form, language, pupil, again), out)


@lessons_app.callback(invoke_without_command=True)
def lessons_list(
    context: typer.Context,
    data: DataFolder = Path("build"),
    site: LessonSite = None,
    json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.", show_default=False)] = False,
) -> None:
    """List what was recorded, the newest first."""
    if context.invoked_subcommand is None:
        from services.cli import lessons  # noqa: PLC0415
        from services.logs import of_command  # noqa: PLC0415

        of_command.configure()
        lessons.require_data(data)
        lessons.listed(lessons.folder_of(data, site), json=json)


@lessons_app.command("delete")
def lessons_delete(
    lesson: Annotated[str, typer.Argument(help="The lesson's name, as it is listed.")],
    data: DataFolder = Path("build"),
    site: LessonSite = None,
    yes: Annotated[bool, typer.Option("--yes", help="Do not ask.", show_default=False)] = False,
) -> None:
    """Remove a lesson for good."""
    from services.cli import lessons  # noqa: PLC0415
    from services.logs import of_command  # noqa: PLC0415

    of_command.configure()
    lessons.delete(lesson, lessons.folder_of(data, site), sure=yes)
