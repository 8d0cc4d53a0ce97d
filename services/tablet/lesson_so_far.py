"""The list of attempts, whoever is started again meanwhile: what evaluation, recorder and teacher say of it comes together here.

The evaluation remembers the newest attempts, and is asked for them one after the other, the newest first: by a server that was
started again for all, and else for what was lost on its way. Reads no clock: every method is told the time where it matters.
"""

from collections.abc import Callable
from typing import Final

from models.messages.attempts import AttemptsBegin, FeedbackRequest, RememberedFeedback
from models.messages.feedback import Feedback
from models.messages.health import EvaluationHealth, RecorderHealth
from services.tablet.attempts import KEPT, Attempts
from services.tablet.messages import AttemptList

PATIENCE_NS: Final = 3_000_000_000
"""So long a server that has just started waits for the evaluation's next word of what it remembers; then it shows what it has."""
_ALL: Final = 2**63 - 1


class LessonSoFar:
    """Attempts, since when they are listed, and who knows of those before.

    Args:
        tell: takes what is to be said to the evaluation.
        started_ns: CLOCK_MONOTONIC at the server's start.
    """

    def __init__(self, tell: Callable[[AttemptsBegin | FeedbackRequest], None], started_ns: int) -> None:
        self.attempts = Attempts()
        self._tell = tell
        self._heard_ns = started_ns
        self._wanted: int | None = _ALL
        self._complete = False
        self._nobody_knew = True
        self._recorded: tuple[int, ...] = ()
        self._evaluation_heard = False

    def shown(self, now_ns: int, *, restarted: bool) -> AttemptList | None:
        """What the pages show; None while the evaluation has yet to tell what it remembers.

        Args:
            now_ns: CLOCK_MONOTONIC.
            restarted: there was a server before this one.
        """
        if not self._complete and now_ns - self._heard_ns < PATIENCE_NS:
            return None
        shown = self.attempts.shown
        if len(shown) < KEPT and any(attempt not in self.attempts for attempt in self._recorded):
            return AttemptList(attempts=shown, earlier="recorded")
        missing = len(shown) < KEPT and next((one.number for one in shown if one.number is not None), 1) > 1
        lost = missing or (restarted and self._nobody_knew)
        return AttemptList(attempts=shown, earlier="lost" if lost else "listed")

    def begin(self, now_ns: int) -> None:
        """The teacher wants the list to begin anew."""
        self._begin(now_ns)
        self._tell(self._beginning())

    def hear_evaluation(self, evaluation: EvaluationHealth, now_ns: int) -> None:
        """Of two beginnings the later one counts; then what is missing on the list is asked for."""
        since_ns = evaluation.list_since_ns
        if not self._evaluation_heard:
            self._evaluation_heard = True
            self._nobody_knew &= since_ns == 0
        if self.attempts.since_ns < since_ns <= now_ns:
            self._begin(since_ns)
        elif since_ns < self.attempts.since_ns:
            self._tell(self._beginning())
        if not evaluation.list_newest:
            self._have_all()
            if since_ns == self.attempts.since_ns and not len(self.attempts):
                # It was started again, and has the count from the server before this one, but no attempt.
                self.attempts.numbering.counted(0, evaluation.list_count)
                self._nobody_knew |= evaluation.list_count > 0
        elif since_ns == self.attempts.since_ns:
            self.attempts.numbering.counted(evaluation.list_newest, evaluation.list_count)
            if evaluation.list_newest not in self.attempts:
                self._wanted = _ALL
            if self._wanted is not None:
                self._tell(FeedbackRequest(self._wanted))

    def hear_remembered(self, remembered: RememberedFeedback, now_ns: int) -> None:
        """The evaluation's answer. One that was not asked for, as when it came twice, changes nothing."""
        feedback, wanted = remembered.feedback, self._wanted
        if wanted is None or (feedback is not None and feedback.id >= wanted):
            return
        if feedback is None:
            self._have_all()
            return
        known = feedback.id in self.attempts
        self.attempts.take(feedback)
        if not remembered.older or (known and self._complete):
            self._have_all()
            return
        self._wanted, self._heard_ns = feedback.id, now_ns
        self._tell(FeedbackRequest(feedback.id))

    def hear_recorder(self, recorder: RecorderHealth, now_ns: int) -> None:
        """A recording that begins empties the list; what its file holds has the file's numbers."""
        if not recorder.lesson:
            return  # What was recorded keeps its numbers.
        if self.attempts.since_ns < recorder.began_ns <= now_ns:
            self._begin(recorder.began_ns)
            self._tell(self._beginning())
        self._recorded = recorder.newest
        self.attempts.numbering.recorded(recorder.attempts, recorder.newest)

    def take(self, feedback: Feedback) -> None:
        """An attempt ended."""
        self.attempts.take(feedback)

    def _begin(self, since_ns: int) -> None:
        self.attempts.begin(since_ns)
        self._recorded = ()
        self._nobody_knew = False

    def _beginning(self) -> AttemptsBegin:
        newest, count = self.attempts.last
        return AttemptsBegin(self.attempts.since_ns, count, newest)

    def _have_all(self) -> None:
        self._wanted = None
        self._complete = True
