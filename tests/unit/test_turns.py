"""Angles that go round: turns that an arm made, or that noise made of it, before what is measured are none of it."""

from dataclasses import replace

import numpy as np
import pytest

from models.arrays import Float
from models.messages.motion import JointState
from models.skeleton import coco
from models.teaching.measure import Measure
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.reduce import evaluate
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.reading import Reading, unwrapped
from services.evaluation.stature import Stature
from services.evaluation.track import known_track
from tests.stick_figure import DOWN, FRONT, LEFT, UP, figure, turned, unit

FRAMES, FRAME_S = 60, 1 / 30
ATTEMPT = FoundAttempt("volleyball_spike", "right", (1.2, 1.4, 1.6, 1.9))
DRAWN_BACK = Measure(signal="upper_arm_azimuth", side="lead", at="peak", shift_s=(-0.2, 0.0), take="max")


def reading(azimuths_deg: Float, lifted: Float) -> Reading:
    """Of a right upper arm that points there, 0 to the front and 90 outwards, and is lifted by so much: 0 hangs, 1 is level."""
    level = np.cos(np.radians(azimuths_deg))[:, None] * FRONT - np.sin(np.radians(azimuths_deg))[:, None] * LEFT
    arms = lifted[:, None] * level + (1 - lifted[:, None]) * DOWN
    joints = np.stack([figure({"right_upper_arm": unit(arm), "right_forearm": unit(arm)}) for arm in arms])
    return Reading(known_track(joints, FRAME_S, 0.006), "right", told=Stature(1.5, 0.0))


@pytest.mark.parametrize("turns", [-2, -1, 1])
def test_an_arm_that_hung_before_has_no_turns_of_what_noise_made_of_it(turns: int) -> None:
    azimuths = np.concatenate((np.linspace(0, 360 * turns, 30), np.linspace(360 * turns, 360 * turns + 100, 30)))
    hung = reading(azimuths, np.repeat((0.02, 0.9), 30))
    found = evaluate(DRAWN_BACK, hung, ATTEMPT)
    assert found.known
    assert 50 < found.value < 80
    assert np.abs(hung.of(CATALOGUE["upper_arm_azimuth"], "lead").value[30:]).max() < 180


@pytest.mark.parametrize("turns", [-1, 1, 2])
def test_an_arm_that_circled_before_is_measured_without_its_circles(turns: int) -> None:
    azimuths = np.concatenate((np.linspace(0, 360 * turns, 30), np.linspace(360 * turns, 360 * turns + 100, 30)))
    found = evaluate(DRAWN_BACK, reading(azimuths, np.full(FRAMES, 0.9)), ATTEMPT)
    assert 50 < found.value < 80


def test_within_a_stretch_an_arm_is_followed_beyond_half_a_turn() -> None:
    azimuths = np.linspace(40, 340, FRAMES)
    found = evaluate(
        Measure(signal="upper_arm_azimuth", side="lead", over=("start", "end"), take="range"),
        reading(azimuths, np.ones(FRAMES)),
        ATTEMPT,
    )
    assert found.value == pytest.approx(300 * 0.7 / ((FRAMES - 1) * FRAME_S), abs=2)


def test_a_turn_is_followed_across_what_is_unknown_and_not_across_what_says_nothing() -> None:
    degrees = np.array([170.0, np.nan, -170.0, -150.0, 100.0, 170.0, -175.0])
    known = np.isfinite(degrees)
    np.testing.assert_allclose(unwrapped(degrees)[known], [170, 190, 210, 100, 170, 185])
    sure = np.array([True, True, True, False, True, True, True])
    np.testing.assert_allclose(unwrapped(degrees, sure)[known], [170, 190, -150, 100, 170, 185])


def test_no_turn_is_followed_through_what_was_only_guessed() -> None:
    """A guess that lies behind was a turn of the arm: after it, all was 360 degrees too much."""
    degrees = np.array([20.0, 30.0, 150.0, -100.0, 40.0, 50.0])
    seen = np.array([True, True, False, False, True, True])
    np.testing.assert_allclose(unwrapped(degrees, seen=seen), [20, 30, 150, -100, 40, 50])
    np.testing.assert_allclose(unwrapped(np.array([150.0, -170.0, -150.0, 100.0]), seen=seen[1:5]), [150, 190, 210, 100])


