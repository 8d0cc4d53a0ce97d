"""Which lines of the log are wanted."""

import datetime as dt
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from services.logs.printable import printable
from services.logs.readable import details
from services.logs.reader import Line
from services.logs.record import LEVELS, LogRecord

_SUPERVISOR = "supervisor"
_NAME = re.compile(r"[a-z0-9][a-z0-9_-]*")


@dataclass(frozen=True)
class Query:
    """A filter; what is left at its default lets everything through.

    A damaged line is nobody's and of no level, so neither leaves it out; its time is that of the line before it.

    Attributes:
        since: aware; lines from then on.
        level: one of `LEVELS`; lines of it and of worse ones.
        processes: names; "edge" is every camera's process. What the supervisor said of a process is about that, too.
        text: to be found, in any case, in the event, in a field as `name=value` or in the traceback.
    """

    since: dt.datetime | None = None
    level: str = LEVELS[0]
    processes: tuple[str, ...] = ()
    text: str = ""

    def select(self, lines: Iterable[Line]) -> Iterator[Line]:
        """The lines that are wanted, in their order."""
        is_late_enough = True
        for line in lines:
            record = line.record
            if record is not None:
                is_late_enough = self.since is None or record.time >= self.since
                if LEVELS.index(record.level) < LEVELS.index(self.level) or not self._is_of_process(record):
                    continue
            if is_late_enough and self._has_text(line):
                yield line

    def _is_of_process(self, record: LogRecord) -> bool:
        if not self.processes:
            return True
        names = [record.process]
        if record.process == _SUPERVISOR:
            # A process that was killed or never came says nothing itself.
            names += _NAME.findall(record.event)
        return any(name == wanted or name.startswith(f"{wanted}-") for name in names for wanted in self.processes)

    def _has_text(self, line: Line) -> bool:
        if not self.text:
            return True
        record = line.record
        said = printable(line.raw) if record is None else "\n".join((record.event, *details(record), record.exception))
        return self.text.casefold() in said.casefold()
