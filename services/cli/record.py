"""`kinebox record`: have the running box record a lesson, and see how it goes."""

import time
from pathlib import Path
from threading import Event

import typer

from models.config.site import Site
from models.errors import UserError
from models.messages.health import Health, RecorderHealth
from services.bus.join import accepts
from services.cli.duration import clock
from services.cli.progress import ProgressLine
from services.cli.recorded_site import note_of_another
from services.lesson.index import LessonIndex, LessonRow
from services.lesson.layout import SUFFIX
from services.lesson.remote import Remote, join, refused, require_title
from services.support.called import as_called
from services.support.signals import stop_on_signals

_ROUND_S = 0.25
_SILENT_S = 5.0
GONE_AFTER_S = 180.0
"""Whoever restarts the recorder finds out within two minutes that it hangs as it starts, and waits for up to half a one."""
BOX_GONE_AFTER_S = 30.0
"""A box whose router died has another one long before."""
_WAITED_FOR = f"nothing is heard of the box at {{endpoint}}; it is waited for, {BOX_GONE_AFTER_S:g} s in all"


def record(site: Site, data: Path, title: str, seconds: float | None) -> None:
    """Begin a lesson and stay with it: until a signal, or for so long, or until somebody else ends it.

    Args:
        site: of the box that runs.
        data: its data folder.
        title: what people call the lesson.
        seconds: how long it shall be; None until it is ended.

    Raises:
        UserError: no box or recorder is there, it cannot record, the lesson ended by itself or with the box's run, the recorder was
            given up, or nothing is heard of it any more.
    """
    require_title(title)
    stop = stop_on_signals()
    bus = join(site.bus.endpoint)
    try:
        remote = Remote(bus)
        lesson = remote.start(title).lesson
        typer.echo(f"recording {lesson}; Ctrl-C ends it" if seconds is None else f"recording {lesson} for {clock(seconds)}")
        note_of_another(site, lesson, data)
        try:
            ended = _watch(remote, lesson, seconds, stop, site.bus.endpoint)
        except _BoxGoneError as error:
            raise UserError(f"{error}. {_left(lesson, site, data)}") from error
        last = ended or remote.stop(lesson)
        if ended is None and last is not None:
            typer.echo(_recorded(lesson, last, site, data))
        elif remote.is_another_run():
            raise UserError(f"the box was started anew, and the lesson ended with its run. {_left(lesson, site, data, runs=True)}")
        else:
            early = "" if seconds is None else f" before its {clock(seconds)}"
            typer.echo(f"{_recorded(lesson, last, site, data)}; somebody else ended it{early}")
    finally:
        bus.close()


def begin(site: Site, data: Path, title: str) -> None:
    """Begin a lesson and leave it; UserError as for `record`."""
    require_title(title)
    bus = join(site.bus.endpoint)
    try:
        lesson = Remote(bus).start(title).lesson
        typer.echo(as_called(f"recording {lesson}; 'kinebox record --stop' ends it"))
    finally:
        bus.close()
    note_of_another(site, lesson, data)


def end(site: Site, data: Path) -> None:
    """End the lesson that is being recorded; UserError as for `record`, or if there is none."""
    bus = join(site.bus.endpoint)
    try:
        last = Remote(bus).stop()
    finally:
        bus.close()
    if last is None:
        raise UserError("no lesson is being recorded; 'kinebox record' begins one")
    note_of_another(site, last.lesson, data)
    typer.echo(_recorded(last.lesson, last, site, data))


class _BoxGoneError(Exception):
    """Nobody is at the endpoint any more."""


