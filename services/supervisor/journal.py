"""One stream of what all processes say: everything in the log's files, and on the console what matters.

The files have one JSON object a line, for programs and `kinebox logs`; their form is in `services.logs.record`. The console
(stderr) is for people, at a terminal or in the log of a service: it has the warnings and errors of the processes and all that the
supervisor says, as plain lines with the time of day.
"""

import datetime as dt
import sys
import time
from collections import defaultdict
from pathlib import Path
from traceback import format_exception
from typing import Any, TextIO

import msgspec

from models.config.site import LogsConfig
from models.errors import USER_ERROR_PREFIX
from models.messages.trouble import Trouble, one_line
from services.logs.files import LATEST
from services.logs.printable import printable
from services.logs.readable import details, local, speaker
from services.logs.record import LogRecord, record_of
from services.logs.write_behind import END_WITHIN_S, HELD_UP, WriteBehind
from services.logs.writer import IN_USE, LogWriter
from services.supervisor.console import Console
from services.supervisor.traceback_lines import TracebackLines
from services.support.no_room import WORDS as NO_ROOM

_LOUD = frozenset({"warning", "error", "critical"})
_SUPERVISOR = "supervisor"
_TRY_AGAIN_S = 1.0
_DEFAULTS = LogsConfig()


class Journal:
    """Writes lines. A console that is gone or that nobody reads, or a disc that is full, read-only or stalls must not stop the box.

    While nothing can be kept, which is said once, the console gets everything.

    Args:
        folder: where the files are kept; it is made if it is missing.
        console: where a person looks.
        config: how much is kept.
        command: shows what is kept.

    Attributes:
        trouble: why nothing can be kept now, and what to do; None if all is.
    """

    def __init__(
        self, folder: Path, console: TextIO | None = None, config: LogsConfig = _DEFAULTS, command: str = "kinebox logs"
    ) -> None:
        self.path = folder / LATEST
        self._console = Console(console or sys.stderr)
        self._output = Console(sys.stdout)
        self._command = command
        self._tracebacks: dict[str, TracebackLines] = defaultdict(TracebackLines)
        self._most_mb = config.max_file_mb * config.max_files
        self._writer = WriteBehind(LogWriter(folder, int(config.max_file_mb * 1e6), config.max_files))
        self._next_try_s = time.monotonic() + _TRY_AGAIN_S
        self.trouble: Trouble | None = None
        self._tell_problem()

    def child_said(self, process: str, line: str) -> None:
        """Pass on a line of a process. The lines of a traceback become one record; another one that is no JSON becomes an error."""
        said = _parse(line)
        if said is not None:
            self._end_traceback(process)
            self._keep(record_of(said, process, _now()))
        elif line.startswith(USER_ERROR_PREFIX) or not self._tracebacks[process].takes(line, time.monotonic()):
            self._keep(record_of({"event": line.removeprefix(USER_ERROR_PREFIX), "level": "error"}, process, _now()))

    def settle(self) -> None:
        """Write down the tracebacks that are whole by now, and see whether a problem is over; to be called now and then.

        The same for a console that was not read.
        """
        now_s = time.monotonic()
        for process, traceback in self._tracebacks.items():
            if traceback.is_over(now_s):
                self._end_traceback(process)
        if self.trouble is not None and now_s >= self._next_try_s:
            self._next_try_s = now_s + _TRY_AGAIN_S
            self._writer.try_again(_now())
        self._tell_problem()  # A disk may have stalled, or go on, since the last line.
        if left_out := self._console.left_out():
            kept = "" if self.trouble is not None else f"; '{self._command}' has them"
            self.say(f"nobody read what is shown here: {left_out} lines were left out{kept}", level="warning")

    def say(self, event: str, *, level: str = "info", **fields: str) -> None:
        """A line of the supervisor's own; a person always sees it."""
        for process in self._tracebacks:
            self._end_traceback(process)
        self._keep(record_of(fields | {"event": event, "level": level}, _SUPERVISOR, _now()), shown=True)

    def note(self, event: str, **fields: Any) -> None:
        """A line of the supervisor's own for those who read the log afterwards."""
        self._keep(record_of(fields | {"event": event}, _SUPERVISOR, _now()))

    def broke(self, error: Exception) -> None:
        """What ends the supervisor itself, with its traceback."""
        event = f"the supervisor ended by a defect: {type(error).__name__}: {error}"
        self.note(event, level="critical", exception="".join(format_exception(error)))

    def welcome(self, block: str) -> None:
        """Lines meant for a person only, on stdout."""
        self._output.show(block + "\n")

    def close(self) -> None:
        """Close the file, and let go of the console."""
        for process in self._tracebacks:
            self._end_traceback(process)
        if given_up := self._writer.close(self._waits):
            event = f"{given_up} lines of the log were given up: {HELD_UP}"
            self._show(record_of({"event": event, "level": "warning"}, _SUPERVISOR, _now()))
        self._console.close()
        self._output.close()

    def _waits(self) -> None:
        event = f"waiting up to {END_WITHIN_S:.0f} s for the disk of {self.path} to take the last lines of the log"
        self._show(record_of({"event": event}, _SUPERVISOR, _now()))

    def _end_traceback(self, process: str) -> None:
        if (ended := self._tracebacks[process].end()) is not None:
            event, whole = ended
            self._keep(record_of({"event": event, "level": "critical", "exception": whole}, process, _now()))

    def _keep(self, record: LogRecord, *, shown: bool = False) -> None:
        self._writer.write(record)
        self._tell_problem()
        if shown or self.trouble is not None or record.level in _LOUD:
            self._show(record)

    def _tell_problem(self) -> None:
        reason, before = self._writer.problem, self.trouble
        self.trouble = (
            Trouble("log_not_kept", f"nothing is kept in {self.path}: {reason}", self._remedy(reason)) if reason else None
        )
        if self.trouble is not None and before is None:
            self._show(record_of({"event": one_line((self.trouble,)), "level": "warning"}, _SUPERVISOR, _now()))
        elif before is not None and self.trouble is None:
            self._show(record_of({"event": f"what is said is kept in {self.path} again"}, _SUPERVISOR, _now()))

    def _remedy(self, reason: str) -> str:
        if reason == IN_USE:
            return ""  # It is in the words.
        if reason == HELD_UP:
            return "see what else writes on that disk; if it does not answer at all, check its cable and replace it"
        if reason in NO_ROOM:
            return f"make room on its disk: the log takes up to {self._most_mb:.0f} MB"
        return "correct the folder's owner and rights or what lies in its place, or mend its disk"

    def _show(self, record: LogRecord) -> None:
        clock = local(record.time).strftime("%H:%M:%S")
        said = " ".join((printable(record.event), *details(record)))
        lines = [f"{clock}  {printable(speaker(record.process)):12}  {said}".rstrip()]
        if record.exception and self.trouble is not None:
            lines += record.exception.splitlines()
        elif record.exception:
            lines[0] += f" ('{self._command}' has the traceback)"
        self._console.show("\n".join(lines) + "\n")


def _now() -> dt.datetime:
    return dt.datetime.now(dt.UTC)


def _parse(line: str) -> dict[str, Any] | None:
    try:
        return msgspec.json.decode(line, type=dict[str, Any]) if line.startswith("{") else None
    except (msgspec.DecodeError, RecursionError):
        return None
