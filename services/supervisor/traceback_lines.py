"""Tracebacks that a process prints instead of logging them, put together again.

Our processes log what ends them as one record. What they cannot log comes line by line: a process that ends before its log is set
up, an abort in native code, a library that prints. A traceback begins with one of a few words and goes on until the process logs,
ends, or says nothing for a while.
"""

import re
from itertools import pairwise

_BEGINS = re.compile(
    r"Traceback \(most recent call last\):|\s*\+ Exception Group Traceback|Exception in thread|Exception ignored in"
    r"|Fatal Python error:|(Current thread|Thread) 0x[0-9a-f]+ .*\(most recent call first\):"
)
_GOES_ON = ("During handling of the above exception", "The above exception was the direct cause")
_FATAL = "Fatal Python error:"
MOST_LINES = 400
QUIET_S = 0.5
"""A process that prints a traceback prints it at once; on a CPU in use "at once" takes this long."""


class TracebackLines:
    """The traceback that one process is printing."""

    def __init__(self) -> None:
        self._lines: list[str] = []
        self._last_s = 0.0

    def takes(self, line: str, now_s: float) -> bool:
        """Whether the line belongs to a traceback, which is then kept."""
        if not (self._lines or _BEGINS.match(line)):
            return False
        self._lines.append(line)
        self._last_s = now_s
        return True

    def is_over(self, now_s: float) -> bool:
        """Whether nothing more is to be expected."""
        return bool(self._lines) and (now_s - self._last_s > QUIET_S or len(self._lines) >= MOST_LINES)

    def end(self) -> tuple[str, str] | None:
        """What happened, in a line, and the whole, empty if that is all; None if there is none. The next line begins anew."""
        lines, self._lines = self._lines, []
        return (_what_happened(lines), "\n".join(lines) if lines[1:] else "") if lines else None


def _what_happened(lines: list[str]) -> str:
    """The line after the last indented one names the exception; a fatal error names itself first."""
    if lines[0].startswith(_FATAL):
        return lines[0]
    named = lines[0]
    for before, line in pairwise(lines):
        if before.startswith((" ", "\t")) and not line.startswith((" ", "\t", *_GOES_ON)):
            named = line
    return named
