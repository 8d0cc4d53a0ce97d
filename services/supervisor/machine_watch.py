"""The machine as the supervisor watches it: measured once a second, and told to a person when something becomes wrong."""

from collections.abc import Callable

from models.messages.health import MachineHealth
from models.messages.trouble import Trouble
from services.support.machine_troubles import machine_troubles

PERIOD_S = 1.0
QUIET_S = 60.0
"""A trouble that comes and goes is told again only after it was away for so long."""


class MachineWatch:
    """Keeps the newest measurement.

    Args:
        measure: reads the machine.
    """

    def __init__(self, measure: Callable[[], MachineHealth]) -> None:
        self._measure = measure
        self._next_s = float("-inf")
        self._seen_s: dict[str, float] = {}
        self._unreadable: Trouble | None = None
        self.newest: MachineHealth | None = None
        """None before the first measurement, and while the machine cannot be measured."""

    @property
    def troubles(self) -> tuple[Trouble, ...]:
        """All that is wrong now."""
        if self._unreadable is not None:
            return (self._unreadable,)
        return machine_troubles(self.newest) if self.newest is not None else ()

    def look(self, now_s: float) -> list[Trouble]:
        """Measure if a second has passed, and return what a person has to be told of it for the first time."""
        if now_s < self._next_s:
            return []
        self._next_s = now_s + PERIOD_S
        try:
            self.newest, self._unreadable = self._measure(), None
        except OSError as error:  # No descriptor is left, or no memory: the box must go on for as long as it can.
            words = f"the machine cannot be measured ({error.strerror})"
            remedy = "end other programs that hold many files or much memory"
            self.newest, self._unreadable = None, Trouble("machine_unmeasured", words, remedy)
        troubles = self.troubles
        news = [trouble for trouble in troubles if now_s - self._seen_s.get(trouble.code, float("-inf")) > QUIET_S]
        self._seen_s |= {trouble.code: now_s for trouble in troubles}
        return news
