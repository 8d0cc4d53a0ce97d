"""`kinebox record`: have the running box record a lesson, and see how it goes."""

import time
from pathlib import Path
from threading import Event

import typer

from models.config.site import Site
from models.errors import UserError
from models.messages.health import Health, RecorderHealth
from services.cli.duration import clock
from services.cli.progress import ProgressLine
from services.lesson.layout import SUFFIX
from services.lesson.remote import Remote, join, refused, require_title
from services.support.signals import stop_on_signals

_ROUND_S = 0.25
_SILENT_S = 5.0
GONE_AFTER_S = 180.0
"""Whoever restarts the recorder finds out within two minutes that it hangs as it starts, and waits for up to half a one."""


def record(site: Site, data: Path, title: str, seconds: float | None) -> None:
    """Begin a lesson and stay with it: until a signal, or for so long, or until somebody else ends it.

    Args:
        site: of the box that runs.
        data: its data folder.
        title: what people call the lesson.
        seconds: how long it shall be; None until it is ended.

    Raises:
        UserError: no box or recorder is there, it cannot record, the lesson ended by itself, the recorder was given up, or
            nothing is heard of it any more.
    """
    require_title(title)
    stop = stop_on_signals()
    bus = join(site.bus.endpoint)
    try:
        remote = Remote(bus)
        lesson = remote.start(title).lesson
        typer.echo(f"recording {lesson}; Ctrl-C ends it" if seconds is None else f"recording {lesson} for {clock(seconds)}")
        last = _watch(remote, lesson, seconds, stop)
        if last is None:
            last = remote.stop()
        typer.echo(_recorded(lesson, last, site, data))
    finally:
        bus.close()


def begin(site: Site, title: str) -> None:
    """Begin a lesson and leave it; UserError as for `record`."""
    require_title(title)
    bus = join(site.bus.endpoint)
    try:
        typer.echo(f"recording {Remote(bus).start(title).lesson}; 'kinebox record --stop' ends it")
    finally:
        bus.close()


def end(site: Site, data: Path) -> None:
    """End the lesson that is being recorded; UserError as for `record`, or if there is none."""
    bus = join(site.bus.endpoint)
    try:
        last = Remote(bus).stop()
    finally:
        bus.close()
    if last is None:
        raise UserError("no lesson is being recorded; 'kinebox record' begins one")
    typer.echo(_recorded(last.lesson, last, site, data))


def _watch(remote: Remote, lesson: str, seconds: float | None, stop: Event) -> RecorderHealth | None:
    """Show how the lesson goes. None if it shall be ended now; its last known state if it was ended by others.

    Raises:
        UserError: the lesson ended by itself, or nobody is left to record it. A recorder that is tried again is waited for.
    """
    last: RecorderHealth | None = None
    heard_s = time.monotonic()
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
            reason = remote.newest.reason if remote.newest is not None else ""
            if now_s - heard_s > GONE_AFTER_S:
                words = f"nothing was heard of the recorder for {GONE_AFTER_S:g} s; 'kinebox doctor' says what is wrong"
                raise UserError(f"{words}. {_kept(lesson)}")
            if now_s - heard_s > _SILENT_S:
                reason = "nothing is heard of the recorder"
            progress.show(_line(last, reason))
    return None


def _require_not_given_up(health: Health, lesson: str) -> None:
    if any(trouble.code == "given_up" for trouble in health.troubles):
        raise UserError(f"the recorder is given up: {health.reason}. {_kept(lesson)}")


def _kept(lesson: str) -> str:
    """What becomes of a lesson that nobody is left to record."""
    return f"What lesson {lesson} has is kept, and finished when the box is started again with 'kinebox run'"


def _line(recorder: RecorderHealth | None, reason: str) -> str:
    if recorder is None:
        return f"waiting for the first second{f'; {reason}' if reason else ''}"
    gaps = f", {_gaps(recorder.gaps)}" if recorder.gaps else ""
    return f"recorded {clock(recorder.recorded_s)}, {recorder.size_bytes / 1e6:.1f} MB{gaps}{f'; {reason}' if reason else ''}"


def _recorded(lesson: str, last: RecorderHealth | None, site: Site, data: Path) -> str:
    """What became of a lesson, and where it is."""
    length = f", {clock(last.recorded_s)}" if last is not None else ""
    gaps = f", {_gaps(last.gaps)}" if last is not None and last.gaps else ""
    return f"recorded {(data / site.lessons.folder / (lesson + SUFFIX)).resolve()}{length}{gaps}"


def _gaps(count: int) -> str:
    return "1 gap" if count == 1 else f"{count} gaps"
