"""Spares: processes that have imported and warmed up everything and wait, so that a lesson does not wait for that.

Fusion takes two seconds of CPU to start, on a box whose CPU is in use, and everybody waits for it; the page's server takes one. A
spare has no place on the bus and costs memory only. When its post falls vacant it is told to begin.
"""

from collections.abc import Callable, Iterator

from models.process import ROUTER
from services.supervisor.child import Child, ChildSpec
from services.supervisor.journal import Journal

KEPT_FOR = (ROUTER, "tablet")
"""Those without whom nobody sees a figure. A camera that starts anew is stood in for by the others; while the evaluation does, at
most the attempt that is under way goes without a word, which is not worth the memory of a second one."""
AFTER_S = 3.0
"""So long a post must have been at work: the box that starts, compiles or mends itself needs the CPU more."""
AGAIN_AFTER_S = 60.0
"""A spare that ended by itself is not replaced sooner."""


class Spares:
    """At most one waiting process a post.

    Args:
        begin: starts a process of a kind that waits.
        journal: takes what spares say.
    """

    def __init__(self, begin: Callable[[ChildSpec], Child], journal: Journal) -> None:
        self._begin = begin
        self._journal = journal
        self._waiting: dict[str, Child] = {}
        self._not_before_s: dict[str, float] = {}

    def take(self, name: str) -> Child | None:
        """The spare of a post, told to begin; None if there is none that can. One that is not ready yet begins when it is."""
        spare = self._waiting.get(name)
        if spare is None:
            return None
        self._look_at(name, spare)
        del self._waiting[name]
        if spare.poll() is not None:
            spare.close()
            return None
        spare.begin()
        return spare

    def keep(self, spec: ChildSpec, works_since_s: float | None, now_s: float) -> None:
        """Look after the spare of a post: pass on what it says, bury one that ended, start one that is missing.

        Args:
            spec: of the post.
            works_since_s: when the process of the post first said that it works; None if it has not.
            now_s: CLOCK_MONOTONIC.
        """
        spare = self._waiting.get(spec.name)
        if spare is not None:
            self._look_at(spec.name, spare)
            if spare.poll() is not None:
                spare.close()
                del self._waiting[spec.name]
                self._not_before_s[spec.name] = now_s + AGAIN_AFTER_S
        elif works_since_s is not None and now_s >= max(works_since_s + AFTER_S, self._not_before_s.get(spec.name, 0.0)):
            try:
                self._waiting[spec.name] = self._begin(spec)
            except OSError as error:
                self._not_before_s[spec.name] = now_s + AGAIN_AFTER_S
                self._journal.say(f"a spare of {spec.name} could not be started ({error.strerror})", level="warning")

    def _look_at(self, name: str, spare: Child) -> None:
        """Hear what a spare says, and end one that is stopped: it would take the post and do nothing there."""
        was_ready = spare.ready
        for line in spare.lines():
            self._journal.child_said(name, line)
        if spare.ready and not was_ready:
            self._journal.note(f"a spare of {name} is ready")
        if spare.stopped:
            self._journal.say(f"the spare of {name} was stopped by a signal and is ended", level="warning")
            spare.kill()
            spare.wait()

    def dismiss(self) -> None:
        """End all of them."""
        for spare in self._all():
            spare.kill()
            spare.wait()
            spare.close()

    def _all(self) -> Iterator[Child]:
        while self._waiting:
            yield self._waiting.popitem()[1]
