"""One number for an attempt, 0 to 100: what was done well of what the action asks for, and how near to the standard it was."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.polynomial.hermite_e import hermegauss

from models.arrays import Float
from models.messages.feedback import Colour, Judgement
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


_NODES, _SHARES = hermegauss(15)
_SHARES /= _SHARES.sum()
"""Places, in standard deviations, and shares with which a normal distribution is summed up."""


@dataclass(frozen=True)
class Score:
    """Points, 0 to 100, and their standard deviation."""

    points: float
    sigma: float


def score(teaching: Teaching, judgements: Sequence[Judgement], deviation: Deviation | None) -> Score | None:
    """The score of an attempt.

    A fault costs by its importance and severity; the root of the sum of squares is taken over the faults, so that one grave fault
    costs more than several slight ones. Joints that were seen count 1 within the limit, 0 from red on, evenly between.

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
    # What nobody judged counts as the rest does: not as if it had been good.
    counted = np.where(known, weights, 0.0) / weights[known].sum()
    good = 1 - float(np.linalg.norm(np.sqrt(counted) * _lost(severities)))
    # What a fault costs ends at either side, so its deviation is not a slope's: it is that of the costs of what it may have been.
    may_be = _lost(severities[:, None] + sigmas[:, None] * _NODES)
    deviations = np.sqrt(np.maximum((may_be**2) @ _SHARES - (may_be @ _SHARES) ** 2, 0.0))
    variance = float(counted @ deviations**2) + float(weights[~known].sum()) * _UNKNOWN_SIGMA**2
    near = None if deviation is None else _near(deviation)
    if near is not None:
        good, variance = _FAULTS_SHARE * good + (1 - _FAULTS_SHARE) * near[0], _FAULTS_SHARE**2 * variance + near[1]
    return Score(100 * min(max(good, 0.0), 1.0), 100 * math.sqrt(variance))


def _lost(severity: Float) -> Float:
    """What faults of these severities cost, 0 to 1."""
    return np.clip((severity - _FREE) / (_FULL - _FREE), 0.0, 1.0)


def _near(deviation: Deviation) -> tuple[float, float] | None:
    """How near the joints were to the standard, 0 to 1, and the variance of that part of the score."""
    judged = deviation.colours != Colour.GREY
    share = float(judged.mean()) if judged.size else 0.0
    if share < LEAST_COLOURED:
        return None
    near = np.clip((RED - deviation.distance[judged]) / (RED - 1), 0.0, 1.0)
    # Joints that were not judged may have been anywhere near those that were.
    unknown = (1 - share) * 0.25
    return float(near.mean()), ((1 - _FAULTS_SHARE) * unknown) ** 2
