"""The command line. Each command imports what it needs when it runs, so that help and errors come at once."""

import os
import sys
from pathlib import Path
from typing import Annotated

from models.errors import UserError
from services.cli.printed import print_for_programs, printed_whole
from services.cli.user_error import exit_with_line, told_in_one_line
from services.cli.utf8 import begin_in_utf8

try:
    import typer
except Exception as error:  # noqa: BLE001 - whatever a broken package raises; without it there is no command line at all
    exit_with_line(
        UserError(f"package typer cannot be imported ({error}); run `make setup`; if it stays so, delete .venv and run it again")
    )

from services.cli import lesson_commands, log_commands, simulate_command, standard_commands
from services.cli.data_option import DataFolder

SiteFile = Annotated[Path, typer.Option("--site", help="The site file.")]
SiteFileArgument = Annotated[Path, typer.Argument(metavar="FILE", help="The site file.")]

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
config_app = typer.Typer(help="Check, show and migrate a site file.", no_args_is_help=True)
app.add_typer(config_app, name="config")
lesson_commands.add_to(app)
log_commands.add_to(app)
simulate_command.add_to(app)
standard_commands.add_to(app)


def main() -> None:
    """Entry point of `kinebox`: an error for people is one line and exit code 2, any other keeps its traceback."""
    begin_in_utf8()
    try:
        with told_in_one_line(), printed_whole():
            app()
    except KeyboardInterrupt:
        sys.exit(130)


def _print_version(wanted: bool) -> None:
    if wanted:
        from services.support.version import kinebox_version  # noqa: PLC0415

        typer.echo(kinebox_version())
        raise typer.Exit


@app.callback()
def options(
    _version: Annotated[
        bool, typer.Option("--version", help="Print the version.", callback=_print_version, is_eager=True, show_default=False)
    ] = False,
) -> None:
    """Four cameras in a school gym, one thing to correct on the teacher's tablet."""


@app.command()
def run(site: SiteFile, data: DataFolder = Path("build")) -> None:
    """Start the whole box, watch over it, and end it on Ctrl-C."""
    from services.cli.parts import load_checks  # noqa: PLC0415
    from services.supervisor.supervise import supervise  # noqa: PLC0415

    supervise(site, data, load_checks())


@app.command()
def process(
    name: Annotated[str, typer.Argument(help="The process: edge, evaluation, fusion, recorder or tablet.")],
    site: SiteFile,
    data: DataFolder = Path("build"),
    camera: Annotated[str | None, typer.Option(help="The camera that an edge process serves.")] = None,
    start_ns: Annotated[
        int | None, typer.Option(help="Monotonic time in ns to count from, the same for all processes of one run; now if left out.")
    ] = None,
) -> None:
    """Run one process of the box on its own."""
    from services.support.environment import process_environment  # noqa: PLC0415

    os.environ.update(process_environment(data))  # before numpy and numba are imported
    from services.cli.process import ProcessOrder, run_process  # noqa: PLC0415
    from services.logs import of_process  # noqa: PLC0415

    order = ProcessOrder(name, site, data, camera, start_ns)
    of_process.configure(order.name)
    of_process.log_what_ends_us()
    run_process(order)


@config_app.command("check")
def config_check(file: SiteFileArgument) -> None:
    """Check a site file and its calibration."""
    from services.cli import config  # noqa: PLC0415

    typer.echo(config.check(file), nl=False)


@config_app.command("show")
def config_show(file: SiteFileArgument) -> None:
    """Print a site file with all of its defaults, as a site file."""
    from services.cli import config  # noqa: PLC0415

    print_for_programs(config.show(file))


@config_app.command("migrate")
def config_migrate(
    file: SiteFileArgument,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only print what would become different.", show_default=False)] = False,
) -> None:
    """Bring a site file of an older KineBox up to date.

    A backup is kept beside it.
    """
    from services.cli import config  # noqa: PLC0415

    typer.echo(config.migrate(file, dry_run), nl=False)


@app.command()
def doctor(
    site: Annotated[
        Path | None, typer.Option("--site", help="The site file, to examine its cameras and its running box, too.")
    ] = None,
    data: DataFolder = Path("build"),
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.", show_default=False)] = False,
) -> None:
    """Say what is wrong with this machine or box, and what to do.

    Exit code 1 if something is.
    """
    from services.cli.doctor import doctor as examine  # noqa: PLC0415

    raise typer.Exit(examine(site, data, as_json))


@app.command()
def version() -> None:
    """Print the version."""
    _print_version(wanted=True)


if __name__ == "__main__":
    main()
