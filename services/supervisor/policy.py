"""When a process that ended is started again. Pure: times come in, a decision goes out.

All processes of the box are meant to run until they are told to stop, so every end is a fault. The first restart comes at once,
since a lesson is running; further ones wait longer and longer; and one that fails more often than the site file allows is given
up, because it would only take the CPU away from those that work.
"""

from dataclasses import dataclass

from models.config.site import SupervisorConfig

_FIRST_DELAY_S = 0.25
_LONGEST_DELAY_S = 4.0


@dataclass(frozen=True)
class Restart:
    """Start it again at `at_s` on the clock that the decision was asked with."""

    at_s: float


@dataclass(frozen=True)
class GiveUp:
    """Leave it, and say why."""

    reason: str


@dataclass(frozen=True)
class History:
    """The times of the restarts of one process."""

    restarts_s: tuple[float, ...] = ()

    def add(self, restart: Restart) -> "History":
        """This history and one restart more."""
        return History((*self.restarts_s, restart.at_s))


def decide(history: History, now_s: float, config: SupervisorConfig) -> Restart | GiveUp:
    """What to do about a process that ended at `now_s`, after the restarts in `history`."""
    recent = _within(history, now_s, config.window_s)
    restart = Restart(now_s + _delay_s(recent))
    if _within(history, restart.at_s, config.window_s) >= config.max_restarts:
        return GiveUp(f"ended {config.max_restarts + 1} times within {config.window_s:g} s")
    return restart


def _within(history: History, until_s: float, window_s: float) -> int:
    return sum(1 for at_s in history.restarts_s if at_s > until_s - window_s)


def _delay_s(recent: int) -> float:
    return 0.0 if recent == 0 else min(_FIRST_DELAY_S * 2 ** (recent - 1), _LONGEST_DELAY_S)
