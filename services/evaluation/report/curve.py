"""Angle curves of an attempt: which two are worth paper, the pupil's, the standard's, and how far apart they may be."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from msgspec import UNSET

from models.arrays import Bool, Float
from models.messages.feedback import Feedback
from models.messages.motion import JointState
from models.teaching.measure import Measure, Side
from models.teaching.schema import Evidence, Teaching
from services.evaluation.measures.reduce import LEVELS
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.reading import Reading
from services.evaluation.signals.series import Series
from services.evaluation.signals.stretch import sample
from services.evaluation.stature import stature_of
from services.evaluation.track import Track, known_track
from services.evaluation.uncertainty import EXACT

CURVES: Final = 2
NOISE_M: Final = 0.01
"""Of a joint that fusion saw, along each axis: a feedback has no covariances, and this is their usual size."""
USUAL_TOLERANCE_DEG: Final = 15.0
"""Of an angle that no file says anything about."""
LEAST_TOLERANCE_DEG: Final = 10.0
"""No band is narrower: no joint is seen that well, and nobody performs the same twice."""
LEAST_SEEN: Final = 0.5
"""Share of the attempt's frames in which the pupil's angle must have been seen to be drawn."""
_NEVER_BELOW_0: Final = {"knee_flexion", "elbow_flexion", "shoulder_elevation", "forearm_inclination", "trunk_inclination"}
_FALLBACK: Final[tuple[tuple[str, Side], ...]] = (("knee_flexion", "lead"), ("elbow_flexion", "lead"))


@dataclass(frozen=True, eq=False)
class Curve:
    """One angle over the frames of a feedback.

    Attributes:
        signal, side: which angle.
        t_s: (T,) seconds from the attempt's start.
        pupil_deg: (T,) NaN where it was not seen, or is less sure than the tolerance; of an angle that goes round, within half a
            turn of the standard.
        sigma_deg: one standard deviation of it, as it is in the middle of the frames.
        standard_deg: (T,) along the alignment; NaN where unknown.
        tolerance_deg: how far from the standard is as good: half of the way from good to fault, where a teacher begins to correct;
            or half of the range that is good.
    """

    signal: str
    side: Side
    t_s: Float
    pupil_deg: Float
    sigma_deg: float
    standard_deg: Float
    tolerance_deg: float

    @property
    def band_deg(self) -> tuple[Float, Float]:
        """(T,) lower and upper edge; no lower than nought, of an angle that is never below."""
        low, high = self.standard_deg - self.tolerance_deg, self.standard_deg + self.tolerance_deg
        return (np.maximum(low, 0.0) if self.signal in _NEVER_BELOW_0 else low), high

    @property
    def sided(self) -> bool:
        """Whether left and right have one each."""
        return CATALOGUE[self.signal].sided


def curves_of(feedback: Feedback, teaching: Teaching | None) -> list[Curve]:
    """At most two: what the cue is about, then what the tablet shows, then what else is looked for, then knee and elbow.

    Args:
        feedback: of the attempt.
        teaching: of its action; None if it is not taught any more.
    """
    whole = _track(feedback)
    pupil = Reading(whole, feedback.handed, told=stature_of(whole))
    standard = Reading(known_track(feedback.standard_m.astype(np.float64), whole.frame_s), feedback.handed, EXACT, pupil.stature)
    within = slice(feedback.frame_of(feedback.keyframes_ns[0]), feedback.frame_of(feedback.keyframes_ns[-1]) + 1)
    start_s, end_s = ((t_ns - feedback.t_first_ns) * 1e-9 for t_ns in (feedback.keyframes_ns[0], feedback.keyframes_ns[-1]))
    found: list[Curve] = []
    for signal, side in dict.fromkeys(_worth(feedback, teaching)):
        series, model = (reading.of(CATALOGUE[signal], side).about(start_s, end_s) for reading in (pupil, standard))
        (value, sigmas, known), (beside, _, _) = (_against_start(one, start_s) for one in (series, model))
        tolerance = _tolerance(signal, side, feedback, teaching)
        # Less sure than the band is wide, it would look like a fault or like none by chance alone.
        with np.errstate(invalid="ignore"):
            seen = known & (sigmas <= tolerance)
        if seen[within].mean() < LEAST_SEEN:
            continue
        drawn = np.where(seen, value, np.nan)
        if series.turns:
            drawn = _beside(drawn, beside)
        else:
            beside = _same_turn(beside, drawn)
        sigma = float(np.median(sigmas[within][seen[within]]))
        found.append(Curve(signal, side, whole.t_s - start_s, drawn, sigma, beside, tolerance))
        if len(found) == CURVES:
            break
    return found


def _against_start(series: Series, start_s: float) -> tuple[Float, Float, Bool]:
    """(T,) values, their sigmas, and whether they were seen; of an angle against the start as `evaluate` takes it, so that curve
    and number are one."""
    if not series.from_start:
        return series.value, series.sigma, series.seen
    start = sample(series, start_s)
    sigmas = [math.sqrt(series.variance(here - start.weights)) for here in np.eye(len(series))]
    seen = series.seen & bool(series.seen[start.weights != 0].all())
    return series.value - start.value, np.array(sigmas), seen


def _track(feedback: Feedback) -> Track:
    known = (feedback.states != JointState.UNKNOWN)[..., None]
    track = known_track(np.where(known, feedback.joints_m.astype(np.float64), np.nan), feedback.frame_ns * 1e-9, NOISE_M)
    return Track(track.t_s, track.joints_m, track.covariance_m2, feedback.states)


def _worth(feedback: Feedback, teaching: Teaching | None) -> Iterator[tuple[str, Side]]:
    if teaching is not None:
        faults = sorted(teaching.fault, key=lambda fault: -fault.importance)
        corrected, others = (
            [one for fault in faults if (fault.name == feedback.cue) == is_cue for one in _by_weight(fault.evidence)]
            for is_cue in (True, False)
        )
        for measure in (*corrected, *teaching.shown, *others):
            if measure.signal is not UNSET and CATALOGUE[measure.signal].unit == "deg":
                yield measure.signal, _side(measure)
    yield from _FALLBACK


def _by_weight(evidence: Sequence[Evidence]) -> list[Evidence]:
    return sorted(evidence, key=lambda one: -one.weight)


def _side(measure: Measure) -> Side:
    """Of what has no sides, one name will do."""
    return measure.side if measure.signal is not UNSET and CATALOGUE[measure.signal].sided else "lead"


def _tolerance(signal: str, side: Side, feedback: Feedback, teaching: Teaching | None) -> float:
    """By what the cue is about, or what the tablet shows, or what else is looked for; the usual one where no file says anything."""
    if teaching is None:
        return USUAL_TOLERANCE_DEG
    corrected: list[float] = []
    others: list[float] = []
    for fault in teaching.fault:
        for one in fault.evidence:
            if one.signal == signal and _side(one) == side and one.take in LEVELS:
                (corrected if fault.name == feedback.cue else others).append(abs(one.good - one.fault) / 2)
    shown = [(one.good[1] - one.good[0]) / 2 for one in teaching.shown if one.signal == signal and _side(one) == side]
    return max(min(corrected or shown or others or [USUAL_TOLERANCE_DEG]), LEAST_TOLERANCE_DEG)


def _beside(pupil_deg: Float, standard_deg: Float) -> Float:
    """In each frame the turn that is nearest to the standard: what turns fast, as an arm after a hit, is easily followed to a whole
    turn too many, and all that comes after it would look like a fault."""
    known = np.flatnonzero(np.isfinite(standard_deg))
    if not len(known):
        return pupil_deg
    near_deg = np.interp(np.arange(len(pupil_deg)), known, standard_deg[known])
    return np.asarray(pupil_deg - 360 * np.rint((pupil_deg - near_deg) / 360))


def _same_turn(standard_deg: Float, pupil_deg: Float) -> Float:
    """Whole turns taken out that lie between the two."""
    apart = standard_deg - pupil_deg
    known = apart[np.isfinite(apart)]
    return np.asarray(standard_deg - 360 * np.rint(np.median(known) / 360)) if len(known) else standard_deg
