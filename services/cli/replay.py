"""`kinebox replay`: a box that plays a lesson into the page, with what the lesson itself says of its site and calibration."""

import socket
from pathlib import Path

import msgspec
import typer

from models.config.site import BusConfig, EvaluationConfig, Site, TabletConfig, decode_site
from models.errors import UserError
from models.process import Playback
from services.cli.check_lesson import what_changed
from services.cli.replay_folder import replay_folder
from services.lesson.lesson_header import LessonHeader
from services.lesson.lesson_reader import open_lesson
from services.lesson.replay import configuration
from services.site_file.migration import migrated_text
from services.site_file.rendering import render
from services.supervisor.supervise import supervise
from services.support.listening import NoAddressError, listen
from services.support.teaching_files import own_folder
from services.tablet.page import PAGE, require_page

_HERE = "127.0.0.1"
_CALIBRATION = "rig.toml"


def play(file: Path, data: Path, page: TabletConfig, speed: float, *, loop: bool) -> None:
    """Play a lesson until SIGINT or SIGTERM, or once.

    Args:
        file: of the lesson.
        data: folder for logs and compiled kernels.
        page: where the page listens; of the recorded site only what was in the room counts.
        speed: seconds of the lesson a second.
        loop: begin again at the end.

    Raises:
        UserError: the file is no lesson that can be replayed, the page's port is taken, or there is no page; nothing was started.
    """
    with open_lesson(file) as lesson:
        header = lesson.header
        for line in what_changed(header):
            typer.echo(f"note: {line}", err=True)
        # What is wrong is told now, and not when pupils wait for what follows.
        configuration(header.preset)
        header.rig()
        lesson.require_entries()
        lesson.summary()
    _require_port(page)
    require_page(PAGE)
    playback = Playback(str(file.resolve()), header.title, header.started_ns + header.wall_minus_monotonic_ns, speed, loop)
    with replay_folder() as folder:
        site_file = folder / "site.toml"
        site_file.write_text(render(replay_site(header, page, data)))
        (folder / _CALIBRATION).write_text(header.rig_toml)
        supervise(site_file, data, (), playback)


def replay_site(header: LessonHeader, page: TabletConfig, data: Path) -> Site:
    """The lesson's site with this machine's addresses, and without spares: nobody is hurt by a replay that stops for a second.

    What pupils were to do comes from the lesson's log. What the school taught of its own counts if it is in the data folder.

    Raises:
        UserError: this KineBox cannot read it.
    """
    recorded = decode_site(migrated_text(header.site_toml.encode(), "of the lesson").new.encode(), "of the lesson")
    evaluation = EvaluationConfig(language=recorded.evaluation.language, teaching=_own(data, recorded.evaluation.teaching))
    return msgspec.structs.replace(
        recorded,
        evaluation=evaluation,
        calibration=_CALIBRATION,
        bus=BusConfig(endpoint=f"tcp/{_HERE}:{_free_port()}"),
        tablet=page,
        supervisor=msgspec.structs.replace(recorded.supervisor, spares=False),
    )


def _own(data: Path, teaching: str) -> str:
    """Empty if there is no such folder here, or it is none of the data folder's."""
    try:
        return "" if own_folder(data, teaching) is None else teaching
    except UserError:
        return ""


def _require_port(page: TabletConfig) -> None:
    try:
        listen(page.host, page.port).close()
    except NoAddressError as error:
        raise UserError(
            f"the page cannot be shown at {page.host}, which is no address of this machine ({error.strerror}); "
            "name another with --host"
        ) from error
    except OSError as error:
        raise UserError(
            f"the page cannot be shown at {page.host} port {page.port}: {error.strerror}; a running KineBox has one already; "
            "name another with --port"
        ) from error


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind((_HERE, 0))
        return int(probe.getsockname()[1])
