"""Finding the parts of the box by their entry points, so that no part imports another.

Four groups: `kinebox.processes` (a callable that takes a `ProcessContext` and returns when it shall stop), `kinebox.checks` (a
callable `check(site, rig, data)` that raises `UserError` if its part could not work), `kinebox.inspections` (see
`models.inspection`) and `kinebox.commands` (see `models.commands`). If several installed packages offer one of the same name, the
first on the import path is taken.
"""

import sys
from collections.abc import Callable
from importlib.metadata import EntryPoint, entry_points
from typing import cast

from models.commands import Simulation
from models.errors import UserError
from models.inspection import Inspection
from models.process import REPLAY, Check, ProcessContext

PROCESSES = "kinebox.processes"
CHECKS = "kinebox.checks"
INSPECTIONS = "kinebox.inspections"
COMMANDS = "kinebox.commands"

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
    known = ", ".join(sorted(offered.names - {REPLAY})) or "none"  # A replay is started by a command of its own.
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
    return [cast(Check, entry.load()) for entry in _first_of_each_name(CHECKS)]


def load_inspections() -> list[Inspection]:
    """What the parts look at when a person wants to know what is wrong, by name."""
    return [cast(Inspection, entry.load()) for entry in _first_of_each_name(INSPECTIONS)]


def load_simulation() -> Simulation:
    """The part that renders simulated lessons.

    Raises:
        UserError: no installed part offers it.
    """
    for entry in entry_points(group=COMMANDS):
        if entry.name == "simulate":
            return cast(Simulation, entry.load())
    raise UserError("no installed part renders lessons; run 'make setup'")


def _first_of_each_name(group: str) -> list[EntryPoint]:
    found: dict[str, EntryPoint] = {}
    for entry in entry_points(group=group):
        found.setdefault(entry.name, entry)
    return [found[name] for name in sorted(found)]
