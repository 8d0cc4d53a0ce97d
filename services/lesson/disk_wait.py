"""A disk that holds up a write is no recorder that hangs: while the loop waits for it, somebody says so in the loop's place.

A card that tidies up, or a disk that others write to, holds up a sync for seconds. Whoever kills the recorder for that makes no
disk faster, and has the lesson read through on it again. It is not said for ever: after `LONGEST_S` fusion keeps nothing more for
the recorder, and a loop that hangs in something else must be found out.
"""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import TracebackType

from models.messages.lesson import LEASE_NS

QUIET_S = 1.0
"""A usual disk takes milliseconds; the supervisor waits for three seconds."""
LONGEST_S = LEASE_NS * 1e-9
_LOOK_EVERY_S = 0.25


class DiskWait:
    """Watches, on a thread of its own, how long the loop has been at work with the disk.

    Args:
        tell: called several times a second, with the seconds for which the loop has waited; never once the loop goes on.
        quiet_s: nothing is told before.
        longest_s: nothing is told after that.
    """

    def __init__(self, tell: Callable[[float], None], quiet_s: float = QUIET_S, longest_s: float = LONGEST_S) -> None:
        self._tell = tell
        self._quiet_s = quiet_s
        self._longest_s = longest_s
        self._began_s: float | None = None
        self._telling = threading.Lock()
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="disk-wait", daemon=True)

    def __enter__(self) -> "DiskWait":
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._ends.set()
        self._thread.join()

    @contextmanager
    def at_work(self) -> Iterator[None]:
        """What the body does may take as long as the disk pleases."""
        self._began_s = time.monotonic()
        try:
            yield
        finally:
            with self._telling:
                self._began_s = None

    def _watch(self) -> None:
        while not self._ends.wait(_LOOK_EVERY_S):
            with self._telling:
                if self._began_s is None:
                    continue
                waited_s = time.monotonic() - self._began_s
                if self._quiet_s <= waited_s <= self._longest_s:
                    self._tell(waited_s)
