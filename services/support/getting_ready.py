"""A process that takes long to get ready says so, instead of being taken for hung.

The kernels of fusion are compiled at the first start after an update, which takes a minute on two idle cores and several on a busy
box; a recorder reads through the lessons that a crash left. Nothing of the process's loop runs meanwhile, so a thread says it once
a second; not for ever, since a process that really hangs must be found out.
"""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

from models.messages.trouble import Trouble
from models.process import Bus
from services.support.health import PERIOD_S, HealthReporter, ResourceMeter

QUIET_S = 3.0
"""A usual start is over by then, and needs no words."""
LONGEST_S = 600.0
_COMPILES = "the first start after an update compiles for some minutes"


@contextmanager
def getting_ready(
    process: str, bus: Bus, doing: str = _COMPILES, quiet_s: float = QUIET_S, longest_s: float = LONGEST_S
) -> Iterator[None]:
    """While the body runs, say on the bus that the process is "starting".

    Args:
        process: its name on the bus.
        bus: where to say it.
        doing: what takes so long, for people.
        quiet_s: nothing is said before.
        longest_s: nothing is said after that.
    """
    ready = threading.Event()

    def speak() -> None:
        reporter = HealthReporter(process, bus, ResourceMeter())
        if ready.wait(quiet_s):
            return
        for _ in range(round(longest_s / PERIOD_S)):
            reporter.report("starting", (Trouble("getting_ready", f"getting ready: {doing}"),))
            if ready.wait(PERIOD_S):
                return

    speaker = threading.Thread(target=speak, name="getting-ready", daemon=True)
    speaker.start()
    try:
        yield
    finally:
        ready.set()
        speaker.join()
