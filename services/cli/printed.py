"""What a command prints, for all commands at once: it reaches whoever shall read it, or one line says that it did not."""

import errno
import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from models.errors import UserError

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer

BROKEN_PIPE_CODE = 1
"""As typer has it where the pipe breaks within the command."""


@contextmanager
def printed_whole() -> Iterator[None]:
    """Within it stdout and stderr show what they can: a letter that a terminal does not know is written out as "\\xfc".

    Raises:
        UserError: what was printed cannot be written, now or at the end.
    """
    sys.stdout, sys.stderr = _guarded(sys.stdout), _guarded(sys.stderr)
    try:
        yield
    finally:
        # Not left to the interpreter, which would tell of it in words of its own.
        try:
            sys.stdout.flush()
        except BrokenPipeError:
            _let_go(sys.stdout.fileno())
            sys.exit(BROKEN_PIPE_CODE)


def print_for_programs(text: str) -> None:
    """Print what programs read: it is UTF-8, whatever a terminal shows."""
    sys.stdout.flush()
    sys.stdout.buffer.write(text.encode(errors="backslashreplace"))
    sys.stdout.buffer.flush()


class _End(io.FileIO):
    """The end of a stream, behind which is a file, a pipe or a terminal."""

    def write(self, data: "ReadableBuffer", /) -> int:
        try:
            return super().write(data)
        except BrokenPipeError:
            raise  # Who has read enough, as in `kinebox logs | head`, is told nothing.
        except OSError as error:
            _let_go(self.fileno())
            remedy = "make room there, or print it elsewhere" if error.errno == errno.ENOSPC else "print it elsewhere"
            raise UserError(f"what was to be printed cannot be written: {error.strerror}; {remedy}") from error


def _guarded(stream: TextIO | None) -> TextIO:
    if stream is None:  # It is closed (`kinebox lessons >&-`): nobody wants to read it.
        return Path(os.devnull).open("w", encoding="utf-8")
    end = io.BufferedWriter(_End(stream.fileno(), "wb", closefd=False))
    at_once = isinstance(stream, io.TextIOWrapper) and (stream.line_buffering or stream.write_through)
    return io.TextIOWrapper(end, stream.encoding, "backslashreplace", line_buffering=at_once)


def _let_go(descriptor: int) -> None:
    """What is still to be written there goes nowhere: the interpreter tries again when it ends."""
    with Path(os.devnull).open("wb") as nowhere:
        os.dup2(nowhere.fileno(), descriptor)
