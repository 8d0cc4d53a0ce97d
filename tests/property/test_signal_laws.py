"""What no signal may depend on: how the room lies, how large somebody is, which side he throws with; what is unknown stays so."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.arrays import Float
from models.messages.motion import JointState
from models.motions.motion import Handed
from models.skeleton import coco
from models.teaching.measure import PHASES, Measure, Take
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.catalogue import FUNCTIONS
from services.evaluation.measures.reduce import evaluate
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.mass import masses_of
from services.evaluation.signals.reading import Reading
from services.evaluation.stature import Stature
from services.evaluation.track import Track, known_track
from tests.stick_figure import figure

FRAMES = 24
MASSES = masses_of(1.5)
"""Whoever is larger is older, too; here he is only larger."""
ATTEMPT = FoundAttempt("squat", "right", (0.1, 0.3, 0.5, 0.7))
HEAD = [coco.INDEX[name] for name in ("nose", "left_eye", "right_eye", "left_ear", "right_ear")]
SIZELESS = ("deg", "pct", "deg_s")
pytestmark = pytest.mark.slow


@st.composite
def motions(draw: st.DrawFn, waves: tuple[int, ...] = (1, 2)) -> Float:
    """(24, 17, 3) of somebody whose joints all wander smoothly and never into one another: those of the head do together.

    Args:
        draw: hypothesis's.
        waves: how often they go to and fro in the 0.8 s.
    """
    random = np.random.default_rng(draw(st.integers(0, 2**31)))
    t = np.linspace(0, 1, FRAMES)[:, None, None]
    size_m = np.where(np.isin(np.arange(coco.COUNT), HEAD), 0.006, 0.03)[:, None]
    wander = sum(random.normal(0, size_m, (1, coco.COUNT, 3)) * np.sin(2 * np.pi * (k * t + random.uniform())) for k in waves)
    return np.asarray(figure()[None] + wander + random.normal(0, 0.15, (1, 1, 3)) * t)


def track(joints_m: Float) -> Track:
    return known_track(joints_m, 1 / 30, 0.006)


def reading(joints_m: Float, lead: Handed = "right", stature_m: float = 1.5) -> Reading:
    return Reading(track(joints_m), lead, told=Stature(stature_m, 0.02 * stature_m), masses=MASSES)


def all_measures() -> list[Measure]:
    takes: list[Take] = ["max", "min", "mean", "range", "change", "time_of_max"]
    out = [Measure(signal=name, side="lead", over=("start", "end"), take=take) for name in CATALOGUE for take in takes]
    return [
        *out,
        *(Measure(signal=name, side="other", at="peak") for name in CATALOGUE),
        *(Measure(function=name) for name in FUNCTIONS),
    ]


def assert_same_values(name: str, other: Float, one: Float) -> None:
    """But for whole turns: where an arm hangs, it depends on its sigma whether they are followed."""
    turns = 360 * np.rint((other - one) / 360) if CATALOGUE[name].turns else 0.0
    np.testing.assert_allclose(other - turns, one, rtol=1e-6, atol=1e-6, err_msg=name)


def assert_same(first: Reading, second: Reading, names: list[str]) -> None:
    for name in names:
        one, other = (each.of(CATALOGUE[name], "lead") for each in (first, second))
        assert_same_values(name, other.value, one.value)
        # A slope is taken over a step of some millimetres, along the room's axes: near a bend that is not quite the same.
        np.testing.assert_allclose(np.nanmedian(other.sigma), np.nanmedian(one.sigma), rtol=0.2, err_msg=f"sigma of {name}")


@settings(max_examples=15)
@given(motions(), st.floats(-math.pi, math.pi), st.floats(-5, 5))
def test_turning_and_moving_the_room_changes_nothing(joints_m: Float, angle: float, along_m: float) -> None:
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    assert_same(reading(joints_m), reading(joints_m @ turn.T + (along_m, -along_m / 2, 0)), list(CATALOGUE))


@settings(max_examples=15)
@given(motions(), st.floats(0.6, 1.5))
def test_angles_and_shares_do_not_depend_on_size(joints_m: Float, size: float) -> None:
    small, large = reading(joints_m), reading(size * joints_m, stature_m=1.5 * size)
    for name, signal in CATALOGUE.items():
        if signal.unit in SIZELESS:
            one, other = (each.of(signal, "lead").value for each in (small, large))
            assert_same_values(name, other, one)


@settings(max_examples=15)
@given(motions())
def test_the_mirror_image_of_a_right_handed_attempt_is_a_left_handed_one(joints_m: Float) -> None:
    mirrored = (joints_m * (1, -1, 1))[:, list(coco.MIRROR)]
    assert_same(reading(joints_m), reading(mirrored, "left"), list(CATALOGUE))


@settings(max_examples=10, deadline=None)
@given(motions(), st.integers(0, 2**31), st.one_of(st.floats(0.0, 0.1), st.floats(0.0, 1.0)))
def test_what_is_unknown_gives_unknown_and_never_a_crash(joints_m: Float, seed: int, share: float) -> None:
    random = np.random.default_rng(seed)
    gaps = joints_m.copy()
    gaps[random.uniform(size=gaps.shape[:2]) < share] = np.nan
    for found in (reading(gaps), Reading(track(gaps), "left")):
        for measure in all_measures():
            result = evaluate(measure, found, ATTEMPT)
            assert not result.known or math.isfinite(result.value + result.sigma)
            assert result.known or result.why, result.name


def test_nobody_at_all_is_unknown_in_every_measure() -> None:
    nobody = reading(np.full((FRAMES, coco.COUNT, 3), np.nan))
    for measure in all_measures():
        assert not evaluate(measure, nobody, ATTEMPT).known, measure


@settings(max_examples=12, deadline=None)
@given(motions(waves=(1,)), st.integers(0, 2**31), st.booleans())
def test_what_is_known_in_spite_of_a_hole_is_what_it_is_without_it(joints_m: Float, seed: int, guessed: bool) -> None:
    """A hole of one to three frames in some joints: what is measured beside it is unknown, or right.

    Not so of speeds, which change within such a hole as they like, as would whoever goes to and fro within it, nor of the direction
    of an arm that hangs.
    """
    random = np.random.default_rng(seed)
    first = int(random.integers(2, FRAMES - 5))
    frames, joints = slice(first, first + int(random.integers(1, 4))), random.uniform(size=coco.COUNT) < 0.5
    whole = track(joints_m)
    states, holed_m, covariance_m2 = whole.states.copy(), joints_m.copy(), whole.covariance_m2.copy()
    states[frames, joints] = JointState.GUESSED if guessed else JointState.UNKNOWN
    holed_m[frames, joints] += 0.1 * random.standard_normal((coco.COUNT, 3))[joints] if guessed else np.nan
    covariance_m2[frames, joints] = 0.1**2 * np.eye(3)
    told = Stature(1.5, 0.0)
    holed = Reading(Track(whole.t_s, holed_m, covariance_m2, states), "right", told=told, masses=MASSES)
    right = Reading(whole, "right", told=told, masses=MASSES)
    takes: tuple[Take, ...] = ("max", "min", "range")
    steady = [name for name, one in CATALOGUE.items() if one.order == 0 and not one.rate_of and name != "upper_arm_azimuth"]
    for name in steady:
        for take in takes:
            measure = Measure(signal=name, side="lead", over=("start", "end"), take=take)
            one, other = evaluate(measure, holed, ATTEMPT), evaluate(measure, right, ATTEMPT)
            if one.known and other.known:
                assert abs(one.value - other.value) <= 5 * one.sigma, (name, take)


@pytest.mark.parametrize("frames", [1, 2, 3])
def test_a_track_of_a_frame_or_two_is_no_error(frames: int) -> None:
    short = reading(np.repeat(figure()[None], frames, axis=0))
    for measure in all_measures():
        found = evaluate(measure, short, ATTEMPT)
        assert np.isfinite((found.value, found.sigma)).all() or not found.known


@given(motions())
@settings(max_examples=10)
def test_a_value_at_a_keyframe_lies_between_the_extremes(joints_m: Float) -> None:
    found = reading(joints_m)
    for phase in PHASES[1:-1]:
        at, low, high = (
            evaluate(measure, found, ATTEMPT).value
            for measure in (
                Measure(signal="knee_flexion", side="lead", at=phase),
                Measure(signal="knee_flexion", side="lead", over=("start", "end"), take="min"),
                Measure(signal="knee_flexion", side="lead", over=("start", "end"), take="max"),
            )
        )
        assert low - 0.5 <= at <= high + 0.5
