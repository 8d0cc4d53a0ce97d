"""Who holds a token on the bus. The router's end takes every token with it, and that is no news of the others.

Reads no clock: every method is told the time.
"""

from dataclasses import dataclass

BURST_NS = 500_000_000
"""The tokens that the router's end takes away vanish in any order, and on a busy machine not at once."""
REJOIN_NS = 2_000_000_000
"""Links are mended one after the other: so long after somebody routes again a process may still be on its way back."""


@dataclass(frozen=True)
class Presence:
    """Whether a process holds its token on the bus, and since when.

    Attributes:
        alive: None if that is not known: not seen yet, or not to be seen without a router.
        since_ns: CLOCK_MONOTONIC.
        cut_off: nobody routes, or only since a moment ago: the process cannot be heard, however well it is.
    """

    alive: bool | None
    since_ns: int
    cut_off: bool = False


class Presences:
    """The tokens of all processes.

    Args:
        router: the process through which all others are seen.
        started_ns: CLOCK_MONOTONIC since when anybody could have been seen.
    """

    def __init__(self, router: str, started_ns: int) -> None:
        self._router = router
        self._started_ns = started_ns
        self._seen: dict[str, Presence] = {}
        self._router_lost_ns: int | None = None
        self._stood_in_ns: int | None = None

    def note(self, process: str, alive: bool, now_ns: int) -> None:
        """A token came or went."""
        if process == self._router and not alive:
            self._router_lost_ns = now_ns
        self._seen[process] = Presence(alive, now_ns)

    def note_stand_in(self, now_ns: int) -> None:
        """Somebody routes in the router's place, from now on or since earlier: its token will not come back."""
        if self._stood_in_ns is None:
            self._stood_in_ns = now_ns

    def of(self, process: str, now_ns: int) -> Presence:
        """One process at `now_ns`."""
        seen = self._seen.get(process, Presence(None, self._started_ns))
        if process == self._router or not self._outage(now_ns):
            return seen
        lost_ns = self._router_lost_ns or 0
        unknown = seen.alive is False and seen.since_ns >= lost_ns - BURST_NS
        return Presence(None if unknown else seen.alive, seen.since_ns, cut_off=True)

    def _outage(self, now_ns: int) -> bool:
        if self._router_lost_ns is None:
            return False
        router = self._seen[self._router]
        back_ns = router.since_ns if router.alive else self._stood_in_ns
        return back_ns is None or now_ns - back_ns < REJOIN_NS
