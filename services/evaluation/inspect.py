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
from models.teaching.standard import NoStandardError
from services.support.called import same_place
from services.support.own_standards import OwnStandards
from services.support.teaching_files import own_folder, taught_files

_TAUGHT: Final = "what is taught"
_READ: Final = "reading every action and standard whole"


def inspect(site: Site | None, _rig: Rig | None, data: Path, site_file: Path | None) -> list[Inspected]:
    """Read all that is taught.

    Args:
        site: the site file; None looks at what KineBox brings and at the usual folder of the school's own.
        data: the data folder.
        site_file: its file; None without a site.
    """
    try:
        return list(_faults(site, data, site_file)) or [Inspected(_TAUGHT, _READ)]
    except UserError as error:
        return [Inspected(_TAUGHT, _READ, str(error))]
    except ImportError as error:
        return [Inspected(_TAUGHT, _READ, f"{_TAUGHT} cannot be read: {error}; see what is found of the packages")]


def _faults(site: Site | None, data: Path, site_file: Path | None) -> Iterator[Inspected]:
    """Every file that is bad; UserError if each is good and they do not belong together, or to the site."""
    from services.evaluation.config import VOCABULARY  # noqa: PLC0415 - needs packages that may be what is broken
    from services.evaluation.taught import configuration  # noqa: PLC0415

    good = True
    own = own_folder(data, "" if site is None else site.evaluation.teaching)
    for file in taught_files(own, VOCABULARY):
        try:
            file.read()
        except UserError as error:
            good = False
            fault = str(error)
            if not file.own:
                fault = _with(fault, "it is one of KineBox's own: put back the file of this version, as by installing it again")
            elif own is not None and isinstance(error, NoStandardError) and _can_restore(own, file.action):
                command = f"kinebox standard restore {file.action} {same_place(data, site_file)}"
                fault = _with(fault, f"run `{command}`: the one before counts again")
            yield Inspected(f"{file.kind} {file.action}", f"reading {file.path} whole", fault)
    if good and site is not None:
        configuration(site, data)


def _with(fault: str, remedy: str) -> str:
    """A fault, and what to do about it for whoever did not make the file."""
    what, _, _ = fault.rpartition("; ")
    return f"{what}; {remedy}"


def _can_restore(own: Path, action: str) -> bool:
    """Whether `restore` brings another standard back: the newest that is kept, or what KineBox brings if none is."""
    try:
        standards = OwnStandards(own)
        kept = standards.kept(action)
        return kept[-1].read().action == action if kept else standards.shipped(action) is not None
    except UserError:
        return False  # It would end with the same line.
