"""A disk that stalls does not hold up whoever logs.

A card that tidies up, or a disk that others write to, may hold up one write for seconds, and a supervisor that waits with it
restarts nobody. So the files are written on a thread of its own. Whoever logs waits for it for a moment only, within which a disk
that does not stall is done: what was said is then kept, whatever happens next, and a disk that fails is known at once.
"""

import datetime as dt
import threading
import time
from collections import deque
from collections.abc import Callable
from functools import partial

from services.logs.record import LogRecord
from services.logs.writer import LogWriter

HELD_UP = "its disk takes nothing for the time being"
ROOM = 1000
"""Lines that wait for the disk, 32 KiB each at most; what comes on top of them is lost."""
PATIENCE_S = 0.1
"""No more than one round of the supervisor's, once for each time that the disk stalls."""
TOLD_AFTER_S = 3.0
"""What lasts no longer is not worth a person's attention, as nothing is lost."""
END_WITHIN_S = 10.0


class WriteBehind:
    """Hands a writer what it is to write, in order. One thread may call this.

    Args:
        writer: nobody else's from now on.
    """

    def __init__(self, writer: LogWriter) -> None:
        self._writer = writer
        self._waiting: deque[Callable[[], None]] = deque()
        """The first is being done."""
        self._behind_since_s: float | None = None
        self._left_out = 0
        self._ends = False
        self._changed = threading.Condition()
        # A daemon, since it may be held up when the box ends.
        self._thread = threading.Thread(target=self._do_all, name="log", daemon=True)
        self._thread.start()

    @property
    def problem(self) -> str:
        """Why nothing is being kept; empty if it is."""
        with self._changed:
            since_s, left_out = self._behind_since_s, self._left_out
        held_up = since_s is not None and time.monotonic() - since_s > TOLD_AFTER_S
        return HELD_UP if held_up or left_out else self._writer.problem

    def write(self, record: LogRecord) -> None:
        """Keep a record, or count it as lost."""
        self._hand_over(partial(self._writer.write, record))

    def try_again(self, time: dt.datetime) -> None:
        """If the writer has a problem, have it see whether that is over."""
        if self._behind_since_s is None:
            self._hand_over(partial(self._writer.try_again, time))

    def close(self, held_up: Callable[[], None]) -> int:
        """Have everything written and let go of the files; how many lines were given up, as the disk did not take them in time.

        Args:
            held_up: called before the disk is waited for longer than for a moment.
        """
        with self._changed:
            self._ends = True
            self._changed.notify_all()
        self._thread.join(PATIENCE_S)
        if self._thread.is_alive():
            held_up()
            self._thread.join(END_WITHIN_S)
        if self._thread.is_alive():
            with self._changed:
                return len(self._waiting) + self._left_out
        self._writer.close()
        return 0

    def _hand_over(self, job: Callable[[], None]) -> None:
        with self._changed:
            # Once something was left out, all is until that can be told, so that it is told in its place.
            if self._left_out or len(self._waiting) >= ROOM:
                self._left_out += 1
                return
            self._waiting.append(job)
            self._changed.notify_all()
            if self._behind_since_s is None and not self._changed.wait_for(lambda: not self._waiting, PATIENCE_S):
                self._behind_since_s = time.monotonic()

    def _do_all(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._waiting or self._ends)
                if not self._waiting:
                    return
                job = self._waiting[0]
            job()
            with self._changed:
                self._waiting.popleft()
                if not self._waiting:
                    self._catch_up()
                self._changed.notify_all()

    def _catch_up(self) -> None:
        if self._left_out:
            self._writer.lose(self._left_out, HELD_UP)
            self._left_out = 0
            self._waiting.append(partial(self._writer.try_again, dt.datetime.now(dt.UTC)))
        else:
            self._behind_since_s = None
