"""One line at a terminal that is written over and over; nothing where nobody watches."""

import sys
import time
from types import TracebackType
from typing import TextIO

_PERIOD_S = 0.25
_CLEAR = "\r\x1b[K"


class ProgressLine:
    """Shows how far something is, at most four times a second.

    Args:
        stream: where to; stderr unless given, so that what a command prints can be piped.
    """

    def __init__(self, stream: TextIO | None = None) -> None:
        self._stream = stream or sys.stderr
        self._shown = False
        self._next_s = 0.0

    def __enter__(self) -> "ProgressLine":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self._shown:
            self._stream.write(_CLEAR)
            self._stream.flush()

    def tell(self, line: str) -> None:
        """A line that stays, also where nobody watches."""
        self._stream.write(f"{_CLEAR if self._shown else ''}{line}\n")
        self._stream.flush()
        self._shown = False

    def show(self, line: str) -> None:
        """Put `line` in the place of the one before."""
        now_s = time.monotonic()
        if now_s < self._next_s or not self._stream.isatty():
            return
        self._next_s, self._shown = now_s + _PERIOD_S, True
        self._stream.write(f"{_CLEAR}{line}")
        self._stream.flush()
