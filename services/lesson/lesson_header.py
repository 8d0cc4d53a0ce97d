"""What a lesson's file says about the lesson: everything beside the log that replaying it needs."""

import datetime as dt
import zlib
from dataclasses import dataclass, fields

from models.camera.rig import Rig, decode_rig
from services.lesson.local_time import local_time

FORMAT = 3
"""Version of the file's layout; a reader refuses one that is newer.

2 had no corrections, 1 no feedback either; all else of them is the same.
"""
NAME = "kinebox.lesson"
_CHECK = "crc32"
_LATEST_NS = 2**63
"""Of a clock or between two, in 64 bits. What is beyond that is none, and no date can be made of it."""


class HeaderError(ValueError):
    """Metadata that are not a lesson's header, with the reason."""


class NewerFormatError(HeaderError):
    """The file is of a format that this KineBox does not know."""


@dataclass(frozen=True)
class LessonHeader:
    """Written once, at the beginning of the file.

    Attributes:
        title: what people call the lesson.
        kinebox: version of KineBox that recorded it.
        machine: processor and the versions that numerical results depend on.
        preset: fusion's configuration: a key of `services.fusion.config.PRESETS`.
        site_toml: the site file, with every default written out; for people, since a later KineBox may know another schema.
        rig_toml: the calibration as fusion used it, to the last digit.
        started_ns: CLOCK_MONOTONIC when the lesson was begun.
        wall_minus_monotonic_ns: CLOCK_REALTIME less CLOCK_MONOTONIC at that moment.
        run_ns: CLOCK_MONOTONIC at the start of the box; a lesson left open by the same run is gone on with.
    """

    title: str
    kinebox: str
    machine: str
    preset: str
    site_toml: str
    rig_toml: str
    started_ns: int
    wall_minus_monotonic_ns: int
    run_ns: int

    @property
    def started_s(self) -> float:
        """Begin of the lesson, seconds since 1970 (UTC)."""
        return (self.started_ns + self.wall_minus_monotonic_ns) * 1e-9

    @property
    def begun(self) -> dt.datetime:
        """The same, as people read it here."""
        return local_time(self.started_s)

    def wall(self, t_s: float) -> dt.datetime:
        """An instant of CLOCK_MONOTONIC, in seconds, as people read it here."""
        return self.begun + dt.timedelta(seconds=t_s - self.started_ns * 1e-9)

    def rig(self) -> Rig:
        """The decoded calibration; UserError if this KineBox cannot read it."""
        return decode_rig(self.rig_toml.encode(), "of the lesson")

    def to_metadata(self) -> dict[str, str]:
        """As MCAP keeps metadata, with a check sum over all of it."""
        values = {"format": str(FORMAT)} | {field.name: str(getattr(self, field.name)) for field in fields(self)}
        return values | {_CHECK: _checksum(values)}

    @classmethod
    def from_metadata(cls, metadata: dict[str, str]) -> "LessonHeader":
        """Read what `to_metadata` wrote.

        Raises:
            NewerFormatError: by a KineBox that came after this one.
            HeaderError: damaged.
        """
        values = dict(metadata)
        if values.pop(_CHECK, None) != _checksum(values):
            raise HeaderError("its header differs from its check sum")
        try:
            newer = int(values.pop("format")) > FORMAT
            if not newer:
                return cls(**{field.name: _value(field.name, field.type, values[field.name]) for field in fields(cls)})  # type: ignore[arg-type]
        except KeyError as error:
            raise HeaderError(f"its header lacks {error}") from error
        except ValueError as error:
            raise HeaderError(f"its header is none: {error}") from error
        raise NewerFormatError(f"it is of KineBox {values.get('kinebox', '?')}")


def _value(name: str, kind: object, text: str) -> str | int:
    if kind is str:
        return text
    value = int(text)
    if abs(value) >= _LATEST_NS:
        raise ValueError(f"{name} is no time")
    return value


def _checksum(values: dict[str, str]) -> str:
    text = "\0".join(f"{key}\0{value}" for key, value in sorted(values.items()))
    return f"{zlib.crc32(text.encode()):08x}"
