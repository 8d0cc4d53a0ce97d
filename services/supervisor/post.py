"""A post that has to be manned: one process of the box, whether it runs, waits for its restart or was given up."""

from collections.abc import Iterable
from dataclasses import dataclass, field

from models.config.site import SupervisorConfig
from models.errors import USER_ERROR_CODE
from models.messages.health import Restarts, State
from models.messages.trouble import Trouble, TroubleCode
from models.process import EVALUATION, REPLAY, ROUTER
from services.supervisor.child import Child, ChildSpec
from services.supervisor.policy import GiveUp, History, Restart, decide, try_again
from services.support.signals import signal_name

SETTLES_WITHIN_S = 10.0
"""While a box starts, its parts wait for one another and rightly call themselves degraded; to a person that is no news yet."""
_UNSETTLED: tuple[State, ...] = ("starting", "degraded")


@dataclass
class Post:
    """What is known of one process.

    Attributes:
        waits: it is not started yet because others are more urgent.
        child: the running process; None while it waits or when it was given up.
        start_at_s: when to start it next, on CLOCK_MONOTONIC; None if it runs or was given up.
        trouble: why it is being restarted; empty once it has been heard of again.
        given_up: why it was given up; empty if it was not.
        reported: the state that a person was last told.
        told: the troubles that a person was told of since the process was well.
        first_heard_s: when the running process spoke first, on CLOCK_MONOTONIC; None if it has not.
        works_since_s: when it first said that it is more than starting; None if it has not.
        ended_s: when it ended last or could not be started, on CLOCK_MONOTONIC; None if it never did.
        last_end: what became of it then, as a verb.
        hangs: the running process was found hung, and is being killed for it.
        worked: a process of it was at work since the box was started.
        refusal: what a person must do until it can be manned, in the words of the process that ended with them; empty while it is.
        history: its restarts until now, by which it is decided whether there is another.
        refusals: those restarts that followed a line for people.
    """

    spec: ChildSpec
    waits: bool = False
    child: Child | None = None
    start_at_s: float | None = None
    trouble: str = ""
    given_up: str = ""
    reported: str = "ok"
    told: set[TroubleCode] = field(default_factory=set)
    first_heard_s: float | None = None
    works_since_s: float | None = None
    ended_s: float | None = None
    last_end: str = ""
    hangs: bool = False
    worked: bool = False
    refusal: str = ""
    history: History = field(default_factory=History)
    refusals: History = field(default_factory=History)

    @property
    def name(self) -> str:
        """The process's name on the bus."""
        return self.spec.name

    def manned_by(self, child: Child) -> None:
        """The process was started."""
        self.child, self.start_at_s, self.hangs, self.refusal = child, None, False, ""

    def reports(self, state: str, troubles: Iterable[TroubleCode], now_s: float) -> bool:
        """The process told its state and what is wrong: whether that is news for a person.

        A trouble is news once until the process is well again, so that one that comes and goes fills no log.
        """
        if self.first_heard_s is None:
            self.first_heard_s = now_s
        if state != "starting":
            self.worked = True
            if self.works_since_s is None:
                self.works_since_s = now_s
        if state in _UNSETTLED and now_s - self.first_heard_s < SETTLES_WITHIN_S:
            return False
        new = set(troubles) - self.told
        self.told = self.told | new if state != "ok" else set()
        changed, self.reported = state != self.reported, state
        return changed or bool(new and state != "ok")

    def ended(self, code: int, user_error: str, now_s: float, config: SupervisorConfig) -> None:
        """The process ended: decide what becomes of the post."""
        self.child = None
        self.reported, self.first_heard_s, self.works_since_s = "ok", None, None
        self.told = set()
        if code == USER_ERROR_CODE and user_error and not self.hangs:
            self._refused(user_error, now_s, config)
        else:
            self._failed("hung" if self.hangs else describe_exit(code), now_s, config)

    def not_started(self, error: OSError, now_s: float, config: SupervisorConfig) -> None:
        """The machine could not start the process: decide what becomes of the post, as if it had ended."""
        self.start_at_s = None
        self._failed(f"could not be started ({error.strerror})", now_s, config)

    def _refused(self, line: str, now_s: float, config: SupervisorConfig) -> None:
        """The process ended with a line that says what a person must do.

        When the box is started somebody is there to read it, and nothing was there before that could come back. Later on a lesson
        is running, and what was there may return by itself or by that person's hand. What is taught was read before the start: if
        it cannot be any more, somebody is just at work on it.
        """
        why = f"said: {line}"
        first = not self.worked and self.ended_s is None and self.spec.entry != EVALUATION
        if self.spec.entry == REPLAY or first:
            self.ended_s, self.last_end = now_s, why
            self._give_up(line)
        elif self.spec.entry == ROUTER:
            self._failed(why, now_s, config)  # Nobody is heard while it waits, and given up it is stood in for.
        else:
            restart = try_again(self.refusals, now_s)
            self.refusals = self.refusals.add(restart)
            self.ended_s, self.last_end, self.start_at_s = now_s, why, restart.at_s
            self.refusal = f"{line}; it is tried again"
            self.trouble = f"{self.name} {why}; it is tried again"

    def _failed(self, why: str, now_s: float, config: SupervisorConfig) -> None:
        self.ended_s, self.last_end = now_s, why
        decision = decide(self.history, now_s, config)
        match decision:
            case GiveUp(reason):
                self._give_up(f"{reason}; last, it {why}")
            case Restart(at_s):
                self.history = self.history.add(decision)
                self.start_at_s = at_s
                self.trouble = f"{self.name} {why} and is started again"

    def _give_up(self, why: str) -> None:
        self.given_up, self.trouble = why, ""

    @property
    def absence(self) -> Trouble | None:
        """What is said in its place; None if a process speaks for itself, or will at once."""
        if self.given_up:
            return Trouble("given_up", self.given_up)
        return Trouble("restarting", self.refusal) if self.refusal else None

    @property
    def restarts(self) -> Restarts | None:
        """What is told of it on the bus; None if it never ended."""
        if self.ended_s is None:
            return None
        count = len(self.history.restarts_s) + len(self.refusals.restarts_s)
        return Restarts(self.name, count, round(self.ended_s * 1e9), self.last_end, self.given_up)


def describe_exit(code: int) -> str:
    """What became of a process, as a verb."""
    if code >= 0:
        return f"ended with exit code {code}"
    return f"was ended by {signal_name(-code)}"
