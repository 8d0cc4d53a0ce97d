"""`kinebox logs`: look at the log, follow it, and pack a part of it to be sent."""

import datetime as dt
import os
import re
import sys
import time
import tomllib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import tomlkit

from models.errors import UserError
from models.process import REPLAY
from services.cli.duration import parse_duration
from services.cli.printed import print_for_programs
from services.logs.export import export
from services.logs.files import STARTED, log_folder, log_numbers
from services.logs.past import last_lines, wanted_lines
from services.logs.query import Query
from services.logs.readable import as_json, readable
from services.logs.reader import Line
from services.logs.record import LEVELS, time_text
from services.logs.redaction import redacted
from services.site_file.reading import read_file

_LOOK_AGAIN_S = 0.2
_AGO = re.compile(r"[\dhms]*[hms]")


def show(data: Path, query: Query, most: int, *, json: bool, follow: bool, replay: bool) -> None:
    """Print the last `most` lines that are wanted; then, if asked to, every further one as it is written, until Ctrl-C."""
    folder = log_folder(data, replay=replay)
    if not follow:
        _require_log(folder)
    with suppress(KeyboardInterrupt), _readable_log(folder):
        lines, reader = last_lines(folder, query, most, torn=not follow)
        _print(lines, json=json)
        if most and not lines and not follow:
            sys.stderr.write(f"{_none_matches(folder, query)}\n")
        while follow:
            time.sleep(_LOOK_AGAIN_S)
            _print(query.select(reader.poll()), json=json)


def pack(file: Path, data: Path, query: Query, site: Path | None, *, replay: bool) -> str:
    """Write the wanted lines and what helps to understand them into a zip; what there is to say of it.

    Args:
        file: the zip.
        data: the data folder.
        query: the wanted lines.
        site: the site file; the one that the box was last started with if it is None, and none if that is gone.
        replay: the log of replays in place of the box's.
    """
    folder = log_folder(data, replay=replay)
    _require_log(folder)
    site = site or _site_of_last_start(folder)
    toml = None if site is None else _site_without_secrets(site)
    with _readable_log(folder):
        if query.processes and next(wanted_lines(folder, query), None) is None:
            raise UserError(f"nothing is packed: {_none_matches(folder, query)}")
        manifest = export(file, wanted_lines(folder, query), toml, _told(query), dt.datetime.now(dt.UTC))
    included = f"the site file {site}" if site is not None else "no site file (name it with --site)"
    return f"{file} holds {manifest['lines']['count']} lines and {included}; no pictures, keypoints or passwords\n"


def query_of(since: str | None, level: str, processes: list[str] | None, text: str) -> Query:
    """A filter as a person writes it.

    Raises:
        UserError: an option says nothing.
    """
    if level.lower() not in LEVELS:
        raise UserError(f"--level: '{level}' is no level; write one of {', '.join(LEVELS)}")
    start = None if since is None else parse_since(since, dt.datetime.now(dt.UTC))
    return Query(start, level.lower(), tuple(processes or ()), text)


def parse_since(text: str, now: dt.datetime) -> dt.datetime:
    """A time as a person writes it: how long ago (90s, 10m, 1h30m), or a date and time, of this machine's zone if it names none.

    Raises:
        UserError: it is neither.
    """
    try:
        if _AGO.fullmatch(text):
            return now - dt.timedelta(seconds=parse_duration(text, "--since"))
        return dt.datetime.fromisoformat(text).astimezone(dt.UTC)
    except (ValueError, OverflowError) as error:
        raise UserError(
            f"--since: '{text}' is no time; write 90s, 10m or 1h30m, or a date and time like 2026-11-22T10:00"
        ) from error


@contextmanager
def _readable_log(folder: Path) -> Iterator[None]:
    try:
        yield
    except BrokenPipeError:
        raise  # Of the one who reads what we print.
    except OSError as error:
        where = error.filename or folder
        raise UserError(
            f"the log cannot be read: {error.strerror} ({where}); correct its owner and rights, or mend its disk"
        ) from error


def _require_log(folder: Path) -> None:
    try:
        found = log_numbers(folder)
    except OSError as error:
        raise UserError(f"the log in {folder} cannot be read: {error.strerror}; correct --data or its rights") from error
    if not found:
        writer = "kinebox replay" if folder.name == REPLAY else "kinebox run"
        raise UserError(f"there is no log in {folder}; '{writer}' writes it there, or name another folder with --data")


def _none_matches(folder: Path, query: Query) -> str:
    there = f"; the processes with lines in it are {_processes(folder)}" if query.processes else ""
    return f"no line of the log in {folder} matches{there}"


def _processes(folder: Path) -> str:
    return ", ".join(sorted({line.record.process for line in wanted_lines(folder, Query()) if line.record is not None})) or "none"


def _print(lines: Iterable[Line], *, json: bool) -> None:
    colour = sys.stdout.isatty() and "NO_COLOR" not in os.environ and os.environ.get("TERM") != "dumb"
    if json:
        print_for_programs("".join(f"{as_json(line)}\n" for line in lines))
        return
    for line in lines:
        sys.stdout.write(f"{readable(line, colour=colour)}\n")
    sys.stdout.flush()


def _site_of_last_start(folder: Path) -> Path | None:
    sites = [
        str(line.record.fields.get("site", ""))
        for line in wanted_lines(folder, Query(processes=("supervisor",), text=STARTED))
        if line.record is not None and line.record.event == STARTED
    ]
    file = Path(sites[-1]) if sites and sites[-1] else None
    return file if file is not None and file.is_file() else None


def _site_without_secrets(file: Path) -> str:
    """The site file's values. It need not be a good one: that may be why somebody wants help."""
    try:
        values = tomllib.loads(read_file(file, "site file").decode())
    except (ValueError, RecursionError) as error:
        raise UserError(f"site file {file}: {error}; correct it, or name another with --site") from error
    return tomlkit.dumps(redacted(values))


def _told(query: Query) -> dict[str, object]:
    since = None if query.since is None else time_text(query.since)
    return {"since": since, "level": query.level, "processes": list(query.processes), "text": query.text}
