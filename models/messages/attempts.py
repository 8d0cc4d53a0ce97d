"""The list of attempts that every page shows: since when it counts, and what the evaluation remembers of it.

The list begins anew when a recording begins, when a teacher says so where nobody records, and with each round of a replay. The
page's server keeps it; the evaluation remembers the newest attempts and how many there were, and tells them again to a server that
was started again. Of two beginnings the later one counts, whoever tells of it and however often.
"""

from typing import Final

import msgspec

from models.messages.feedback import Feedback
from models.messages.pupil import Count

REMEMBERED: Final = 50
"""Attempts that are listed and remembered: two lessons of one pupil. As messages they are some 3 MB, and never more than 27."""


class AttemptsBegin(msgspec.Struct, frozen=True):
    """Since when attempts are listed and counted (tablet, replay -> evaluation).

    Attributes:
        t_ns: CLOCK_MONOTONIC; what was published before it is not of the list.
        count: how many were published since, as far as the server has heard.
        newest: `Feedback.id` of the last of them; 0 if there is none.
    """

    t_ns: Count
    count: Count = 0
    newest: Count = 0


class FeedbackRequest(msgspec.Struct, frozen=True):
    """Asks for an attempt that is remembered (tablet -> evaluation): one at a time, so that none displaces another on its way.

    Attributes:
        before: the newest one is wanted whose `Feedback.id` is smaller.
    """

    before: Count


class RememberedFeedback(msgspec.Struct, frozen=True, eq=False):
    """The answer to a `FeedbackRequest` (evaluation -> tablet). Not on the topic of feedback, whose every message is news.

    Attributes:
        feedback: None if none is remembered that is older.
        older: how many still older ones are remembered.
    """

    feedback: Feedback | None
    older: Count
