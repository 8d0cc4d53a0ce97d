"""`kinebox simulate`: render a simulated lesson, which is then played like any other source."""

import shlex
from pathlib import Path
from typing import Annotated

import typer

from models.errors import UserError
from services.cli.data_option import DataFolder


def add_to(app: typer.Typer) -> None:
    """Make the command part of `kinebox`."""
    app.command()(simulate)


def simulate(
    plan: Annotated[
        str | None, typer.Argument(metavar="PLAN", help="A lesson plan: its file, or the name of one that --list lists.")
    ] = None,
    data: DataFolder = Path("build"),
    out: Annotated[
        Path | None, typer.Option("--out", help="Where the lesson shall be, instead of the data folder.", file_okay=False)
    ] = None,
    listed: Annotated[bool, typer.Option("--list", help="List the plans that come with KineBox.", show_default=False)] = False,
) -> None:
    """Render a simulated lesson.

    It is a film of each camera, what is true in it, and a site file that plays it.
    """
    import os  # noqa: PLC0415

    from services.support.environment import process_environment  # noqa: PLC0415

    if (plan is None) != listed:
        raise UserError("name one lesson plan, or ask for --list alone")
    os.environ.update(process_environment(data))  # before numpy and numba are imported
    from services.cli.parts import load_simulation  # noqa: PLC0415

    simulation = load_simulation()
    if plan is None:
        for name, what in simulation.plans():
            typer.echo(f"{name:20} {what}")
        return
    from services.cli.duration import clock  # noqa: PLC0415
    from services.cli.progress import ProgressLine  # noqa: PLC0415
    from services.support.called import called  # noqa: PLC0415

    with ProgressLine() as line:

        def progress(done: int, total: int, remaining_s: float | None) -> None:
            left = "" if remaining_s is None else f", {clock(remaining_s)} left"
            line.show(f"rendering {plan}: {done} of {total} pictures{left}")

        lesson = simulation.simulate(plan, data, out, progress)
    typer.echo(f"{'was rendered before' if lesson.was_there else 'rendered'}: {lesson.folder}")
    typer.echo(f"play it: {called()} run --site {shlex.quote(str(lesson.site))} --data {shlex.quote(str(data))}")
