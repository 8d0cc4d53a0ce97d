"""Which processes hang: they run, but nothing has been heard of them for too long. Pure: times come in, names go out.

Health and heartbeats are what is listened for, since a token of liveliness is held by the network's threads even when the loop of a
process hangs. Before the first health message of its life a process has much more time, because starting up may take a while. All
is heard through the router's process, so while that is silent nobody else can be judged, nor for a while after it is back.
"""

from dataclasses import dataclass, field

LIMIT_S = 3.0
"""Health comes once a second; whoever misses three has hung."""
BEAT_LIMIT_S = 1.5
"""Beats come five times a second from those who beat at all; seven missed in a row are no delay of a busy CPU."""
START_LIMIT_S = 120.0
"""Who was never heard has hung after this long; a box without compiled kernels takes a minute to start. A spare that was
ready has done all that before, and has no longer than who was heard."""
END_LIMIT_S = 10.0
"""Who has said that it ends has hung if it still runs after this long; to tidy up takes seconds on a loaded CPU."""
ROUTER_GAP_SHARE = 0.5
"""A router that is silent for longer than this share of its limit may be what keeps the others silent."""


@dataclass
class Silence:
    """When each process was heard last. `router` is the name of the process through which all are heard."""

    router: str
    _started_s: dict[str, float] = field(default_factory=dict)
    _heard_s: dict[str, float] = field(default_factory=dict)
    _beating: set[str] = field(default_factory=set)
    _ending: set[str] = field(default_factory=set)
    _ready: set[str] = field(default_factory=set)
    _router_back_s: float = float("-inf")

    def start(self, name: str, now_s: float, *, ready: bool = False) -> None:
        """A process was started, or a spare that was `ready` took over."""
        self.forget(name)
        self._started_s[name] = now_s
        if ready:
            self._ready.add(name)

    def get_ready(self, name: str, now_s: float) -> None:
        """A process said that it is still getting ready: it has as much time again as at its start."""
        self._started_s[name] = now_s
        self._ready.discard(name)

    def forget(self, name: str) -> None:
        """A process ended, or it was decided that it shall."""
        self._started_s.pop(name, None)
        self._heard_s.pop(name, None)
        self._beating.discard(name)
        self._ending.discard(name)
        self._ready.discard(name)

    def hear(self, name: str, now_s: float) -> None:
        """A health message of a process arrived."""
        if name == self.router and now_s - self._heard_s.get(name, float("-inf")) > self._router_gap_s():
            self._router_back_s = now_s
        self._heard_s[name] = now_s

    def beat(self, name: str, now_s: float) -> None:
        """A heartbeat of a process arrived: from now on it is expected to beat."""
        self._beating.add(name)
        self.hear(name, now_s)

    def last_beat(self, name: str, now_s: float) -> None:
        """A process said that it ends: nothing more will be heard of it."""
        self._ending.add(name)
        self.hear(name, now_s)

    def restart_clocks(self, now_s: float) -> None:
        """The listener itself was held up: nobody can be blamed for the time until now."""
        self._started_s = dict.fromkeys(self._started_s, now_s)
        self._heard_s = dict.fromkeys(self._heard_s, now_s)
        self._router_back_s = now_s

    def hung(self, now_s: float) -> list[str]:
        """The processes to be taken for hung."""
        router_heard_s = self._heard_s.get(self.router)
        if router_heard_s is None:
            return [self.router] if self._never_came(self.router, now_s) else []
        if now_s - router_heard_s > self._limit_s(self.router):
            return [self.router]
        if self.router in self._ending or now_s - router_heard_s > self._router_gap_s():
            return []
        return [name for name in self._started_s if name != self.router and self._silent(name, now_s)]

    def _limit_s(self, name: str) -> float:
        if name in self._ending:
            return END_LIMIT_S
        return BEAT_LIMIT_S if name in self._beating else LIMIT_S

    def _router_gap_s(self) -> float:
        return ROUTER_GAP_SHARE * self._limit_s(self.router)

    def _silent(self, name: str, now_s: float) -> bool:
        heard_s = self._heard_s.get(name)
        too_long = self._never_came(name, now_s) if heard_s is None else now_s - heard_s > self._limit_s(name)
        # After the router's return everybody has the time of a health message, since links are mended one after the other.
        return too_long and now_s - self._router_back_s > LIMIT_S

    def _never_came(self, name: str, now_s: float) -> bool:
        limit_s = LIMIT_S if name in self._ready else START_LIMIT_S
        return name in self._started_s and now_s - self._started_s[name] > limit_s
