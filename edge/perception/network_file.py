"""Reads the file of a converted network.

It is checked against the hash that the set-up wrote down before anything interprets it, so that a file cut off by a full disk is
one clear line and not a crash in the middle of a lesson.
"""

import hashlib
from pathlib import Path

from models.errors import UserError
from models.make_command import make_command
from models.networks.installed import FILE_NAME, FOLDER, decode_installed, remedy


def read_network_file(name: str, data: Path) -> bytes:
    """The network `name` of the manifest, as it was installed in the data folder.

    Raises:
        UserError: it is not installed, missing, may not be read or is damaged.
    """
    folder = data / FOLDER
    listed = folder / FILE_NAME
    try:
        installed = decode_installed(listed.read_bytes(), listed)
    except FileNotFoundError as error:
        raise UserError(f"network {name}: there are no networks in {folder}; run {make_command('networks', data)}") from error
    except OSError as error:
        raise UserError(f"network {name}: {listed} cannot be read ({error.strerror}); {remedy(listed)}") from error
    entry = installed.networks.get(name)
    if entry is None:
        raise UserError(f"network {name}: not in {listed}; {remedy(listed)}")
    path = folder / entry.file
    try:
        model = path.read_bytes()
    except FileNotFoundError as error:
        raise UserError(f"network {name}: {path} is missing; {remedy(listed)}") from error
    except OSError as error:
        raise UserError(f"network {name}: {path} cannot be read ({error.strerror}); {remedy(listed)}") from error
    if hashlib.sha256(model).hexdigest() != entry.sha256:
        raise UserError(f"network {name}: {path} is damaged ({len(model)} bytes, not the hash installed); {remedy(listed)}")
    return model
