"""When the recorder asks fusion for its log. Pure."""

from dataclasses import dataclass

EVERY_NS = 1_000_000_000
"""Fusion takes a recorder that asks for nothing within `LEASE_NS` for gone."""
SILENT_AFTER_NS = 600_000_000
"""A part comes every half second: after longer than that, fusion has begun anew and waits to be asked, or is not there."""
SILENT_EVERY_NS = 250_000_000
"""What passes in a new fusion before it is asked is lost."""


@dataclass
class Asking:
    """Times on CLOCK_MONOTONIC."""

    _heard_ns: int = 0
    _asked_ns: int = 0

    def heard(self, now_ns: int) -> None:
        """A part came."""
        self._heard_ns = now_ns

    def due(self, now_ns: int) -> bool:
        """Whether to ask now; if so, that is done."""
        every_ns = SILENT_EVERY_NS if now_ns - self._heard_ns > SILENT_AFTER_NS else EVERY_NS
        if now_ns - self._asked_ns < every_ns:
            return False
        self._asked_ns = now_ns
        return True
