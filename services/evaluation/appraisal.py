"""One attempt, from its motion to all that is to be said of it."""

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from models.arrays import Float, UInt8
from models.messages.feedback import Colour, Feedback, MeasureResult, Verdict
from models.messages.motion import JointState
from models.messages.pupil import NOBODY
from models.skeleton import coco
from models.teaching.schema import Shown, Teaching
from models.teaching.standard import FRAME_S, Standard
from services.evaluation.agreement import beside_cue
from services.evaluation.alignment import align
from services.evaluation.attempt import PHASES, FoundAttempt
from services.evaluation.beside import standard_beside
from services.evaluation.config import EvaluationConfig
from services.evaluation.cues import choose
from services.evaluation.deviation import Deviation, deviate
from services.evaluation.faults import judge
from services.evaluation.measures import keyframe
from services.evaluation.measures.measured import Measured
from services.evaluation.measures.reduce import evaluate
from services.evaluation.normalise import lead_right
from services.evaluation.score import score
from services.evaluation.signals.reading import Reading
from services.evaluation.track import Track

LONGEST_MARGIN_S: Final = 1.0
"""What a standard has before its start and after its end is compared and shown, too, but no more than this."""
FAIR_SHARE: Final = 0.25
"""Outside what is good by up to this share of its width a measure is fair, beyond that poor."""
_MIRROR: Final = list(coco.MIRROR)


@dataclass(frozen=True)
class Moments:
    """How the track's clock and CLOCK_MONOTONIC go together.

    Attributes:
        now_s: the newest instant on the track's clock, seconds of the pupil's time.
        now_ns: the same on CLOCK_MONOTONIC.
        epoch: see `models.messages.observation.Observation.epoch`.
        speed: seconds of the pupil's time a second of CLOCK_MONOTONIC.
    """

    now_s: float
    now_ns: int
    epoch: int
    speed: float = 1.0

    def ended_ns(self, end_s: float) -> int:
        """CLOCK_MONOTONIC of an instant that has passed; 0 if that was before the clock began."""
        return max(self.now_ns - round((self.now_s - end_s) * 1e9 / self.speed), 0)


def appraise(
    track: Track,
    attempt: FoundAttempt,
    by: Literal["recognised", "chosen"],
    moments: Moments,
    config: EvaluationConfig,
    pupil: str = NOBODY,
) -> Feedback:
    """Judge an attempt.

    Args:
        track: that contains it, some frames before and after it at best.
        attempt: on the track's clock.
        by: how it is known what was tried.
        moments: of the track's clock.
        config: what is taught.
        pupil: code of whose attempt it is.

    Returns:
        With `t_published_ns` the newest instant. Its frames are those of the attempt, with as much around it as the standard has.
        Between keyframes is the pupil's time, also when a lesson is played slower or faster; the last one is when it was shown.

    Raises:
        ValueError: the track has fewer than two frames of the attempt.
    """
    teaching, standard = config.teachings[attempt.action], config.standards[attempt.action]
    # By keyframes that nobody saw nothing is measured.
    reading = Reading(track if attempt.timed else track.hidden(), attempt.handed)
    judgements, measured = judge(teaching, reading, attempt), measures_of(teaching, reading, attempt)
    said = choose(teaching, judgements, measured)
    measures = beside_cue(teaching, said.cue, measured)

    shown = _shown(track, attempt, standard)
    if len(shown) < 2:
        raise ValueError(f"of an attempt at {attempt.moments_s} the track of {len(track)} frames has {len(shown)}")
    led = lead_right(shown, attempt.handed)
    aligned = align(led, standard) if attempt.timed else None
    deviation = None if aligned is None else deviate(aligned, led, standard, teaching.tolerance)
    beside = np.full_like(shown.joints_m, np.nan) if aligned is None else standard_beside(aligned, led, attempt.handed)
    points = score(teaching, judgements, deviation, measures)

    first_ns, keyframes_ns, frame_ns = _times(shown, attempt, moments)
    known = shown.states != JointState.UNKNOWN
    return Feedback(
        id=keyframes_ns[-1] // 1_000_000,
        epoch=moments.epoch,
        action=attempt.action,
        by=by,
        handed=attempt.handed,
        keyframes_ns=keyframes_ns,
        t_published_ns=moments.now_ns,
        score=None if points is None else points.points,
        score_sigma=None if points is None else points.sigma,
        praise=said.praise,
        cue=said.cue,
        cue_certainty=said.certainty,
        judgements=judgements,
        measures=measures,
        shown=tuple(measure.name for measure in measures),
        t_first_ns=first_ns,
        frame_ns=frame_ns,
        joints_m=np.where(known[..., None], shown.joints_m, 0.0).astype(np.float32),
        states=shown.states,
        colours=_colours(deviation, shown, attempt),
        standard_m=beside.astype(np.float32),
        pupil=pupil,
        fine=said.fine,
        keyframes_unseen=tuple(phase for phase in PHASES if not keyframe.is_seen(reading, attempt, phase)),
    )


