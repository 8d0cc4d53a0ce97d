"""The commands that show and pack the log."""

from pathlib import Path
from typing import Annotated

import typer

from services.cli.data_option import DataFolder

Since = Annotated[
    str | None, typer.Option(metavar="WHEN", help="Lines from then on: 90s, 10m, 1h30m ago, or a time like 2026-11-22T10:00.")
]
Level = Annotated[str, typer.Option(metavar="LEVEL", help="Lines of this level and worse: debug, info, warning, error, critical.")]
Processes = Annotated[
    list[str] | None, typer.Option("--process", metavar="NAME", help="Lines of this process; may be given again.")
]
Grep = Annotated[str, typer.Option(metavar="TEXT", help="Lines with this text, in upper or lower case.")]
Replay = Annotated[bool, typer.Option("--replay", help="The log of 'kinebox replay' in place of the box's.", show_default=False)]


def add_to(app: typer.Typer) -> None:
    """Add the commands to those of `kinebox`."""
    logs_app = typer.Typer(help="Look at the log of the box, or pack a part of it to be sent.")
    logs_app.callback(invoke_without_command=True)(logs_show)
    logs_app.command("export")(logs_export)
    app.add_typer(logs_app, name="logs")


def logs_show(
    context: typer.Context,
    data: DataFolder = Path("build"),
    since: Since = None,
    level: Level = "debug",
    process: Processes = None,
    grep: Grep = "",
    lines: Annotated[int, typer.Option("-n", "--lines", min=0, help="Print so many, the last ones.")] = 200,
    follow: Annotated[bool, typer.Option("--follow", "-f", help="Go on with new lines.", show_default=False)] = False,
    json: Annotated[bool, typer.Option("--json", help="Print JSON lines, for programs.", show_default=False)] = False,
    replay: Replay = False,
) -> None:
    """Print the log of the box, of all its processes."""
    if context.invoked_subcommand is None:
        from services.cli import logs  # noqa: PLC0415

        logs.show(data, logs.query_of(since, level, process, grep), lines, json=json, follow=follow, replay=replay)


def logs_export(
    file: Annotated[Path, typer.Argument(metavar="FILE.zip", help="The file to write.")],
    data: DataFolder = Path("build"),
    since: Since = None,
    level: Level = "debug",
    process: Processes = None,
    grep: Grep = "",
    site: Annotated[Path | None, typer.Option(help="The site file; if left out, the one of the last start.")] = None,
    replay: Replay = False,
) -> None:
    """Pack the log into a zip, to be sent.

    The versions, the machine and the site file are in it, too; secrets are not.
    """
    from services.cli import logs  # noqa: PLC0415

    typer.echo(logs.pack(file, data, logs.query_of(since, level, process, grep), site, replay=replay), nl=False)
