"""Processes that do pieces of one long work, and what is heard of them.

A worker reads the number of a piece from its standard input, says `step` for each step of it and `done` once it is kept, and ends
when its input ends. So it ends soon after whoever started it is gone, in whatever way that went.
"""

import contextlib
import os
import selectors
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Sequence
from typing import IO

from models.errors import USER_ERROR_CODE, USER_ERROR_PREFIX, UserError

STEP, DONE = b"step", b"done"


def do_pieces(command: Sequence[str], pieces: Iterable[int], processes: int, step_done: Callable[[], None]) -> None:
    """Have every piece done, by as many processes at once.

    Args:
        command: of a worker, which calls `serve_pieces`.
        pieces: their numbers, in the order in which they are begun.
        processes: how many work at once.
        step_done: called for each step of any piece.

    Raises:
        UserError: what a worker raised, or a worker was killed; the others are ended.
        RuntimeError: a worker broke down; with what it said last.
    """
    left = list(reversed(list(pieces)))
    with selectors.DefaultSelector() as selector:
        workers = [_Worker(command) for _ in range(min(processes, len(left)))]
        try:
            for worker in workers:
                selector.register(worker.output, selectors.EVENT_READ, worker)
                worker.give(left.pop())
            while selector.get_map():
                for key, _ in selector.select():
                    worker = key.data
                    for word in worker.words():
                        if word == STEP:
                            step_done()
                        elif word == DONE:
                            worker.give(left.pop() if left else None)
                        else:  # It has ended.
                            selector.unregister(worker.output)
                            worker.require_success()
        finally:
            for worker in workers:
                worker.end()


def serve_pieces(do: Callable[[int, Callable[[], None]], None]) -> int:
    """Be a worker: `do(piece, step_done)` for each piece that is asked for. Returns the exit code."""
    output = sys.stdout.buffer

    def say(word: bytes) -> None:
        output.write(word + b"\n")
        output.flush()

    try:
        for line in sys.stdin.buffer:
            do(int(line), lambda: say(STEP))
            say(DONE)
    except UserError as error:
        sys.stderr.write(f"{USER_ERROR_PREFIX}{error}\n")
        return USER_ERROR_CODE
    except BrokenPipeError:
        # Whoever wanted this is gone. Python would complain of the pipe once more at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return 0


class _Worker:
    def __init__(self, command: Sequence[str]) -> None:
        self._errors: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 - closed in `end`; a pipe could fill up
        # A process group of its own: Ctrl-C reaches whoever started it, who ends it.
        self._process = subprocess.Popen(  # noqa: S603 - our own interpreter and module
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._errors, process_group=0
        )
        assert self._process.stdin is not None  # noqa: S101 - both were asked for above
        assert self._process.stdout is not None  # noqa: S101
        self._input, self.output = self._process.stdin, self._process.stdout
        self._partial = b""

    def give(self, piece: int | None) -> None:
        """Have it do a piece, or end."""
        with contextlib.suppress(BrokenPipeError):  # It has just broken down, which its output will say.
            if piece is None:
                self._input.close()
            else:
                self._input.write(b"%d\n" % piece)
                self._input.flush()

    def words(self) -> list[bytes]:
        """What it has said since; an empty word if it has ended."""
        chunk = os.read(self.output.fileno(), 65536)
        if not chunk:
            return [b""]
        *words, self._partial = (self._partial + chunk).split(b"\n")
        return words

    def require_success(self) -> None:
        """Raise what it ended with, unless it ended as it should."""
        code = self._process.wait()
        if code == 0:
            return
        self._errors.seek(0)
        lines = [line for line in self._errors.read().decode(errors="replace").splitlines() if line.strip()]
        last = lines[-1] if lines else ""
        if code == USER_ERROR_CODE and last.startswith(USER_ERROR_PREFIX):
            raise UserError(last.removeprefix(USER_ERROR_PREFIX))
        if code < 0 and -code in {signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP}:
            raise UserError(
                f"a process at work was ended ({signal.Signals(-code).name}); unless somebody did that, the memory is full: end "
                "other programs. What is done is kept: the same command goes on from there"
            )
        raise RuntimeError(f"a worker ended with code {code}:\n" + "\n".join(lines))

    def end(self) -> None:
        """End it if it has not, and let go of it."""
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait()
        with contextlib.suppress(BrokenPipeError):
            self._input.close()
        self.output.close()
        self._errors.close()
