"""What is taught, looked at closely for `kinebox doctor`: every file that KineBox brings, and every one of the school's own.

The doctor finds this by the entry point group `kinebox.inspections`. See `check` for what is read before every start: no more than
a school has changed, and up to the first fault.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Final

from models.camera.rig import Rig
from models.config.site import Site
from models.errors import UserError
from models.inspection import Inspected
from services.support.teaching_files import TaughtFile, own_folder, taught_files

_TAUGHT: Final = "what is taught"
_READ: Final = "reading every action and standard whole"


def inspect(site: Site | None, _rig: Rig | None, data: Path) -> list[Inspected]:
    """Read all that is taught.

    Args:
        site: the site file; None looks at what KineBox brings and at the usual folder of the school's own.
        data: the data folder.
    """
    try:
        return list(_faults(site, data)) or [Inspected(_TAUGHT, _READ)]
    except UserError as error:
        return [Inspected(_TAUGHT, _READ, str(error))]
    except ImportError as error:
        return [Inspected(_TAUGHT, _READ, f"{_TAUGHT} cannot be read: {error}; see what is found of the packages")]


def _faults(site: Site | None, data: Path) -> Iterator[Inspected]:
    """Every file that is bad; UserError if each is good and they do not belong together, or to the site."""
    from services.evaluation.config import VOCABULARY  # noqa: PLC0415 - needs packages that may be what is broken
    from services.evaluation.taught import configuration  # noqa: PLC0415

    good = True
    for file in taught_files(own_folder(data, "" if site is None else site.evaluation.teaching), VOCABULARY):
        try:
            file.read()
        except UserError as error:
            good = False
            known_by = f"reading {file.path} whole"
            yield Inspected(f"{file.kind} {file.action}", known_by, _with_remedy(file, str(error)))
    if good and site is not None:
        configuration(site, data)


def _with_remedy(file: TaughtFile, fault: str) -> str:
    """The fault, and what to do about it for whoever did not write the file."""
    what, _, _ = fault.rpartition("; ")
    if not file.own:
        return f"{what}; it is one of KineBox's own: put back the file of this version, as by installing it again"
    if file.kind == "standard":
        return f"{what}; run `kinebox standard restore {file.action}`: the one before counts again"
    return fault  # A person wrote it, and the words name the key.
