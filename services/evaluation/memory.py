"""The newest attempts as they were told, for a page's server that was started again. Pure: reads no clock.

What a teacher corrected since is in them, as it is on the list.
"""

from collections import deque
from collections.abc import Iterable

import msgspec

from models.messages.attempts import REMEMBERED, AttemptsBegin, RememberedFeedback
from models.messages.feedback import Feedback
from models.messages.pupil import PupilCorrection


class Memory:
    """The last `REMEMBERED` attempts since the list began, and how many there were.

    Attributes:
        since_ns: CLOCK_MONOTONIC of that; 0 as long as nobody has said it.
        count: attempts since, those of an evaluation before this one included.
    """

    def __init__(self) -> None:
        self.since_ns = 0
        self.count = 0
        self._kept: deque[Feedback] = deque(maxlen=REMEMBERED)

    @property
    def newest(self) -> int:
        """The id of the last attempt that is remembered; 0 if none is."""
        return self._kept[-1].id if self._kept else 0

    def note(self, feedback: Feedback) -> None:
        """An attempt was published."""
        self._kept.append(feedback)
        self.count += 1

    def begin(self, begin: AttemptsBegin) -> bool:
        """The list began anew, or did so earlier without this evaluation; False if that is no news."""
        if begin.t_ns <= self.since_ns:
            return False
        self._forget_until(begin.t_ns)
        self.since_ns = begin.t_ns
        self.count = begin.count + sum(feedback.id > begin.newest for feedback in self._kept)
        return True

    def correct(self, corrections: Iterable[PupilCorrection]) -> None:
        """Give attempts to other pupils."""
        codes = {one.attempt: one.pupil for one in corrections}
        for place, feedback in enumerate(self._kept):
            if feedback.id in codes:
                self._kept[place] = msgspec.structs.replace(feedback, pupil=codes[feedback.id])

    def before(self, attempt_id: int) -> RememberedFeedback:
        """The newest attempt of a smaller id, and how many still older ones there are."""
        older = [feedback for feedback in self._kept if feedback.id < attempt_id]
        return RememberedFeedback(older[-1] if older else None, max(len(older) - 1, 0))

    def _forget_until(self, t_ns: int) -> None:
        kept = [feedback for feedback in self._kept if feedback.t_published_ns >= t_ns]
        self._kept.clear()
        self._kept.extend(kept)
