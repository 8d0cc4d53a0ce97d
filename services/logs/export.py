"""Packs a part of the log for a coach or a technician: what happened, on what, with which versions and which site file.

The file is a zip of `log.jsonl` (the lines, as `kinebox logs --json` prints them), `site.toml` (if it is given; every value, the
defaults included) and `manifest.json`. What `services.logs.redaction` names is taken out of all of them; pictures and keypoints
are in none of them.
"""

import datetime as dt
import hashlib
import os
import platform
import zipfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import msgspec
import psutil

from models.config.site import SITE_VERSION
from models.errors import UserError
from services.logs.readable import as_json
from services.logs.reader import Line
from services.logs.record import encode, time_text
from services.logs.redaction import redacted, redacted_remains, redacted_text
from services.support.processor import processor
from services.support.requirements import installed_version, required_packages
from services.support.version import kinebox_version

FORMAT_VERSION = 1
_FIRST_TIME = (1980, 1, 1, 0, 0, 0)
"""That a zip knows."""


def export(file: Path, lines: Iterable[Line], site_toml: str | None, query: dict[str, Any], now: dt.datetime) -> dict[str, Any]:
    """Write the zip; what its manifest says.

    Args:
        file: a name that is not taken.
        lines: the wanted ones.
        site_toml: the site file as TOML without comments, redacted already; None if there is none.
        query: by what the lines were chosen, for the manifest.
        now: the time.

    Raises:
        UserError: the file exists or cannot be written; nothing is left of it.
    """
    temporary = file.with_name(f".{file.name}.{os.getpid()}.tmp")
    try:
        if file.exists():
            raise UserError(f"{file} exists already; choose another name or delete it")
        with temporary.open("xb") as stream:
            manifest = _pack(zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED), lines, site_toml, query, now)
            stream.flush()
            os.fsync(stream.fileno())
        temporary.replace(file)
    except OSError as error:
        raise UserError(f"{file} cannot be written: {error.strerror}; choose another place or make room") from error
    finally:
        temporary.unlink(missing_ok=True)
    return manifest


def _pack(
    archive: zipfile.ZipFile, lines: Iterable[Line], site_toml: str | None, query: dict[str, Any], now: dt.datetime
) -> dict[str, Any]:
    manifest: dict[str, Any] = {
        "format": "kinebox-logs",
        "format_version": FORMAT_VERSION,
        "made": time_text(now),
        "query": query,
        "versions": _versions(),
        "machine": _machine(),
    }
    hashes = {}
    with archive:
        with archive.open(_member("log.jsonl", now), "w", force_zip64=True) as stream:
            digest, counts = hashlib.sha256(), _Counts()
            for line in lines:
                said = _without_secrets(line).encode() + b"\n"
                stream.write(said)
                digest.update(said)
                counts.add(line)
        manifest["lines"] = counts.told()
        hashes["log.jsonl"] = digest.hexdigest()
        if site_toml is not None:
            archive.writestr(_member("site.toml", now), site_toml)
            hashes["site.toml"] = hashlib.sha256(site_toml.encode()).hexdigest()
        manifest["sha256"] = hashes
        archive.writestr(_member("manifest.json", now), msgspec.json.format(msgspec.json.encode(manifest), indent=2))
    return manifest


def _member(name: str, now: dt.datetime) -> zipfile.ZipInfo:
    """A file of the archive, with the local time of this machine, as all programs show it; a clock that was never set has none."""
    here = now.astimezone()
    member = zipfile.ZipInfo(name, max((here.year, here.month, here.day, here.hour, here.minute, here.second), _FIRST_TIME))
    member.compress_type = zipfile.ZIP_DEFLATED
    return member


def _without_secrets(line: Line) -> str:
    record = line.record
    if record is None:
        return as_json(line._replace(raw=redacted_remains(line.raw.decode(errors="backslashreplace")).encode()))
    told = msgspec.structs.replace(
        record, event=redacted_text(record.event), fields=redacted(record.fields), exception=redacted_text(record.exception)
    )
    return encode(told).decode().rstrip("\n")


class _Counts:
    """What the manifest tells of the lines."""

    def __init__(self) -> None:
        self._levels: dict[str, int] = {}
        self._first: dt.datetime | None = None
        self._last: dt.datetime | None = None

    def add(self, line: Line) -> None:
        level = "damaged" if line.record is None else line.record.level
        self._levels[level] = self._levels.get(level, 0) + 1
        if line.record is not None:
            self._first = self._first or line.record.time
            self._last = line.record.time

    def told(self) -> dict[str, Any]:
        ends = {"first": self._first, "last": self._last}
        return {"count": sum(self._levels.values()), **self._levels} | {
            name: time_text(time) for name, time in ends.items() if time is not None
        }


def _versions() -> dict[str, str]:
    """Of KineBox, Python, the site file's schema and every package that KineBox asks for and finds."""
    found = {"kinebox": kinebox_version(), "python": platform.python_version(), "site_schema": str(SITE_VERSION)}
    packages = {requirement.name: installed_version(requirement.name) for requirement in required_packages()}
    return found | {name: version for name, version in packages.items() if version is not None}


def _machine() -> dict[str, Any]:
    """What it is, not whose: no name, no address, no serial number."""
    return {
        "system": platform.platform(),
        "architecture": platform.machine(),
        "processor": processor().name,
        "cores": os.cpu_count(),
        "granted_cores": len(os.sched_getaffinity(0)),
        "memory_mb": psutil.virtual_memory().total // 1_000_000,
        "up_since": time_text(dt.datetime.fromtimestamp(psutil.boot_time(), dt.UTC)),
    }
