"""When a process that ended is started again. Pure: times come in, a decision goes out.

All processes of the box are meant to run until they are told to stop, so every end is a fault. The first restart comes at once,
since a lesson is running; further ones wait longer and longer; and one that fails more often than the site file allows is given
up, because it would only take the CPU away from those that work.

One that worked, and now ends with a line that says what a person must do, is not given up: a disk, a file or a port is away, and
once that is over nobody shall have to start the box anew. It is tried seldom enough to take no CPU from the others.
"""

from dataclasses import dataclass

from models.config.site import SupervisorConfig

_FIRST_DELAY_S = 0.25
_LONGEST_DELAY_S = 4.0
LONGEST_WAIT_S = 30.0
"""Nobody who has just mended what a process needs looks for another fault sooner."""
_REFUSALS_FADE_S = 300.0
"""After this long a refusal delays nothing any more; longer than it takes to come to the longest wait, and to stay with it."""


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
    restart = Restart(now_s + _delay_s(recent, _LONGEST_DELAY_S))
    if _within(history, restart.at_s, config.window_s) >= config.max_restarts:
        return GiveUp(f"ended {config.max_restarts + 1} times within {config.window_s:g} s")
    return restart


def try_again(refusals: History, now_s: float) -> Restart:
    """When to start a process again that worked in this run and has now, after the `refusals` in history, said why it cannot."""
    return Restart(now_s + _delay_s(_within(refusals, now_s, _REFUSALS_FADE_S), LONGEST_WAIT_S))


def _within(history: History, until_s: float, window_s: float) -> int:
    return sum(1 for at_s in history.restarts_s if at_s > until_s - window_s)


def _delay_s(recent: int, longest_s: float) -> float:
    return 0.0 if recent == 0 else min(_FIRST_DELAY_S * 2 ** (recent - 1), longest_s)
