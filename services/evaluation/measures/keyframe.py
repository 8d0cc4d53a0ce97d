"""How well it is known when a keyframe was."""

from typing import Final

import numpy as np

from models.skeleton import coco
from models.teaching.measure import Phase
from services.evaluation.attempt import FoundAttempt
from services.evaluation.features import JOINTS
from services.evaluation.signals.reading import Reading

_AROUND_S: Final = 0.1
"""A keyframe is known by what is seen so long before and after it."""
_LEAST_SEEN: Final = 0.5
"""Share of the joints, over those frames; without hips nothing can be compared."""
_HIPS: Final = (coco.INDEX["left_hip"], coco.INDEX["right_hip"])
_CARRIED_S: Final = 0.1
"""Standard deviation of a keyframe that is but where performances of the standard have theirs: the warp carries it over to a few
frames (`services.evaluation.keyframes`), three of the box's 30 a second; what would put it right was not seen."""


def is_seen(reading: Reading, attempt: FoundAttempt, phase: Phase) -> bool:
    """Whether the pupil was, around this keyframe: where he was not, it is but where others have theirs."""
    track = reading.track
    around = np.abs(track.t_s - attempt.moment_s(phase)) <= _AROUND_S
    if not around.any():
        return False
    hips = np.isfinite(track.joints_m[around][:, _HIPS]).all(axis=(1, 2))
    shares = np.where(hips, track.seen[around][:, JOINTS].mean(axis=1), 0.0)
    return float(shares.mean()) >= _LEAST_SEEN


def sigma_s(reading: Reading, attempt: FoundAttempt, phase: Phase) -> float:
    """Standard deviation of its instant; 0 where keyframes are told and not found."""
    found_s = reading.model.moment_s
    return found_s if not found_s or is_seen(reading, attempt, phase) else _CARRIED_S
