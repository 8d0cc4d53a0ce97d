"""How the command line ends when a person has to do something."""

import errno
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import NoReturn

from models.errors import USER_ERROR_CODE, USER_ERROR_PREFIX, UserError
from services.logs.printable import printable
from services.support.called import as_called

_SHOWN = 40
"""Characters of a name by which people know it again."""


@contextmanager
def told_in_one_line() -> Iterator[None]:
    """What a person must do ends the program with that line; anything else goes its way.

    A name that is longer than any file's is found wherever it is first looked up: it is told here, once for all commands.
    """
    try:
        yield
    except UserError as error:
        exit_with_line(error)
    except OSError as error:
        if error.errno != errno.ENAMETOOLONG:
            raise
        name = os.fsdecode(error.filename or "")
        exit_with_line(UserError(f"'{name[:_SHOWN]}...' ({len(name)} characters) is too long for the name of a file; shorten it"))


def exit_with_line(error: UserError) -> NoReturn:
    """One line on stderr, exit code `USER_ERROR_CODE`, no traceback. Where no line can be written, the code tells."""
    with suppress(OSError, UserError):
        sys.stderr.write(f"{USER_ERROR_PREFIX}{as_called(printable(' '.join(str(error).split())))}\n")
    sys.exit(USER_ERROR_CODE)
