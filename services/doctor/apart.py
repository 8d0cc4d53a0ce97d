"""What the doctor has done in a process of its own, because it may crash or never end.

It imports the standard library and what depends on that alone: with it the doctor looks at the packages that it needs itself.
"""

import os
import signal
import subprocess
import sys
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from services.doctor.finding import Finding
from services.support.signals import signal_name

REMEDY = "run `make setup`; if it stays so, delete .venv and run it again"
"""What to do about a package that is missing or broken."""
_CHILD_S = 120.0


class Ended(NamedTuple):
    """A process that has ended, and what it printed."""

    code: int
    output: str
    errors: str

    @property
    def how(self) -> str:
        """How it ended, in two words."""
        return signal_name(-self.code) if self.code < 0 else f"exit code {self.code}"


def run_module(module: str, *arguments: str, environment: Mapping[str, str] = os.environ) -> Ended:
    """Run `python -m module` to its end; it is killed if that takes two minutes."""
    command = [sys.executable, "-P", "-m", module, *arguments]
    try:
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=_CHILD_S, check=False)  # noqa: S603
    except subprocess.TimeoutExpired:
        return Ended(-signal.SIGKILL, "", f"nothing came within {_CHILD_S:.0f} s")
    return Ended(done.returncode, done.stdout, done.stderr)


def import_problems(modules: Iterable[str]) -> dict[str, str]:
    """What is wrong with each of the modules that cannot be imported."""
    problems: dict[str, str] = {}
    waiting = list(modules)
    while waiting:
        ended = run_module("services.doctor.imports", *waiting)
        lines = ended.output.splitlines()
        for line in lines:
            verdict, _, rest = line.partition(" ")
            if verdict == "bad":
                module, _, why = rest.partition(": ")
                problems[module] = why
        tried = [line.removeprefix("try ") for line in lines if line.startswith("try ")]
        if ended.code == 0 or not tried:
            break
        problems[tried[-1]] = f"it ended its process ({ended.how})"
        waiting = waiting[waiting.index(tried[-1]) + 1 :]
    return problems


def import_finding(package: str, problem: str, version: str = "") -> Finding:
    """The finding for a package that cannot be imported."""
    words = f"{' '.join(filter(None, (package, version)))} cannot be imported: {problem}"
    return Finding("fault", f"package {package}", words, "importing it in a process of its own", REMEDY)
