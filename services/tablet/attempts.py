"""The newest attempts: as the page shows them, and packed for its slow replay. Reads no clock."""

from typing import Final, NamedTuple

from models.messages.attempts import REMEMBERED
from models.messages.feedback import Feedback
from models.messages.pupil import PupilCorrection, PupilCorrections
from services.tablet import attempt_replay
from services.tablet.messages import Attempt, AttemptMeasure
from services.tablet.numbering import Numbering

KEPT: Final = REMEMBERED
"""Each takes 238 bytes a frame, some 40 KB as a rule."""
SINCE_THE_BOX: Final = 1
"""A list that begins with the box. Whoever has not heard of any beginning says 0."""


class _Kept(NamedTuple):
    shown: Attempt
    replay: bytes
    t_published_ns: int


class Attempts:
    """The last `KEPT` attempts since the list began, by their ids, in the order in which they ended.

    Attributes:
        since_ns: CLOCK_MONOTONIC at which the list began; what was published before is not of it.
        numbering: of the attempts.
    """

    def __init__(self) -> None:
        self._kept: dict[int, _Kept] = {}
        self._corrected: dict[int, PupilCorrection] = {}
        self.since_ns = SINCE_THE_BOX
        self.numbering = Numbering()

    def __len__(self) -> int:
        return len(self._kept)

    def __contains__(self, attempt_id: object) -> bool:
        return attempt_id in self._kept

    def take(self, feedback: Feedback) -> bool:
        """Keep an attempt; False if it is kept already, as when its message came twice, or is not of the list (any more)."""
        if feedback.id in self._kept or feedback.t_published_ns < self.since_ns:
            return False
        replay = attempt_replay.pack(attempt_replay.from_feedback(feedback))
        self._kept[feedback.id] = _Kept(shown_of(feedback), replay, feedback.t_published_ns)
        self._kept = dict(sorted(self._kept.items()))  # One that is told again comes late.
        while len(self._kept) > KEPT:
            oldest, number = self._numbers()[0]
            self.numbering.passed(oldest, number)
            self._forget(oldest)
        return feedback.id in self._kept

    def begin(self, since_ns: int) -> None:
        """The list begins anew, with what was published since then."""
        self.since_ns = since_ns
        for attempt_id in [attempt_id for attempt_id, kept in self._kept.items() if kept.t_published_ns < since_ns]:
            self._forget(attempt_id)
        self.numbering.begin()

    def correct(self, correction: PupilCorrection) -> bool:
        """Give an attempt to another pupil; False if it is not kept (any more)."""
        kept = self._kept.get(correction.attempt)
        if kept is None:
            return False
        shown = kept.shown.model_copy(update={"pupil": correction.pupil or None})
        self._kept[correction.attempt] = kept._replace(shown=shown)
        self._corrected[correction.attempt] = correction
        return True

    @property
    def corrections(self) -> PupilCorrections:
        """Of all that are kept."""
        return PupilCorrections(tuple(self._corrected.values()))

    @property
    def shown(self) -> list[Attempt]:
        """All that are kept, the oldest first."""
        return [self._kept[attempt_id].shown.model_copy(update={"number": number}) for attempt_id, number in self._numbers()]

    @property
    def last(self) -> tuple[int, int]:
        """The newest attempt with a number, and that number; both 0 if there is none."""
        return next(((attempt_id, number) for attempt_id, number in reversed(self._numbers()) if number is not None), (0, 0))

    def replay(self, attempt_id: int) -> bytes | None:
        """An attempt in the layout of `attempt_replay`; None if it is not kept (any more)."""
        kept = self._kept.get(attempt_id)
        return kept.replay if kept is not None else None

    def _numbers(self) -> list[tuple[int, int | None]]:
        ids = list(self._kept)
        return list(zip(ids, self.numbering.of(ids), strict=True))

    def _forget(self, attempt_id: int) -> None:
        self._kept.pop(attempt_id)
        self._corrected.pop(attempt_id, None)


def shown_of(feedback: Feedback) -> Attempt:
    """What the page says of an attempt, but for its number."""
    start_ns, end_ns = feedback.keyframes_ns[0], feedback.keyframes_ns[-1]
    measures = {measure.name: measure for measure in feedback.measures}
    return Attempt(
        id=feedback.id,
        number=None,
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
        silence=feedback.silence,
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
        pupil=feedback.pupil or None,
    )
