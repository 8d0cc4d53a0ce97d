"""Shows how far a long step of the set-up is: a line that is rewritten on a terminal, a line every tenth elsewhere."""

import sys
from typing import TextIO

_MEGABYTE = 1_000_000


class Progress:
    """Megabytes done of one download or file, written to standard error.

    `total` is None when nobody said how much there is; then only the megabytes are shown.
    """

    def __init__(self, label: str, total: int | None, stream: TextIO | None = None) -> None:
        self._label = label
        self._total = total
        self._stream = stream or sys.stderr
        self._rewrite = self._stream.isatty()
        self._shown = -1

    def show(self, done: int) -> None:
        """Tell that `done` bytes are there; writes only when a person would see a difference."""
        step = self._step(done)
        if step == self._shown:
            return
        self._shown = step
        share = f" of {self._total / _MEGABYTE:.1f} MB ({100 * done // self._total} %)" if self._total else " MB"
        line = f"{self._label}: {done / _MEGABYTE:.1f}{share}"
        self._stream.write(f"\r\x1b[K{line}" if self._rewrite else f"{line}\n")
        self._stream.flush()

    def close(self) -> None:
        """End the line that was being rewritten."""
        if self._rewrite and self._shown >= 0:
            self._stream.write("\n")
            self._stream.flush()

    def _step(self, done: int) -> int:
        if self._total:
            return (100 if self._rewrite else 10) * done // self._total
        return done // (_MEGABYTE if self._rewrite else 10 * _MEGABYTE)
