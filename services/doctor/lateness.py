"""How late the live figures of a running box come, and what holds them up. Pure."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from statistics import median

from models.messages.motion import Motion
from models.process import ROUTER
from services.doctor.finding import Finding

LATE_MS = 500.0
"""A figure older than this is late, for the page too (`LATE_AT_SERVER_MS` in lateness.ts). Undisturbed it is 100 to 300 ms."""
LESS_TO_DO = "end other programs on this machine, use fewer cameras, or a faster box"


@dataclass(frozen=True)
class Age:
    """How old a live figure was when fusion published it, and when it was heard here."""

    published_ms: float
    heard_ms: float

    @classmethod
    def of(cls, motion: Motion, now_ns: int) -> "Age":
        """As the page's server counts it: since the instant that is shown, or since the newest picture where that is foretold."""
        true_ns = min(motion.t_ns, motion.t_newest_ns)
        return cls((motion.t_published_ns - true_ns) * 1e-6, (now_ns - true_ns) * 1e-6)


def typical_ms(ages: Collection[Age]) -> float:
    """The median of the ages at which figures were heard, of one at least."""
    return median(age.heard_ms for age in ages)


def judge_lateness(ages: Collection[Age], load: str, log: str) -> Iterator[Finding]:
    """What is to be said of it.

    Args:
        ages: of the figures that were heard, while a camera or more works.
        load: words about a machine that is busy; empty if it is not.
        log: the command that shows what fusion said.
    """
    if not ages or (late_ms := typical_ms(ages)) <= LATE_MS:
        return
    published_ms = median(age.published_ms for age in ages)
    if load:
        why, remedy = f"the box is too busy{load}", LESS_TO_DO
    elif published_ms > late_ms / 2:
        why = "the pictures reach fusion late"
        remedy = "check the cameras' cables and network; if it stays so, start the box anew"
    else:
        why = f"they wait on the bus, {published_ms:.0f} ms old when fusion published them"
        remedy = f"read `{log}` and start the box anew"
    words = f"figures come {late_ms:.0f} ms late, too late to teach by: {why}"
    yield Finding("warning", ROUTER, words, "the age of the figures that came over the bus", remedy)