def test_where_nothing_was_seen_the_turn_of_guesses_is_followed() -> None:
    np.testing.assert_allclose(unwrapped(np.array([170.0, -170.0, -150.0]), seen=np.zeros(3, np.bool_)), [170, 190, 210])


def test_a_guess_half_a_turn_off_changes_nothing_of_the_arm_after_it() -> None:
    """The wrong place of an elbow that hid behind the trunk for two frames."""
    azimuths = np.full(FRAMES, 60.0)
    azimuths[20], azimuths[21] = 180.0, -80.0
    right = reading(azimuths, np.full(FRAMES, 0.9))
    states = right.track.states.copy()
    states[20:22, coco.INDEX["right_elbow"]] = JointState.GUESSED
    guessed = Reading(replace(right.track, states=states), "right", told=Stature(1.5, 0.0))
    found = guessed.of(CATALOGUE["upper_arm_azimuth"], "lead").value
    np.testing.assert_allclose(found[22:], 60, atol=1e-6)


@pytest.mark.parametrize("wrong_deg", [179.0, 181.0])
def test_a_trunk_that_was_guessed_the_wrong_way_round_for_a_frame_has_not_turned_about(wrong_deg: float) -> None:
    """Left and right of shoulders and hips exchanged, in the middle of a turn to the side."""
    degrees = np.minimum(np.arange(FRAMES) * 2.0, 60.0)
    degrees[25] += wrong_deg
    sides = [turned(degree, UP, LEFT) for degree in degrees]
    track = known_track(np.stack([figure(hips=side, shoulders=side) for side in sides]), FRAME_S, 0.006)
    states = track.states.copy()
    states[25, [coco.INDEX[f"{side}_{part}"] for side in ("left", "right") for part in ("shoulder", "hip")]] = JointState.GUESSED
    guessed = Reading(replace(track, states=states), "right", told=Stature(1.5, 0.0))
    turn = Measure(signal="heading", side="lead", over=("start", "end"), take="range")
    found = evaluate(turn, guessed, FoundAttempt("badminton_clear", "right", (0.1, 0.5, 1.5, 1.8)))
    assert abs(found.value) == pytest.approx(54, abs=1)


def test_a_signal_is_computed_once_under_whichever_name_its_side_has() -> None:
    one = reading(np.zeros(FRAMES), np.ones(FRAMES))
    knee, trunk = CATALOGUE["knee_flexion"], CATALOGUE["trunk_forward"]
    assert one.of(knee, "lead") is one.of(knee, "right")
    assert one.of(knee, "other") is one.of(knee, "left")
    assert one.of(trunk, "both") is one.of(trunk, "lead")


def both_arms(left_deg: Float, right_deg: Float) -> float:
    """How far both upper arms are raised to the front at the peak, as a file asks for it."""
    limbs = [
        {
            f"{side}_{part}": unit(np.cos(np.radians(raised)) * DOWN + np.sin(np.radians(raised)) * FRONT)
            for side, raised in (("left", left), ("right", right))
            for part in ("upper_arm", "forearm")
        }
        for left, right in zip(left_deg, right_deg, strict=True)
    ]
    track = known_track(np.stack([figure(one) for one in limbs]), FRAME_S, 0.006)
    found = evaluate(
        Measure(signal="shoulder_flexion", side="both", at="peak"), Reading(track, "right", told=Stature(1.5, 0.0)), ATTEMPT
    )
    assert found.known
    return found.value


@pytest.mark.parametrize(
    ("left", "right", "mean"), [(175, 185, 180), (160, 210, 185), (-160, 150, 175), (80, 100, 90), (-30, 60, 15)]
)
def test_the_mean_of_both_arms_is_half_way_between_them_the_shorter_way(left: float, right: float, mean: float) -> None:
    """Arms over the head, one just in front and one just behind, hung down by their mean."""
    value = both_arms(np.full(FRAMES, left), np.full(FRAMES, right))
    assert (value - mean + 180) % 360 == pytest.approx(180, abs=1)
    assert -181 < value < 181


@pytest.mark.parametrize("turns", [-1, 1, 2])
def test_one_arm_that_circled_before_does_not_turn_the_mean_of_both_about(turns: int) -> None:
    circles = np.concatenate((np.linspace(0, 360 * turns, 30), np.full(30, 360 * turns + 80)))
    assert both_arms(circles, np.full(FRAMES, 40)) == pytest.approx(60, abs=0.5)
