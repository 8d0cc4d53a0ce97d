"""A post that has to be manned: one process of the box, whether it runs, waits for its restart or was given up."""

import signal
from dataclasses import dataclass, field

from models.config.site import SupervisorConfig
from models.errors import USER_ERROR_CODE
from services.supervisor.child import Child, ChildSpec
from services.supervisor.policy import GiveUp, History, Restart, decide


@dataclass
class Post:
    """What is known of one process.

    Attributes:
        child: the running process; None while it waits or when it was given up.
        start_at_s: when to start it next, on CLOCK_MONOTONIC; None if it runs or was given up.
        trouble: why it is being restarted; empty once it has been heard of again.
        given_up: why it was given up; empty if it was not.
        reported: the state that its health last told.
    """

    spec: ChildSpec
    child: Child | None = None
    start_at_s: float | None = None
    trouble: str = ""
    given_up: str = ""
    reported: str = "ok"
    hangs: bool = False
    history: History = field(default_factory=History)

    @property
    def name(self) -> str:
        """The process's name on the bus."""
        return self.spec.name

    def manned_by(self, child: Child) -> None:
        """The process was started."""
        self.child, self.start_at_s, self.hangs = child, None, False

    def ended(self, code: int, user_error: str, now_s: float, config: SupervisorConfig) -> None:
        """The process ended: decide what becomes of the post."""
        self.child = None
        self.reported = "ok"
        if code == USER_ERROR_CODE and not self.hangs:
            self.given_up = user_error or describe_exit(code)
            return
        why = "hung" if self.hangs else describe_exit(code)
        decision = decide(self.history, now_s, config)
        match decision:
            case GiveUp(reason):
                self.given_up = f"{reason}; last, it {why}"
            case Restart(at_s):
                self.history = self.history.add(decision)
                self.start_at_s = at_s
                self.trouble = f"{self.name} {why} and is started again"


def describe_exit(code: int) -> str:
    """What became of a process, as a verb."""
    if code >= 0:
        return f"ended with exit code {code}"
    return f"was ended by {signal.Signals(-code).name}"
