"""Speaking on a thread of its own: whoever speaks never waits for the network.

Zenoh's `put` waits for nobody by contract, but a session whose router was stopped in the middle of a handshake has been reported to
hold up whatever is asked of it for many seconds (eclipse-zenoh/zenoh, issue 1876). A supervisor that waits with it finds nobody
out who hangs, and that very router is what it has to find out.
"""

import contextlib
import threading
from collections.abc import Callable

_END_WITHIN_S = 0.5


class Speaker:
    """Says one thing at a time.

    Args:
        failures: what saying may raise when the bus is gone; nobody hears it then, and nothing else is wrong.
    """

    def __init__(self, *failures: type[Exception]) -> None:
        self._failures = failures
        self._words: Callable[[], object] | None = None
        self._ends = False
        self._changed = threading.Condition()
        # A daemon, since it may be held up when the box ends.
        self._thread = threading.Thread(target=self._speak, name="speaker", daemon=True)
        self._thread.start()

    @property
    def busy(self) -> bool:
        """Whether it still says what it was given last."""
        with self._changed:
            return self._words is not None

    def say(self, words: Callable[[], object]) -> None:
        """Call `words` on the speaker's thread; they are left out if it is busy."""
        with self._changed:
            if self._words is None:
                self._words = words
                self._changed.notify()

    def end(self) -> None:
        """Say nothing more; who is held up is left behind."""
        with self._changed:
            self._ends = True
            self._changed.notify()
        self._thread.join(_END_WITHIN_S)

    def _speak(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._words is not None or self._ends)
                words = self._words
                if self._ends or words is None:
                    return
            with contextlib.suppress(*self._failures):
                words()
            with self._changed:
                self._words = None
