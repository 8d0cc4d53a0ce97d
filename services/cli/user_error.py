"""How the command line ends when a person has to do something."""

import sys
from typing import NoReturn

from models.errors import USER_ERROR_CODE, USER_ERROR_PREFIX, UserError
from services.logs.printable import printable


def exit_with_line(error: UserError) -> NoReturn:
    """One line on stderr, exit code `USER_ERROR_CODE`, no traceback."""
    sys.stderr.write(f"{USER_ERROR_PREFIX}{printable(' '.join(str(error).split()))}\n")
    sys.exit(USER_ERROR_CODE)