def _watch(remote: Remote, lesson: str, seconds: float | None, stop: Event, endpoint: str) -> RecorderHealth | None:
    """Show how the lesson goes. None if it shall be ended now; its last known state if it was ended by others.

    Raises:
        _BoxGoneError: the box ended, and did not come back; or it shall be ended, and no box is there that could.
        UserError: the lesson ended by itself, or nobody is left to record it. A recorder that is tried again is waited for.
    """
    last: RecorderHealth | None = None
    heard_s = time.monotonic()
    is_waited_for = False
    with ProgressLine() as progress:
        while not stop.is_set():
            health = remote.listen(_ROUND_S)
            now_s = time.monotonic()
            if health is not None:
                heard_s = now_s  # The supervisor says why there is no recorder, in its name.
                _require_not_given_up(health, lesson)
            if health is not None and health.recorder is not None:
                if health.recorder.lesson != lesson:
                    if refused(health):
                        raise UserError(health.reason)
                    return last or health.recorder
                last = health.recorder
            if last is not None and seconds is not None and last.recorded_s >= seconds:
                return None
            box_silent_s = now_s - remote.heard_s
            if is_waited_for != (box_silent_s > _SILENT_S):
                is_waited_for = not is_waited_for
                progress.tell(_WAITED_FOR.format(endpoint=endpoint) if is_waited_for else "the box is heard again")
            if box_silent_s > BOX_GONE_AFTER_S and not accepts(endpoint):
                raise _BoxGoneError(f"the box at {endpoint} is gone: nothing was heard of it for {BOX_GONE_AFTER_S:g} s")
            reason = remote.newest.reason if remote.newest is not None else ""
            if now_s - heard_s > GONE_AFTER_S:
                words = f"nothing was heard of the recorder for {GONE_AFTER_S:g} s; 'kinebox doctor' says what is wrong"
                raise UserError(f"{words}. {_kept(lesson)}")
            if now_s - heard_s > _SILENT_S:
                reason = "nothing is heard of the recorder"
            progress.show(_line(last, reason))
    if not accepts(endpoint):  # A wish would be heard by nobody, and waited for in vain.
        words = "so that nobody was told to end the lesson; if it comes back by itself, 'kinebox record --stop' ends it"
        raise _BoxGoneError(f"no box is at {endpoint} any more, {words}")
    return None


def _require_not_given_up(health: Health, lesson: str) -> None:
    if any(trouble.code == "given_up" for trouble in health.troubles):
        raise UserError(f"the recorder is given up: {health.reason}. {_kept(lesson)}")


def _kept(lesson: str) -> str:
    """What becomes of a lesson that nobody is left to record."""
    return f"What lesson {lesson} has is kept, and finished when the box is started again with 'kinebox run'"


def _left(lesson: str, site: Site, data: Path, *, runs: bool = False) -> str:
    """What there is of the lesson of a box that is gone: one that was told to end has finished it; one that runs again is at it."""
    file = _file(lesson, site, data)
    if file.is_file():
        return f"The lesson is in {file}"
    return f"What it has is being finished; 'kinebox lessons' then lists {lesson}" if runs else _kept(lesson)


def _line(recorder: RecorderHealth | None, reason: str) -> str:
    if recorder is None:
        return f"waiting for the first second{f'; {reason}' if reason else ''}"
    gaps = f", {_gaps(recorder.gaps)}" if recorder.gaps else ""
    return f"recorded {clock(recorder.recorded_s)}, {recorder.size_bytes / 1e6:.1f} MB{gaps}{f'; {reason}' if reason else ''}"


def _recorded(lesson: str, last: RecorderHealth | None, site: Site, data: Path) -> str:
    """What became of a lesson, and where it is. Its length is the list's: its last half second came after the last word."""
    file = _file(lesson, site, data)
    row = next((row for row in LessonIndex(file.parent).lessons() if row.lesson == lesson), None) if file.is_file() else None
    whole = row or last
    if whole is None:
        return f"recorded {file}"
    seconds = whole.seconds if isinstance(whole, LessonRow) else whole.recorded_s
    gaps = f", {_gaps(whole.gaps)}" if whole.gaps else ""
    return f"recorded {file}, {clock(seconds)}{gaps}"


def _file(lesson: str, site: Site, data: Path) -> Path:
    return (data / site.lessons.folder / (lesson + SUFFIX)).resolve()


def _gaps(count: int) -> str:
    return "1 gap" if count == 1 else f"{count} gaps"