def verdict_of(measured: Measured, low: float, high: float) -> Verdict:
    """What a teacher would say, in doubt for the pupil; unknown where the error is as wide as half of what is good."""
    width = high - low
    if not measured.known or measured.sigma > width / 2:
        return "unknown"
    outside = max(low - measured.value, measured.value - high, 0.0)
    beyond = outside - measured.sigma
    if beyond <= 0:
        return "good" if outside == 0 else "fair"
    return "fair" if beyond <= FAIR_SHARE * width else "poor"


def measures_of(teaching: Teaching, reading: Reading, attempt: FoundAttempt) -> tuple[MeasureResult, ...]:
    """Those that the page shows, in the file's order, each by itself."""
    return tuple(_result(shown, evaluate(shown, reading, attempt)) for shown in teaching.shown)


def _result(shown: Shown, measured: Measured) -> MeasureResult:
    low, high = shown.good
    value, sigma = (measured.value, measured.sigma) if measured.known else (None, None)
    return MeasureResult(shown.name, value, sigma, shown.unit, verdict_of(measured, low, high), low, high)


def _shown(track: Track, attempt: FoundAttempt, standard: Standard) -> Track:
    """The attempt with as much before and after it as the standard has."""
    before_s = min(standard.moments_s[0], LONGEST_MARGIN_S)
    after_s = min((len(standard.joints_m) - 1) * FRAME_S - standard.moments_s[-1], LONGEST_MARGIN_S)
    first = int(np.floor(track.frame_at(attempt.moments_s[0] - before_s) + 1e-6))
    last = int(np.ceil(track.frame_at(attempt.moments_s[-1] + after_s) - 1e-6))
    return track.part(max(first, 0), min(last, len(track) - 1) + 1)


def _colours(deviation: Deviation | None, shown: Track, attempt: FoundAttempt) -> UInt8:
    """(T, 17) of the pupil's own joints; grey where nothing can be compared."""
    if deviation is None:
        return np.full(shown.states.shape, Colour.GREY, np.uint8)
    return deviation.colours[:, _MIRROR] if attempt.handed == "left" else deviation.colours


def _times(shown: Track, attempt: FoundAttempt, moments: Moments) -> tuple[int, tuple[int, int, int, int], int]:
    """First frame, keyframes and the time of a frame in nanoseconds; keyframes within the frames, each after the one before."""
    last = (len(shown) - 1) * round(shown.frame_s * 1e9)
    frame_ns = round(shown.frame_s * 1e9)
    end_ns = moments.ended_ns(attempt.moments_s[-1])
    places: Float = np.array([shown.frame_at(moment_s) for moment_s in attempt.moments_s])
    order = np.arange(len(places))
    offsets = np.clip(np.rint(places * frame_ns), order, last - order[::-1]).astype(np.int64).tolist()
    first_ns = max(end_ns - offsets[-1], 0)
    start, exertion, peak, end = (first_ns + offset for offset in offsets)
    return first_ns, (start, exertion, peak, end), frame_ns
