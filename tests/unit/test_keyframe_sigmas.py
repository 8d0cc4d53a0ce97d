"""How unsure a number is because the instant of its keyframe is."""

from dataclasses import replace

import numpy as np
import pytest

from models.messages.motion import JointState
from models.skeleton import coco
from models.teaching.measure import Measure
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.measured import Measured
from services.evaluation.measures.reduce import evaluate
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.reading import Reading
from services.evaluation.stature import Stature
from services.evaluation.track import known_track
from services.evaluation.uncertainty import NETWORK, Uncertainty
from tests.stick_figure import DOWN, LEFT, figure, turned
from tests.taught import performance

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


def test_a_keyframe_that_nobody_saw_makes_a_number_less_sure_than_one_that_was_seen() -> None:
    """In a roll legs are hidden: its peak is then but where others have theirs, and the nose falls or rises fast."""
    track, attempt = performance("forward_roll")
    peak_s = attempt.moment_s("peak")
    heights = Reading(track, "right").of(CATALOGUE["nose_height"], "lead").value
    change = np.abs(heights[6:] - heights[:-6])
    middles_s = track.t_s[3:-3]
    steepest_s = float(middles_s[np.argmax(np.where(np.abs(middles_s - peak_s) < 0.4, change, 0.0))])
    slope = Measure(signal="nose_height", at="peak", shift_s=steepest_s - peak_s)
    legs = [number for number, name in enumerate(coco.NAMES) if name.endswith(("hip", "knee", "ankle"))]
    hidden = (np.abs(track.t_s - peak_s) <= 0.1)[:, None] & np.isin(np.arange(coco.COUNT), legs)
    states, joints_m = track.states.copy(), track.joints_m.copy()
    states[hidden], joints_m[hidden] = JointState.UNKNOWN, np.nan
    whole, part = (
        evaluate(slope, Reading(one, "right", told=Stature(1.5, 0.0)), attempt)
        for one in (track, replace(track, states=states, joints_m=joints_m))
    )
    assert whole.known
    assert part.value == pytest.approx(whole.value)
    assert part.sigma > 3 * whole.sigma


def test_a_value_that_turns_about_at_its_keyframe_is_unsure_by_how_far_it_falls_off() -> None:
    """A little earlier it is as a little later: their difference says nothing."""
    frames = range(-10, 11)
    joints = np.stack([figure({"right_shank": turned(100 - 0.8 * frame**2, LEFT, DOWN)}) for frame in frames])
    track = known_track(joints, FRAME_S, 0.005)
    attempt = FoundAttempt("squat", "right", (0.1, 0.2, 10 * FRAME_S, 0.6))
    states = track.states.copy()
    states[:, [number for number, name in enumerate(coco.NAMES) if not name.startswith("right")]] = JointState.GUESSED
    whole, part = (
        evaluate(Measure(signal="knee_flexion", side="lead", at="peak"), Reading(one, "right", PLACED, Stature(1.5, 0.0)), attempt)
        for one in (track, replace(track, states=states))
    )
    assert part.known
    assert part.sigma**2 - whole.sigma**2 == pytest.approx((0.8 * 3**2) ** 2, rel=0.1)
