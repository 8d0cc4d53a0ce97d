"""`kinebox doctor`: print what is wrong and what to do."""

import sys
from pathlib import Path

from services.cli.parts import load_inspections
from services.doctor.examine import Order, examine
from services.doctor.report import as_json, as_text

FINDINGS_CODE = 1


def doctor(site: Path | None, data: Path, as_program: bool) -> int:
    """Examine, print the report, and return the exit code: 0 if everything is good, 1 if something was found."""
    examined = examine(Order(site, data, load_inspections()))
    sys.stdout.write(as_json(examined) if as_program else as_text(examined))
    return FINDINGS_CODE if examined.findings else 0
