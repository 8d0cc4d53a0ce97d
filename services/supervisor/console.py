"""What a person looks at. Whoever shows something there never waits until it is read.

A terminal that was stopped (Ctrl-S), a pager at its first page, a connection that broke: the kernel holds a writer up until
somebody reads again, and a supervisor that waits with it restarts nobody.
"""

import contextlib
import io
import os
import queue
import threading
from typing import TextIO

_ROOM = 1000
"""Texts that wait to be read; what comes on top of them is left out."""
_END_WITHIN_S = 0.5


class Console:
    """Writes one text after the other, on a thread of its own.

    Args:
        stream: where to. One that is gone takes everything in, and nobody sees it.
    """

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._waiting: queue.Queue[str | None] = queue.Queue(_ROOM)
        self._left_out = 0
        # A daemon, since it may be held up when the box ends.
        self._thread = threading.Thread(target=self._write_all, name="console", daemon=True)
        self._thread.start()

    def show(self, text: str) -> None:
        """Write a text, or leave it out if too many wait already."""
        try:
            self._waiting.put_nowait(text)
        except queue.Full:
            self._left_out += 1

    def left_out(self) -> int:
        """How many texts were left out, told once, when somebody reads again; 0 until then."""
        if not self._left_out or not self._waiting.empty():
            return 0
        left_out, self._left_out = self._left_out, 0
        return left_out

    def close(self) -> None:
        """Write what waits, and nothing more after that; what nobody reads within a moment is left."""
        try:
            self._waiting.put(None, timeout=_END_WITHIN_S)
        except queue.Full:
            return
        self._thread.join(_END_WITHIN_S)

    def _write_all(self) -> None:
        while (text := self._waiting.get()) is not None:
            with contextlib.suppress(OSError, ValueError):  # It is gone, or closed.
                self._write(text)

    def _write(self, text: str) -> None:
        try:
            descriptor = self._stream.fileno()
        except io.UnsupportedOperation:  # It is in memory.
            self._stream.write(text)
            return
        # Past the stream's buffer, whose lock would be held for as long as nobody reads: the interpreter could not end then.
        data = text.encode(self._stream.encoding, "backslashreplace")
        while data:
            data = data[os.write(descriptor, data) :]
