"""The newest attempts: as the page shows them, and packed for its slow replay. Reads no clock."""

from collections import OrderedDict
from typing import NamedTuple

from models.messages.feedback import Feedback
from services.tablet import attempt_replay
from services.tablet.messages import Attempt, AttemptMeasure

KEPT = 50
"""Two lessons of one pupil; each takes some 40 KB."""


class _Kept(NamedTuple):
    shown: Attempt
    replay: bytes


class Attempts:
    """The last `KEPT` attempts, by their ids, in the order in which they came."""

    def __init__(self) -> None:
        self._kept: OrderedDict[int, _Kept] = OrderedDict()

    def take(self, feedback: Feedback) -> Attempt | None:
        """Keep an attempt; None if it is kept already, as when its message came twice."""
        if feedback.id in self._kept:
            return None
        shown = shown_of(feedback)
        self._kept[feedback.id] = _Kept(shown, attempt_replay.pack(attempt_replay.from_feedback(feedback)))
        while len(self._kept) > KEPT:
            self._kept.popitem(last=False)
        return shown

    @property
    def shown(self) -> list[Attempt]:
        """All that are kept, the oldest first."""
        return [kept.shown for kept in self._kept.values()]

    def replay(self, attempt_id: int) -> bytes | None:
        """An attempt in the layout of `attempt_replay`; None if it is not kept (any more)."""
        kept = self._kept.get(attempt_id)
        return kept.replay if kept is not None else None


def shown_of(feedback: Feedback) -> Attempt:
    """What the page says of an attempt."""
    start_ns, end_ns = feedback.keyframes_ns[0], feedback.keyframes_ns[-1]
    measures = {measure.name: measure for measure in feedback.measures}
    return Attempt(
        id=feedback.id,
        action=feedback.action,
        by=feedback.by,
        handed=feedback.handed,
        ended_ms=end_ns // 1_000_000,
        duration_s=(end_ns - start_ns) * 1e-9,
        score=feedback.score,
        score_sigma=feedback.score_sigma,
        cue=feedback.cue or None,
        cue_certainty=feedback.cue_certainty if feedback.cue else None,
        praise=feedback.praise or None,
        measures=[
            AttemptMeasure(
                name=measure.name,
                value=measure.value,
                sigma=measure.sigma,
                unit=measure.unit,
                verdict=measure.verdict,
                low=measure.low,
                high=measure.high,
            )
            for measure in (measures[name] for name in feedback.shown)
        ],
    )
