"""One process of the box as the supervisor holds it: started, read from, ended."""

import contextlib
import os
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import msgspec

from models.errors import USER_ERROR_PREFIX
from models.process import EDGE, EVALUATION, RECORDER, SPARE_READY, Playback, process_name

_NICENESS = {EDGE: 5, EVALUATION: 5, RECORDER: 10}
"""Inference takes all the CPU that it is given; fusion and the page, which need little, shall not wait for it, nor for an attempt
that is evaluated. At the start nobody shall wait for the recorder, which has nothing to do yet."""
_MODULE = "services.cli.child"
_READ_BYTES = 65536
_READS_AT_ONCE = 16
_LONGEST_LINE_BYTES = 65536


@dataclass(frozen=True)
class ChildSpec:
    """What to start: a process by its entry point, for one camera or none; in a replay, with what is played."""

    entry: str
    camera: str | None = None
    playback: Playback | None = None

    @property
    def name(self) -> str:
        """The process's name on the bus."""
        return process_name(self.entry, self.camera)

    @property
    def niceness(self) -> int:
        """How far the process stands back when the CPU is short."""
        return _NICENESS.get(self.entry, 0)

    def command(self, site: Path, data: Path, start_ns: int, *, spare: bool = False) -> list[str]:
        """The command line of the process; it ends with the process that calls this. A `spare` waits for `Child.begin`."""
        words = [sys.executable, "-P", "-m", _MODULE, self.entry, "--site", str(site), "--data", str(data)]
        words += ["--start-ns", str(start_ns), "--parent", str(os.getpid())]
        words += ["--spare"] if spare else []
        words += ["--playback", msgspec.json.encode(self.playback).decode()] if self.playback else []
        return words if self.camera is None else [*words, "--camera", self.camera]


def name_of(command: Sequence[str]) -> str | None:
    """The name on the bus of the process that has this command line; None if it is none of the box's."""
    # Another command may well name the module: somebody looks for our processes.
    entry = _word_after(_MODULE, command) if _word_after("-m", command) == _MODULE else None
    return None if entry is None else process_name(entry, _word_after("--camera", command))


def _word_after(word: str, command: Sequence[str]) -> str | None:
    return next((after for before, after in pairwise(command) if before == word), None)


class Child:
    """A running process and its output, of which both streams come in one pipe.

    It must be made on the main thread: the kernel ends it together with the thread that started it.

    Raises:
        OSError: the machine has no memory, process or descriptor left for it; nothing of it remains.
    """

    def __init__(self, command: list[str], environment: Mapping[str, str], niceness: int = 0, *, waits: bool = False) -> None:
        # A process group of its own, so that Ctrl-C at a terminal reaches the supervisor alone and the end is orderly.
        self._process = subprocess.Popen(  # noqa: S603 - our own interpreter and module
            command,
            env=dict(environment),
            stdin=subprocess.PIPE if waits else subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            process_group=0,
        )
        assert self._process.stdout is not None  # noqa: S101 - it was asked for above
        self._output = self._process.stdout
        try:
            if niceness:
                os.setpriority(os.PRIO_PROCESS, self.pid, os.getpriority(os.PRIO_PROCESS, 0) + niceness)
            os.set_blocking(self._output.fileno(), False)
            self._exit_fd = os.pidfd_open(self.pid)
        except OSError:
            # It runs, but nobody would ever hear of its end.
            self._process.kill()
            self._process.wait()
            self._close_pipes()
            raise
        self._partial = b""
        self.user_error = ""
        """What the process told a person last, without its prefix."""
        self.ready = False
        """It is a spare that said it has everything that it needs."""

    @property
    def pid(self) -> int:
        """Of the process."""
        return self._process.pid

    def fileno(self) -> int:
        """A descriptor that becomes readable when the process ends."""
        return self._exit_fd

    @property
    def stopped(self) -> bool:
        """Whether a signal stopped it (SIGSTOP, a terminal's): it does nothing, nor does it end, until somebody lets it go on."""
        # The kernel tells a parent, and tells it again (WNOWAIT) for as long as it is so.
        return self.poll() is None and os.waitid(os.P_PID, self.pid, os.WSTOPPED | os.WNOHANG | os.WNOWAIT) is not None

    def poll(self) -> int | None:
        """The exit code, negative if a signal ended it; None while it runs."""
        return self._process.poll()

    def lines(self) -> list[str]:
        """What the process has said since the last call, in whole lines; all of it once the process has ended."""
        ended = self.poll() is not None
        for _ in range(_READS_AT_ONCE):
            chunk = self._read()
            self._partial += chunk
            if not chunk:
                break
        *whole, self._partial = self._partial.split(b"\n")
        if ended or len(self._partial) > _LONGEST_LINE_BYTES:
            whole.append(self._partial)
            self._partial = b""
        lines = [line.decode(errors="replace").rstrip() for line in whole if line.strip()]
        for line in lines:
            if line.startswith(USER_ERROR_PREFIX):
                self.user_error = line.removeprefix(USER_ERROR_PREFIX)
        if SPARE_READY in lines:
            self.ready = True
            lines.remove(SPARE_READY)  # It is meant for us.
        return lines

    def begin(self) -> None:
        """Have a process that waits take up its post."""
        if self._process.stdin is not None:
            with contextlib.suppress(BrokenPipeError):  # It has just ended, which is seen as of any other.
                self._process.stdin.write(b"\n")
                self._process.stdin.close()

    def ask_to_end(self) -> None:
        """Send SIGTERM."""
        self._signal(signal.SIGTERM)

    def kill(self) -> None:
        """Send SIGKILL to the process and whatever it has started."""
        self._signal(signal.SIGKILL)

    def wait(self) -> int:
        """Wait for the end of the process; its exit code."""
        return self._process.wait()

    def close(self) -> None:
        """Let go of a process that has ended."""
        self._close_pipes()
        os.close(self._exit_fd)

    def _close_pipes(self) -> None:
        if self._process.stdin is not None:
            with contextlib.suppress(BrokenPipeError):
                self._process.stdin.close()
        self._output.close()

    def _read(self) -> bytes:
        try:
            return os.read(self._output.fileno(), _READ_BYTES)
        except BlockingIOError:
            return b""

    def _signal(self, number: signal.Signals) -> None:
        if self.poll() is None:
            os.killpg(self.pid, number)
