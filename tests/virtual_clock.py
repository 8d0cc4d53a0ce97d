"""A clock for tests: time passes only while somebody waits."""

from dataclasses import dataclass


@dataclass
class VirtualClock:
    """See `edge.cameras.source.Clock`.

    Attributes:
        t_ns: now.
    """

    t_ns: int

    def now_ns(self) -> int:
        return self.t_ns

    def sleep_until(self, t_ns: int) -> None:
        self.t_ns = max(self.t_ns, t_ns)
