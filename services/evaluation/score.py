"""One number for an attempt, 0 to 100: what was done well of what the action asks for, and how near to the standard it was."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.polynomial.hermite_e import hermegauss

from models.arrays import Bool, Float
from models.messages.feedback import Colour, Judgement, MeasureResult, Verdict
from models.teaching.schema import Teaching
from services.evaluation.deviation import RED, Deviation

LEAST_KNOWN: Final = 0.6
"""Share of the faults, by importance, that must be judged for a score."""
LEAST_COLOURED: Final = 0.3
"""Share of the joints, over all frames, that must be judged for their part in the score."""
_FAULTS_SHARE: Final = 0.7
_FREE: Final = 0.15
"""So severe is everybody's performance somewhere; it costs nothing."""
_FULL: Final = 1.25
"""From this severity on a fault costs no more."""
_UNKNOWN_SIGMA: Final = 0.3
"""What a fault that nobody could judge may have cost more or less than the others, of what it counts."""
_UNCOLOURED_SIGMA: Final = 0.25
"""The same of joints that were not judged: they may have been anywhere near those that were."""
_MOST: Final[dict[Verdict, float]] = {"good": 1.0, "fair": 0.95, "poor": 0.85, "unknown": 1.0}
"""Beside a number that is said to be so there is no more of the points: a hundred is for what nobody would have otherwise."""
_JOINTS_ALIKE: Final = 0.2
"""Correlation that is taken for the errors of two joints' parts: neighbours are wrong alike, and all are compared by the same hips
and heading. With errors as fusion has them scores are as far off as that says, or less."""

_NODES, _SHARES = hermegauss(15)
_SHARES /= _SHARES.sum()
"""Places, in standard deviations, and shares with which a normal distribution is summed up."""


@dataclass(frozen=True)
class Score:
    """Points, 0 to 100, and their standard deviation."""

    points: float
    sigma: float


def score(
    teaching: Teaching, judgements: Sequence[Judgement], deviation: Deviation | None, measures: Sequence[MeasureResult]
) -> Score | None:
    """The score of an attempt.

    A fault costs by its importance and severity; the root of the sum of squares is taken over the faults, so that one grave fault
    costs more than several slight ones; where the opposite is a mistake, too, it costs the same, as far as severities count it.
    Joints that were seen count 1 within the limit, 0 from red on, evenly between. What a number on the page calls fair or poor
    leaves no full score.

    Args:
        teaching: of the action.
        judgements: of its faults, in the same order.
        deviation: from the standard; None if it is not known.
        measures: that stand beside it.

    Returns:
        None if too little is known.
    """
    weights = np.array([fault.importance for fault in teaching.fault])
    weights /= weights.sum()
    known = np.array([one.severity is not None for one in judgements])
    if weights[known].sum() < LEAST_KNOWN:
        return None
    severities = np.array([one.severity or 0.0 for one in judgements])
    sigmas = np.array([one.sigma or 0.0 for one in judgements])
    either_way = np.array([fault.either_way for fault in teaching.fault])
    # What nobody judged counts as the rest does: not as if it had been good.
    counted = np.where(known, weights, 0.0) / weights[known].sum()
    good = 1 - float(np.linalg.norm(np.sqrt(counted) * _lost(severities, either_way)))
    deviations = _deviations(_lost(severities[:, None] + sigmas[:, None] * _NODES, either_way[:, None]))
    variance = float(counted @ deviations**2) + float(weights[~known].sum()) * _UNKNOWN_SIGMA**2
    near = None if deviation is None else _near(deviation)
    if near is None:
        # The joints have no part in it, and nobody knows which they would have had.
        variance += ((1 - _FAULTS_SHARE) * _UNCOLOURED_SIGMA) ** 2
    else:
        good = _FAULTS_SHARE * good + (1 - _FAULTS_SHARE) * near[0]
        variance = _FAULTS_SHARE**2 * variance + (1 - _FAULTS_SHARE) ** 2 * near[1]
    most = min((_MOST[one.verdict] for one in measures), default=1.0)
    return Score(100 * min(max(good, 0.0), most), 100 * math.sqrt(variance))


def _deviations(may_be: Float) -> Float:
    """(...) standard deviations of (..., 15) values at `_NODES`: costs end at either side, so no slope tells."""
    return np.asarray(np.sqrt(np.maximum((may_be**2) @ _SHARES - (may_be @ _SHARES) ** 2, 0.0)))


def _lost(severity: Float, either_way: Bool) -> Float:
    """What faults of these severities cost, 0 to 1."""
    return np.clip((np.where(either_way, np.abs(severity), severity) - _FREE) / (_FULL - _FREE), 0.0, 1.0)


def _near(deviation: Deviation) -> tuple[float, float] | None:
    """How near the joints were to the standard, 0 to 1, and the variance of that."""
    judged = deviation.colours != Colour.GREY
    share = float(judged.mean()) if judged.size else 0.0
    if share < LEAST_COLOURED:
        return None
    distance, sigma = deviation.distance[judged], deviation.sigma[judged]
    deviations = np.zeros(judged.shape)
    deviations[judged] = _deviations(_nearness(distance[:, None] + sigma[:, None] * _NODES))
    # A joint is put beside its place for long: its frames are wrong alike.
    of_joints = deviations.sum(axis=0) / np.count_nonzero(judged)
    variance = (1 - _JOINTS_ALIKE) * float((of_joints**2).sum()) + _JOINTS_ALIKE * float(of_joints.sum()) ** 2
    return float(_nearness(distance).mean()), variance + ((1 - share) * _UNCOLOURED_SIGMA) ** 2


def _nearness(distance: Float) -> Float:
    """Of joints so many limits away: 1 is within the limit, 0 from red on."""
    return np.asarray(np.clip((RED - distance) / (RED - 1), 0.0, 1.0))
