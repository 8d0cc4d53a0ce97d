"""How the command line ends when a person has to do something."""

import sys
from typing import NoReturn

from models.errors import UserError


def exit_with_line(error: UserError) -> NoReturn:
    """One line on stderr, exit code 2, no traceback."""
    sys.stderr.write(f"kinebox: {' '.join(str(error).split())}\n")
    sys.exit(2)
