"""Commands in what is printed begin as this program was called, so that they can be copied: few shells find `kinebox` by itself."""

import re
import shlex
import shutil
import sys
from pathlib import Path

_NAME = "kinebox"
_COMMAND = re.compile(rf"(?<=['`]){_NAME}(?= [a-z-])")


def called() -> str:
    """What stands before `run`, `record` and so on in a shell that is where this one was."""
    program = sys.argv[0]
    if Path(program).name != _NAME or shutil.which(_NAME) == program:
        return _NAME
    return shlex.quote(program)


def same_place(data: Path, site: Path | None) -> str:
    """The options by which another command goes by the same data folder, and the same site file if this one was told any."""
    options = f"--data {shlex.quote(str(data))}"
    return options if site is None else f"{options} --site {shlex.quote(str(site))}"


def as_called(text: str) -> str:
    """A text with every command that stands in quotes ('kinebox lessons', `kinebox doctor`) as it is to be typed here."""
    return _COMMAND.sub(lambda _: called(), text)
