"""The list of converted networks in the data folder: written by the set-up, read by who loads a network. Pure: bytes in and out."""

from pathlib import Path

import msgspec

from models.errors import UserError
from models.make_command import make_command

FOLDER = "networks"
"""Folder of the converted networks inside the data folder."""
FILE_NAME = "installed.json"

INSTALLED_VERSION = 1


class InstalledNetwork(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One converted network.

    Attributes:
        file: its name in the folder of the networks.
        sha256: hash of that file.
        recipe: hash of everything the conversion depends on: the manifest's entry and the converter.
        sources: hash of each original file by its path in the source's archive.
    """

    file: str
    sha256: str
    recipe: str
    sources: dict[str, str]


class Installed(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """All converted networks by name."""

    version: int
    networks: dict[str, InstalledNetwork]


def encode_installed(installed: Installed) -> bytes:
    """As indented JSON."""
    return msgspec.json.format(msgspec.json.encode(installed), indent=2) + b"\n"


def decode_installed(data: bytes, file: Path) -> Installed:
    """Read the list.

    Args:
        data: the file's bytes.
        file: its path, for the error.

    Raises:
        UserError: damaged, or of another version of KineBox.
    """
    try:
        installed = msgspec.json.decode(data, type=Installed)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise UserError(f"{file} cannot be read ({error}); {remedy(file)}") from error
    if installed.version != INSTALLED_VERSION:
        raise UserError(f"{file} is of version {installed.version}, not {INSTALLED_VERSION}; {remedy(file)}")
    return installed


def remedy(file: Path) -> str:
    """What to do about networks that are harmed, given the path of their list: Make goes by its presence alone."""
    return f"delete {file} and run {make_command('networks', file.parent.parent)}"
