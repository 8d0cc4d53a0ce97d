"""Names of files and pupils, and words between processes, are UTF-8 in KineBox, whatever the locale."""

import os
import sys

_MODE = "PYTHONUTF8"
_PRINTED = "PYTHONIOENCODING"


def begin_in_utf8() -> None:
    """Begin anew in Python's UTF-8 mode if the locale has led to another encoding: it must be chosen before the first line runs.

    Else a name with an umlaut would be taken for a damaged one. What we print stays in the terminal's encoding; what the processes
    print that we start is UTF-8, since it is us who read it.
    """
    if sys.getfilesystemencoding() != "utf-8" and os.environ.get(_MODE) != "1":
        os.environ[_MODE] = "1"
        if sys.stdout is not None:
            os.environ.setdefault(_PRINTED, sys.stdout.encoding)
        os.execv(sys.executable, [sys.executable, *sys.orig_argv[1:]])  # noqa: S606 - ourselves
    os.environ[_PRINTED] = "utf-8"
