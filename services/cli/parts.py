"""Finding the parts of the box by their entry points, so that no part imports another.

Two groups: `kinebox.processes` (a callable that takes a `ProcessContext` and returns when it shall stop) and `kinebox.checks` (a
callable `check(site, rig, data)` that raises `UserError` if its part could not work). If several installed packages offer a
process of one name, the first on the import path is taken.
"""

import sys
from collections.abc import Callable
from importlib.metadata import EntryPoint, entry_points
from typing import cast

from models.errors import UserError
from models.process import Check, ProcessContext

PROCESSES = "kinebox.processes"
CHECKS = "kinebox.checks"

Process = Callable[[ProcessContext], None]


def find_process(name: str) -> EntryPoint:
    """Where the process of that name begins; it is imported by loading it.

    Raises:
        UserError: no installed part offers it.
    """
    offered = entry_points(group=PROCESSES)
    for entry in offered:
        if entry.name == name:
            return entry
    known = ", ".join(sorted(offered.names)) or "none"
    raise UserError(f"no process is called '{name}' (there are: {known}); correct the name, or run 'make setup'")


def load_process(entry: EntryPoint) -> Process:
    """Import a process and get it ready, by the function `prepare` of its module if that has one."""
    process = cast(Process, entry.load())
    prepare = getattr(sys.modules[process.__module__], "prepare", None)
    if prepare is not None:
        prepare()
    return process


def load_checks() -> list[Check]:
    """What the parts want to have checked before anything is started, by name."""
    found: dict[str, EntryPoint] = {}
    for entry in entry_points(group=CHECKS):
        found.setdefault(entry.name, entry)
    return [cast(Check, found[name].load()) for name in sorted(found)]
