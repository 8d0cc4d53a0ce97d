"""Jumps of simulated pupils at the box's rate, against what bears and how the whole body's centre of mass moves."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from models.messages.motion import JointState
from models.motions.perform import perform
from models.motions.performance import Performance
from models.skeleton import coco
from models.teaching.measure import Measure
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.measured import Measured
from services.evaluation.measures.reduce import evaluate
from services.evaluation.signals.reading import Reading
from services.evaluation.stature import Stature, stature_of
from services.evaluation.track import Track, known_track
from tests.bench.teaching.noise import as_fused
from tests.bench.teaching.twinned import Jump, Truth, attempt_of
from tests.pupils import pupil

pytestmark = pytest.mark.slow


@cache
def performed(action: str, *faults: str) -> tuple[Track, FoundAttempt, Jump | None, float]:
    motion = perform(Performance(action, faults=dict.fromkeys(faults, 1.0)), pupil())
    truth = Truth(pupil(), motion)
    joints_m = truth.joints_m(np.arange(0, motion.duration_s, 1 / 30))
    (attempt,) = motion.attempts
    return known_track(joints_m, 1 / 30, 0.005), attempt_of(attempt), truth.jump(attempt), truth.stature_m


def measured(name: str, action: str, *faults: str) -> Measured:
    track, attempt, _, _ = performed(action, *faults)
    return evaluate(Measure(function=name), Reading(track, "right"), attempt)


def true_jump(action: str) -> Jump:
    jump = performed(action)[2]
    assert jump is not None
    return jump


@pytest.mark.parametrize("action", ["long_jump", "star_jump", "volleyball_spike"])
def test_a_jump_is_as_high_and_as_long_as_it_is(action: str) -> None:
    true = true_jump(action)
    height, time = measured("jump_height", action), measured("flight_time", action)
    assert height.known
    assert abs(height.value - 100 * true.rise_m) < 2 * height.sigma
    assert height.sigma < 4
    assert time.value == pytest.approx(true.on_s - true.off_s, abs=0.035)


def test_a_long_jump_is_as_far_as_by_the_tape() -> None:
    distance = measured("jump_distance", "long_jump")
    assert distance.known
    assert distance.value == pytest.approx(100 * true_jump("long_jump").reach_m, abs=2.0)
    assert measured("jump_distance", "long_jump", "upright_takeoff").value < distance.value - 8


def test_chance_makes_no_jump_shorter() -> None:
    """The ankle in front before and the one behind after are each the extreme of two: their errors must not count as steps."""
    track, attempt, _, stature_m = performed("long_jump")
    told = Stature(stature_m, 0.0)

    def travel_cm(seen: Track) -> float:
        return evaluate(Measure(function="ankle_travel"), Reading(seen, "right", told=told), attempt).value

    seen = [travel_cm(as_fused(track.joints_m, 1 / 30, np.random.default_rng(seed))) for seed in range(40)]
    assert np.mean(seen) == pytest.approx(travel_cm(track), abs=0.7)


def with_ankles(state: JointState, variance_m2: float, from_s: float, to_s: float) -> tuple[Track, FoundAttempt]:
    """A long jump of which the ankles are so well known in a stretch of time."""
    track, attempt, _, _ = performed("long_jump")
    frames = np.flatnonzero((track.t_s >= from_s) & (track.t_s <= to_s))
    states, covariance_m2 = track.states.copy(), track.covariance_m2.copy()
    for ankle in (coco.INDEX["left_ankle"], coco.INDEX["right_ankle"]):
        states[frames, ankle], covariance_m2[frames, ankle] = state, variance_m2 * np.eye(3)
    return replace(track, states=states, covariance_m2=covariance_m2), attempt


def flown(name: str, track: Track, attempt: FoundAttempt) -> Measured:
    return evaluate(Measure(function=name), Reading(track, "right"), attempt)


def test_the_worse_ankles_are_known_the_less_sure_are_the_times_that_they_tell() -> None:
    well, badly = (with_ankles(JointState.SEEN, sigma_m**2, 0.0, 60.0) for sigma_m in (0.005, 0.06))
    for name in ("flight_time", "jump_height", "jump_height_by_time", "take_off_angle", "landing_apart"):
        sure, unsure = flown(name, *well), flown(name, *badly)
        assert unsure.known, name
        assert unsure.value == pytest.approx(sure.value), name
        assert unsure.sigma > 1.3 * sure.sigma, name


def test_ankles_that_were_only_guessed_at_the_landing_do_not_tell_when_it_was() -> None:
    peak_s = performed("long_jump")[1].moment_s("peak")
    guessed = with_ankles(JointState.GUESSED, 0.01, peak_s, 60.0)
    for name in ("flight_time", "jump_height_by_time", "landing_apart"):
        assert measured(name, "long_jump").known, name
        assert not flown(name, *guessed).known, name
        assert flown(name, *guessed).why, name
    height = flown("jump_height", *guessed)
    assert height.known, "the take-off was seen"
    assert height.value == pytest.approx(measured("jump_height", "long_jump").value, abs=0.1)


def test_a_steeper_take_off_has_a_larger_angle() -> None:
    assert measured("take_off_angle", "long_jump", "upright_takeoff").value > measured("take_off_angle", "long_jump").value + 3
    assert measured("take_off_angle", "star_jump").value > 75


def test_feet_that_land_one_after_the_other_are_told_from_feet_that_land_together() -> None:
    assert measured("landing_apart", "volleyball_spike").value < 0.03
    assert measured("landing_apart", "volleyball_spike", "one_foot_landing").value > 0.1


@pytest.mark.parametrize("action", ["squat", "forward_roll", "badminton_clear"])
def test_who_does_not_jump_has_no_height(action: str) -> None:
    height = measured("jump_height", action)
    assert not height.known
    assert "floor" in height.why


def test_heels_are_never_known_and_the_reason_is_said() -> None:
    heels = measured("heel_rise", "squat")
    assert not heels.known
    assert np.isnan(heels.value)
    assert "heels" in heels.why


@pytest.mark.parametrize("action", ["squat", "star_jump", "soccer_kick"])
def test_a_pupil_is_as_tall_as_his_limbs_say(action: str) -> None:
    track, _, _, stature_m = performed(action)
    estimate = stature_of(track)
    assert estimate.metres == pytest.approx(stature_m, rel=0.025)
    assert abs(estimate.metres - stature_m) < 2 * estimate.sigma_m


def test_legs_that_are_never_seen_give_no_stature_and_no_shares_of_it() -> None:
    track, attempt, _, _ = performed("squat")
    legless = track.joints_m.copy()
    legless[:, 13:] = np.nan
    hidden = known_track(legless, 1 / 30)
    assert np.isnan(stature_of(hidden).metres)
    wrist = evaluate(Measure(signal="wrist_height", at="peak"), Reading(hidden, "right"), attempt)
    assert not wrist.known
    assert wrist.why
    elbow = evaluate(Measure(signal="elbow_flexion", at="peak"), Reading(hidden, "right"), attempt)
    assert elbow.known, "an angle needs no stature"


def test_symmetric_squats_are_symmetric_and_end_in_balance() -> None:
    assert abs(measured("knee_difference", "squat").value) < 1
    assert abs(measured("knee_symmetry", "squat").value) < 2
    assert measured("sway", "squat").value < 3
    assert measured("wrist_smoothness", "squat").known
