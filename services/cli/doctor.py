"""`kinebox doctor`: print what is wrong and what to do."""

import sys
from pathlib import Path

from services.cli.printed import print_for_programs
from services.doctor.apart import import_finding, import_problems
from services.doctor.finding import Examined
from services.doctor.report import as_json, as_text
from services.support.called import as_called

FINDINGS_CODE = 1
_NEEDED = ("msgspec", "numpy", "packaging", "psutil")
"""The packages without which nothing can be examined: the doctor itself needs them."""


def doctor(site: Path | None, data: Path, as_program: bool) -> int:
    """Examine, print the report, and return the exit code: 0 if everything is good, 1 if something was found."""
    problems = import_problems(_NEEDED)
    if problems:
        examined = Examined(tuple(import_finding(name, problem) for name, problem in problems.items()))
    else:
        examined = _examine(site, data)
    if as_program:
        print_for_programs(as_json(examined))
    else:
        sys.stdout.write(as_called(as_text(examined)))
    return FINDINGS_CODE if examined.findings else 0


def _examine(site: Path | None, data: Path) -> Examined:
    from services.cli.parts import load_inspections  # noqa: PLC0415 - these need the packages
    from services.doctor.examine import Order, examine  # noqa: PLC0415

    return examine(Order(site, data, load_inspections()))
