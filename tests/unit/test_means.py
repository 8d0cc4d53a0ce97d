"""The mean of a stretch: of what was seen, and the less sure the more was not."""

from dataclasses import replace

import numpy as np
import pytest

from models.arrays import Bool, Float
from models.messages.motion import JointState
from models.teaching.measure import Measure
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.measured import Measured
from services.evaluation.measures.reduce import evaluate
from services.evaluation.signals.reading import Reading
from services.evaluation.stature import Stature
from services.evaluation.track import Track, known_track
from tests.stick_figure import DOWN, LEFT, figure, turned

COUNT, FRAME_S = 70, 1 / 30
ATTEMPT = FoundAttempt("squat", "right", (5 * FRAME_S, 20 * FRAME_S, 40 * FRAME_S, 65 * FRAME_S))
WAVE = np.sin(2 * np.pi * np.arange(COUNT) / 30)
"""Two of them in the attempt."""
NOBODY = np.zeros(COUNT, np.bool_)


def swinging(bends_deg: Float) -> Track:
    return known_track(np.stack([figure({"right_shank": turned(bend, LEFT, DOWN)}) for bend in bends_deg]), FRAME_S, 0.005)


def mean(unseen: Bool, state: JointState = JointState.UNKNOWN, end: int = COUNT) -> Measured:
    """Of the bend of a knee that swings; while it is guessed, it is guessed to be 30 degrees off."""
    bends_deg = 60 + 40 * WAVE
    track = swinging(bends_deg + 30 * unseen)
    states, joints_m = track.states.copy(), track.joints_m.copy()
    states[unseen] = state
    if state == JointState.UNKNOWN:
        joints_m[unseen] = np.nan
    reading = Reading(replace(track, states=states, joints_m=joints_m).part(0, end), "right", told=Stature(1.5, 0.0))
    return evaluate(Measure(signal="knee_flexion", side="lead", over=("start", "end"), take="mean"), reading, ATTEMPT)


@pytest.mark.parametrize("above", [0.6, 0.8, 0.95])
@pytest.mark.parametrize("sign", [-1, 1])
def test_a_mean_says_how_far_off_it_may_be_where_its_crests_were_lost(above: float, sign: int) -> None:
    """Hands are lost where they are fastest, and no other frame stands for those."""
    whole, part = mean(NOBODY), mean(sign * WAVE > above)
    assert part.known
    assert whole.sigma < abs(part.value - whole.value) < 2 * part.sigma
    assert part.sigma < 10


def test_what_was_guessed_has_no_part_in_a_mean() -> None:
    crests = WAVE > 0.8
    unknown, guessed = mean(crests), mean(crests, JointState.GUESSED)
    assert guessed.known
    assert guessed.value == pytest.approx(unknown.value, abs=1e-6)
    assert guessed.sigma == pytest.approx(unknown.sigma, rel=0.05)


def test_a_mean_of_guesses_alone_is_a_value_that_judges_nobody() -> None:
    guessed = mean(~NOBODY, JointState.GUESSED)
    assert not guessed.known
    assert guessed.value == pytest.approx(mean(NOBODY).value + 30)


def test_what_is_beyond_the_recording_was_not_seen_either() -> None:
    whole, part = mean(NOBODY), mean(NOBODY, end=54)
    assert part.known
    assert part.sigma > whole.sigma + 2
    assert abs(part.value - whole.value) < 2 * part.sigma


def test_a_mean_of_all_frames_pays_nothing() -> None:
    assert mean(NOBODY).sigma < 4
