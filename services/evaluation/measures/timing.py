"""How long phases take."""

import math
from collections.abc import Callable
from typing import Final

import numpy as np

from models.skeleton import coco
from models.teaching.measure import Phase
from services.evaluation.attempt import FoundAttempt
from services.evaluation.features import JOINTS
from services.evaluation.measures.measured import HIDDEN, Estimate, Function
from services.evaluation.signals.reading import Reading

_FAMILY: Final = "Tempo"
_AROUND_S: Final = 0.1
"""A keyframe is known by what is seen so long before and after it."""
_LEAST_SEEN: Final = 0.5
"""Share of the joints, over those frames; without hips nothing can be compared."""
_HIPS: Final = (coco.INDEX["left_hip"], coco.INDEX["right_hip"])


def _lasts(first: Phase, last: Phase) -> Callable[[Reading, FoundAttempt], Estimate]:
    def call(reading: Reading, attempt: FoundAttempt) -> Estimate:
        lasts_s = attempt.moment_s(last) - attempt.moment_s(first)
        return _estimate(lasts_s, math.sqrt(2) * reading.model.moment_s, _seen(reading, attempt, first, last))

    return call


def _preparation_share(reading: Reading, attempt: FoundAttempt) -> Estimate:
    start_s, exertion_s, peak_s, _ = attempt.moments_s
    whole_s = peak_s - start_s
    share = (exertion_s - start_s) / whole_s
    moment_s = reading.model.moment_s
    sigma = 100 * moment_s / whole_s * math.sqrt(1 + share**2 + (1 - share) ** 2)
    return _estimate(100 * share, sigma, _seen(reading, attempt, "start", "exertion", "peak"))


def _estimate(value: float, sigma: float, seen: bool) -> Estimate:
    return Estimate(value, sigma, seen, "" if seen else HIDDEN)


def _seen(reading: Reading, attempt: FoundAttempt, *phases: Phase) -> bool:
    """Whether the pupil was, around each of these keyframes: where he was not, they are but where others have theirs."""
    track = reading.track
    hips = np.isfinite(track.joints_m[:, _HIPS]).all(axis=(1, 2))
    shares = np.where(hips, track.seen[:, JOINTS].mean(axis=1), 0.0)
    around = [shares[np.abs(track.t_s - attempt.moment_s(phase)) <= _AROUND_S] for phase in phases]
    return all(len(share) > 0 and float(share.mean()) >= _LEAST_SEEN for share in around)


FUNCTIONS = (
    Function("preparation_time", "s", _FAMILY, "From the start to the exertion.", "", _lasts("start", "exertion")),
    Function("effort_time", "s", _FAMILY, "From the exertion to the peak.", "", _lasts("exertion", "peak")),
    Function("recovery_time", "s", _FAMILY, "From the peak to the end.", "", _lasts("peak", "end")),
    Function("attempt_time", "s", _FAMILY, "From the start to the end.", "", _lasts("start", "end")),
    Function(
        "preparation_share",
        "pct",
        _FAMILY,
        "Share of the preparation in the time from the start to the peak, percent.",
        "",
        _preparation_share,
    ),
)
