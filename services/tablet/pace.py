"""How fast a client is read. Whoever sends faster waits at his own end: the network holds up what is not read.

A client is not closed for it: what it says is not lost, a page that hung and catches up is no worse off, and one that was closed
would connect again, which costs the box more than reading it slowly.

Reads no clock: every method is told the time.
"""

import math


class Pace:
    """Messages of one client.

    Args:
        hz: messages that are read a second, for long.
        burst: messages that are read at once after a pause.
    """

    def __init__(self, hz: float, burst: int) -> None:
        self._each_s = 1 / hz
        self._burst_s = burst / hz
        self._due_s = -math.inf

    def wait_s(self, now_s: float) -> float:
        """A message was read: how long to wait with the next one."""
        self._due_s = max(self._due_s + self._each_s, now_s - self._burst_s + self._each_s)
        return max(0.0, self._due_s - now_s)
