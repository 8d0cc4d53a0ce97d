"""The file that says when a lesson's pupils try what: the moments of every attempt, known because they were planned."""

from collections.abc import Mapping
from pathlib import Path

import msgspec

from models.errors import UserError
from models.motions.motion import Attempt

VERSION = 1
AttemptsByPupil = Mapping[str, tuple[Attempt, ...]]
"""By the pupil's code, in the order of time; seconds from the lesson's beginning."""


class _File(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    version: int
    pupils: dict[str, tuple[Attempt, ...]]


class _Versioned(msgspec.Struct, frozen=True):
    version: int


def encode_attempts(attempts: AttemptsByPupil) -> bytes:
    """The file's bytes."""
    return msgspec.json.format(msgspec.json.encode(_File(VERSION, dict(attempts))), indent=1)


def read_attempts(path: Path) -> AttemptsByPupil:
    """The attempts of a file.

    Raises:
        UserError: it cannot be read, is damaged, or of another version.
    """
    try:
        data = path.read_bytes()
        version = msgspec.json.decode(data, type=_Versioned).version
        if version != VERSION:
            raise UserError(f"{path}: attempts of version {version}; this KineBox reads {VERSION}; render the lesson again")
        return msgspec.json.decode(data, type=_File).pupils
    except (OSError, msgspec.DecodeError) as error:
        raise UserError(f"{path}: cannot be read ({error}); render the lesson again") from error
