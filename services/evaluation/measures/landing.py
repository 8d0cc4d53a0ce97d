"""Where the feet are put down in a run, against the body."""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Final

import numpy as np

from models.arrays import Float
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.measured import Estimate, Function, unknown
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.posture import SideAsked
from services.evaluation.signals.reading import Reading

_STANDS: Final = 0.5
"""A foot stands while its ankle, which goes on rolling over it, is slower than this share of the hips' speed."""
_SLOWEST_M_S: Final = 0.5
"""Whose hips are slower does not run."""
_FEWEST: Final = 3
"""Frames in which a foot stands; what is shorter is none."""
_BEFORE_S, _AFTER_S = 0.6, 0.4
"""Steps count from so long before the exertion to so long after the peak: those at full speed."""
_FEWEST_STEPS: Final = 2
_SIDES: Final[tuple[SideAsked, SideAsked]] = ("lead", "other")


def _landing_reach(reading: Reading, attempt: FoundAttempt) -> Estimate:
    return _mean(reading, attempt, 0)


def _standing_reach(reading: Reading, attempt: FoundAttempt) -> Estimate:
    return _mean(reading, attempt, 1)


def _mean(reading: Reading, attempt: FoundAttempt, which: int) -> Estimate:
    """Mean of one column of all steps at full speed."""
    steps = [step for side in _SIDES for step in _steps(reading, attempt, side)]
    if len(steps) < _FEWEST_STEPS:
        return unknown("no steps at full speed were seen")
    values = np.array([step[which] for step in steps])
    scatter = float(values.std(ddof=1))
    series = [reading.of(CATALOGUE["ankle_forward"], side) for side in _SIDES]
    # Steps that agree better than noise lets them do so by chance.
    noise = math.sqrt(float(np.mean([np.nanmedian((one.noise**2).sum(axis=1)) for one in series])))
    # All steps share where network and model put hips and ankles.
    shared = np.mean([np.nanmedian((one.lasting**2).sum(axis=1) + one.stature**2) for one in series])
    return Estimate(float(values.mean()), math.sqrt(max(scatter, noise) ** 2 / len(values) + float(shared)))


def _steps(reading: Reading, attempt: FoundAttempt, side: SideAsked) -> Iterator[tuple[float, float]]:
    """Where the ankle is in front of the hips, percent of stature: as the foot lands, and in the middle of its standing."""
    ahead, hips, ankle = (reading.of(CATALOGUE[name], side) for name in ("ankle_forward", "hip_speed", "ankle_speed"))
    from_s, to_s = attempt.moment_s("exertion") - _BEFORE_S, attempt.moment_s("peak") + _AFTER_S
    with np.errstate(invalid="ignore"):
        pace = ankle.value / np.maximum(hips.value, _SLOWEST_M_S)
        stands = (pace < _STANDS) & (hips.value > _SLOWEST_M_S)
    edges = np.flatnonzero(np.diff(stands.astype(np.int8)))
    for before, last in pairwise(map(int, edges)):
        frames = np.arange(before + 1, last + 1)
        if not stands[before + 1] or len(frames) < _FEWEST or not from_s <= ahead.t_s[frames].mean() <= to_s:
            continue
        around = np.arange(before, last + 2)
        ends = [before, before + 1, last, last + 1]
        seen = ahead.seen[around].all() and ankle.seen[ends].all() and hips.seen[ends].all()
        if not (seen and np.isfinite(pace[around]).all()):
            continue
        lands, leaves = _crossing(pace, before), _crossing(pace, last)
        slope, level = np.polyfit(frames, ahead.value[frames], 1)
        yield float(level + slope * lands), float(np.interp((lands + leaves) / 2, around, ahead.value[around]))


def _crossing(pace: Float, before: int) -> float:
    """Between frame `before` and the next, in frames, where a foot begins to stand or ends."""
    return before + float((pace[before] - _STANDS) / (pace[before] - pace[before + 1]))


_FAMILY: Final = "Steps"
FUNCTIONS = (
    Function(
        "landing_reach",
        "pct",
        _FAMILY,
        "How far the ankle is in front of the middle of the hips as a foot lands, percent of stature: mean of the steps at full "
        "speed. A foot stands while its ankle is slower than half the hips.",
        "",
        _landing_reach,
    ),
    Function(
        "standing_reach",
        "pct",
        _FAMILY,
        "How far the ankle is in front of the middle of the hips half way through a foot's standing, percent of stature: mean of "
        "the steps at full speed. Negative is behind them; the further the foot is put in front, the less.",
        "",
        _standing_reach,
    ),
)
