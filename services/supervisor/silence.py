"""Which processes hang: they run, but nothing has been heard of them for too long. Pure: times come in, names go out.

Health is what is listened for, since a token of liveliness is held by the network's threads even when the loop of a process
hangs. Nobody is judged before the first health message of its life, because starting up may take a while. All health
comes through the router's process, so while that is silent nobody else can be judged, nor for a while after it is back.
"""

from dataclasses import dataclass, field

LIMIT_S = 3.0
"""Health comes once a second; whoever misses three has hung."""
ROUTER_GAP_S = 1.5
"""A router that is silent for longer than this may be what keeps the others silent."""


@dataclass
class Silence:
    """When each process was heard last. `router` is the name of the process through which all are heard."""

    router: str
    _heard_s: dict[str, float] = field(default_factory=dict)
    _router_back_s: float = float("-inf")

    def forget(self, name: str) -> None:
        """A process ended or was started: it is judged from its next message on."""
        self._heard_s.pop(name, None)

    def hear(self, name: str, now_s: float) -> None:
        """A health message of a process arrived."""
        if name == self.router and now_s - self._heard_s.get(name, float("-inf")) > ROUTER_GAP_S:
            self._router_back_s = now_s
        self._heard_s[name] = now_s

    def restart_clocks(self, now_s: float) -> None:
        """The listener itself was held up: nobody can be blamed for the time until now."""
        self._heard_s = dict.fromkeys(self._heard_s, now_s)
        self._router_back_s = now_s

    def hung(self, now_s: float) -> list[str]:
        """The processes to be taken for hung."""
        router_heard_s = self._heard_s.get(self.router)
        if router_heard_s is None:
            return []
        if now_s - router_heard_s > LIMIT_S:
            return [self.router]
        if now_s - router_heard_s > ROUTER_GAP_S:
            return []
        return [
            name
            for name, heard_s in self._heard_s.items()
            if name != self.router and now_s - max(heard_s, self._router_back_s) > LIMIT_S
        ]
