"""The smooth motion of a recorded lesson, as tracks, and the attempts in it.

A stretch has one clock and no jump: a lesson has one, and one more after every gap and whenever its source begins anew.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from models.errors import UserError
from models.messages.feedback import Feedback
from models.messages.motion import Motion
from models.messages.pupil import NOBODY
from services.evaluation.attempt import FoundAttempt
from services.evaluation.track import Track, track_of
from services.lesson.lesson_reader import LessonPart
from services.lesson.replay import decode

_ROUNDING_S = 1e-6


@dataclass(frozen=True)
class LessonAttempt:
    """An attempt as evaluation found it.

    Attributes:
        number: counts the attempts of the lesson from 1.
        found: its keyframes are on CLOCK_MONOTONIC.
        first_s, last_s: the frames that were shown of it, with a little before and after, on the same clock.
        pupil: code of whose it was; empty if nobody was named.
    """

    number: int
    found: FoundAttempt
    first_s: float
    last_s: float
    pupil: str = NOBODY


@dataclass(frozen=True, eq=False)
class Stretch:
    """Motion without a jump.

    Attributes:
        track: on CLOCK_MONOTONIC.
        attempts: those that lie in it as a whole, in their order.
        segment: counts the gaps of the lesson that lie before it.
    """

    track: Track
    attempts: tuple[LessonAttempt, ...]
    segment: int

    def of_attempt(self, attempt: LessonAttempt) -> "Stretch":
        """The frames of one attempt, and it alone."""
        last = len(self.track) - 1
        first, end = (min(max(round(self.track.frame_at(t_s)), 0), last) for t_s in (attempt.first_s, attempt.last_s))
        return Stretch(self.track.part(first, end + 1), (attempt,), self.segment)


def stretches(
    parts: Iterable[LessonPart],
    frame_s: float,
    feedbacks: Sequence[Feedback],
    watch: Callable[[int], None] = lambda _t_ns: None,
    *,
    only: int | None = None,
    around_s: float = 0.0,
) -> list[Stretch]:
    """All stretches of a lesson in their order; empty if no motion was recorded.

    Args:
        parts: as the lesson's reader gives them.
        frame_s: from one smooth motion to the next, as fusion was configured.
        feedbacks: all attempts of the lesson, in their order.
        watch: is told the time of each motion, CLOCK_MONOTONIC.
        only: the number of an attempt, if the frames that were shown of it are enough; a long lesson is not held in memory then.
        around_s: with it also so much before its start and after its end.

    Raises:
        UserError: an entry cannot be read, or motions do not follow one another in that step.
    """
    first_ns, last_ns = (0, 2**63) if only is None else _asked_for_ns(feedbacks[only - 1], around_s)
    motions: dict[tuple[int, int], list[Motion]] = {}
    segment = 0
    for part in parts:
        segment += part.begins_segment
        for entry in part.entries:
            if entry.kind == "motion":
                motion = decode(entry, Motion)
                if first_ns <= motion.t_ns <= last_ns:
                    motions.setdefault((segment, motion.epoch), []).append(motion)
                watch(motion.t_ns)
    try:
        tracks = {key: track_of(those, frame_s) for key, those in motions.items()}
    except ValueError as error:
        raise UserError(f"the lesson's motion is not as fusion makes it: {error}; use the KineBox that recorded it") from error
    return [Stretch(track, _within(track, epoch, feedbacks), segment - 1) for (segment, epoch), track in tracks.items()]


def _asked_for_ns(feedback: Feedback, around_s: float) -> tuple[int, int]:
    """The frames that were shown of an attempt, and those around it, and half of one before and after."""
    half_ns, around_ns = feedback.frame_ns // 2, round(around_s * 1e9)
    last_ns = feedback.t_first_ns + (len(feedback.states) - 1) * feedback.frame_ns
    first_ns = min(feedback.t_first_ns, feedback.keyframes_ns[0] - around_ns)
    return first_ns - half_ns, max(last_ns, feedback.keyframes_ns[-1] + around_ns) + half_ns


def _attempt(number: int, feedback: Feedback) -> LessonAttempt:
    start, exertion, peak, end = (t_ns * 1e-9 for t_ns in feedback.keyframes_ns)
    found = FoundAttempt(feedback.action, feedback.handed, (start, exertion, peak, end))
    last_ns = feedback.t_first_ns + (len(feedback.states) - 1) * feedback.frame_ns
    return LessonAttempt(number, found, feedback.t_first_ns * 1e-9, last_ns * 1e-9, feedback.pupil)


def _within(track: Track, epoch: int, feedbacks: Sequence[Feedback]) -> tuple[LessonAttempt, ...]:
    attempts = (_attempt(number, feedback) for number, feedback in enumerate(feedbacks, start=1) if feedback.epoch == epoch)
    first_s, last_s = float(track.t_s[0]) - _ROUNDING_S, float(track.t_s[-1]) + _ROUNDING_S
    return tuple(each for each in attempts if first_s <= each.found.moments_s[0] and each.found.moments_s[-1] <= last_s)
