"""The command of Make that puts right what was installed, as people are told it."""

import shlex
from pathlib import Path

_BY_ITSELF = Path("build")
"""The data folder that Make takes if none is named."""


def make_command(target: str, data: Path) -> str:
    """Of a target for a data folder, in backquotes: without its name Make would fill another one."""
    folder = "" if data == _BY_ITSELF else f" DATA={shlex.quote(str(data))}"
    return f"`make {target}{folder}`"
