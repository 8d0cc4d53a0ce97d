"""Where the hand is as it strikes: at its highest, which needs no keyframe that is right to a hundredth of a second."""

import math
from typing import Final

from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.measured import HIDDEN, Estimate, Function, unknown
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.reading import Reading
from services.evaluation.signals.stretch import sample, stretch, top, top_sigma_s

_AROUND_S: Final = 0.15
"""The hand is highest within so long before or after the peak."""


def _hand_ahead(reading: Reading, attempt: FoundAttempt) -> Estimate:
    height, ahead = (reading.of(CATALOGUE[name], "lead") for name in ("wrist_height", "wrist_forward"))
    peak_s = attempt.moment_s("peak")
    highest = top(height, stretch(height, peak_s - _AROUND_S, peak_s + _AROUND_S))
    if highest is None:
        return unknown(HIDDEN)
    instant_s, early_s = float(height.t_s[0]) + highest.place * height.frame_s, top_sigma_s(height, highest)
    there, before, after = (sample(ahead, instant_s + shift_s) for shift_s in (0.0, -early_s, early_s))
    moved = (after.value - before.value) / 2
    sigma = math.sqrt(ahead.variance(there.weights) + moved**2)
    return Estimate(there.value, sigma, bool(ahead.seen[there.weights != 0].all() and highest.timed))


FUNCTIONS = (
    Function(
        "hand_ahead",
        "pct",
        "Reach",
        "How far the hand that leads is in front of its shoulder when it is highest, around the peak; percent of stature.",
        "",
        _hand_ahead,
    ),
)
