"""How unsure a number is because the instant of its keyframe is."""

from dataclasses import replace

import numpy as np
import pytest

from models.skeleton import coco
from models.teaching.measure import Measure
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.measured import Measured
from services.evaluation.measures.reduce import evaluate
from services.evaluation.signals.reading import Reading
from services.evaluation.stature import Stature
from services.evaluation.track import known_track
from services.evaluation.uncertainty import NETWORK, Uncertainty
from tests.stick_figure import DOWN, LEFT, figure, turned

COUNT, FRAME_S = 40, 1 / 30
PEAK = 20
PLACED = replace(NETWORK, timing_s=0.0)
"""Joints that move are as surely at their places as others: only their keyframe makes them less sure."""


def bend_at_peak(*unseen: int, count: int = COUNT, model: Uncertainty = PLACED) -> Measured:
    """Of a knee that bends evenly, without some frames."""
    joints = np.stack([figure({"right_shank": turned(20 + 3 * frame, LEFT, DOWN)}) for frame in range(count)])
    joints[list(unseen)] = np.nan
    reading = Reading(known_track(joints, FRAME_S, 0.005), "right", model, Stature(1.5, 0.0))
    attempt = FoundAttempt("squat", "right", (0.1, 0.3, PEAK * FRAME_S, 1.2))
    return evaluate(Measure(signal="knee_flexion", side="lead", at="peak"), reading, attempt)


@pytest.mark.parametrize(("unseen", "count"), [((PEAK - 1,), COUNT), ((PEAK + 1,), COUNT), ((), PEAK + 1)])
def test_a_keyframe_beside_what_was_not_seen_is_no_surer_than_others(unseen: tuple[int, ...], count: int) -> None:
    whole, part = bend_at_peak(), bend_at_peak(*unseen, count=count)
    assert whole.known
    assert part.known
    assert part.value == pytest.approx(whole.value)
    assert part.sigma >= whole.sigma * (1 - 1e-6)


@pytest.mark.parametrize("unseen", [PEAK - 1, PEAK + 1])
def test_what_moves_is_no_surer_beside_what_was_not_seen(unseen: int) -> None:
    """Nor at the place that shutters and the smoother put it."""
    late = replace(NETWORK, landmark_m=(0.0,) * coco.COUNT, noise_scale=(0.0,) * coco.COUNT, moment_s=0.0)
    assert bend_at_peak(unseen, model=late).sigma == pytest.approx(bend_at_peak(model=late).sigma, rel=0.01)


def test_what_is_known_in_no_frame_beside_the_keyframe_is_unknown() -> None:
    alone = bend_at_peak(PEAK - 1, PEAK + 1)
    assert not alone.known
    assert alone.why
