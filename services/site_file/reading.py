"""Reading a site: its file and the calibration that it names."""

import codecs
from pathlib import Path

from models.camera.rig import Rig, decode_rig
from models.config.site import Site, decode_site
from models.errors import UserError
from models.regular_file import require_text


def read_site(path: Path) -> tuple[Site, Rig]:
    """The site of a file, and the calibration of its cameras in the site's order.

    Both must name the same cameras: a camera left out of one of them by mistake would be missed only in a lesson.

    Raises:
        UserError: a file is missing or unreadable, a key or value is wrong, or a camera is in one file alone.
    """
    site = decode_site(read_file(path, "site file"), path)
    calibration = path.parent / site.calibration
    rig = decode_rig(read_file(calibration, "calibration"), str(calibration))
    names = [camera.name for camera in site.cameras]
    try:
        chosen = rig.select(names)
    except UserError as error:
        raise UserError(f"site file {path}: {error}") from error
    unknown = [name for name in rig.names if name not in names]
    if unknown:
        raise UserError(
            f"calibration {calibration}: camera '{unknown[0]}' is not in the site file {path}, which has {', '.join(names)}; "
            "add it there, remove it from the calibration, or correct its name"
        )
    return site, chosen


def read_file(path: Path, what: str) -> bytes:
    """The text of a file that a person named, in bytes; UserError, which calls it `what`, if it cannot be read.

    The mark with which Windows' editors begin a text in UTF-8 is left out.
    """
    try:
        require_text(path.stat())
        return path.read_bytes().removeprefix(codecs.BOM_UTF8)
    except FileNotFoundError as error:
        raise UserError(f"{what} {path} does not exist; correct its path") from error
    except IsADirectoryError as error:
        raise UserError(f"{what} {path} is a folder; name the file in it") from error
    except OSError as error:
        raise UserError(f"{what} {path} cannot be read: {error.strerror}; correct its path or its permissions") from error
