"""The largest and the smallest of a stretch: of what was seen, and not of the edge of what was not."""

from dataclasses import replace

import numpy as np
import pytest

from models.arrays import Float
from models.messages.motion import JointState
from models.skeleton import coco
from models.teaching.measure import Measure, Take
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.measured import BACKWARDS, Measured
from services.evaluation.measures.reduce import evaluate
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.reading import Reading
from services.evaluation.signals.stretch import stretch, top, top_sigma_s
from services.evaluation.stature import Stature
from services.evaluation.track import Track, known_track
from services.evaluation.uncertainty import EXACT
from tests.stick_figure import DOWN, LEFT, figure, turned

COUNT, FRAME_S = 60, 1 / 30
LOWEST = 30
ATTEMPT = FoundAttempt("squat", "right", (0.2, 0.6, 1.0, 1.8))
ALL: tuple[Take, ...] = ("max", "range", "time_of_max")


def bends_deg() -> Float:
    """(60,) of somebody who goes down and up within 0.7 s: 64 degrees at most."""
    t = np.clip((np.arange(COUNT) - LOWEST) / 11, -1, 1)
    return np.asarray(64 * np.cos(np.pi * t / 2) ** 2)


def dipping() -> Float:
    """(60, 17, 3): hips sink as knees bend."""
    frames = []
    for bend in bends_deg():
        limbs = {f"{side}_{limb}": turned(sign * bend / 2, LEFT, DOWN) for side in ("left", "right")
                 for limb, sign in (("thigh", -1.0), ("shank", 1.0))}  # fmt: skip
        one = figure(limbs)
        frames.append(one - (0, 0, one[coco.INDEX["left_ankle"], 2] - 0.07))
    return np.stack(frames)


def unseen(first: int, end: int, state: JointState = JointState.UNKNOWN, joint: str | None = None) -> Reading:
    """With frames in which the whole body, or a joint, is unknown or guessed; guessed to be 8 cm in front."""
    track = known_track(dipping(), FRAME_S, 0.005)
    joints = slice(None) if joint is None else coco.INDEX[joint]
    states, joints_m, covariance_m2 = track.states.copy(), track.joints_m.copy(), track.covariance_m2.copy()
    states[first:end, joints] = state
    if state == JointState.UNKNOWN:
        joints_m[first:end, joints], covariance_m2[first:end, joints] = np.nan, np.nan
    else:
        joints_m[first:end, joints] += (0.08, 0.0, 0.0)
    return Reading(Track(track.t_s, joints_m, covariance_m2, states), "right", told=Stature(1.5, 0.0))


def measured(reading: Reading, take: Take, signal: str = "knee_flexion") -> Measured:
    return evaluate(Measure(signal=signal, over=("start", "end"), take=take), reading, ATTEMPT)


@pytest.mark.parametrize("state", [JointState.UNKNOWN, JointState.GUESSED])
@pytest.mark.parametrize(("first", "end"), [(LOWEST - 4, LOWEST + 5), (LOWEST, LOWEST + 1), (LOWEST + 1, LOWEST + 4)])
def test_the_edge_of_what_was_not_seen_is_no_extreme(first: int, end: int, state: JointState) -> None:
    """Somebody whose dip was lost was told to bend his knees."""
    reading = unseen(first, end, state)
    for take in ALL:
        assert not measured(reading, take).known
    assert not measured(reading, "min", "hip_height").known
    for function in ("com_oscillation", "knee_symmetry"):
        assert not evaluate(Measure(function=function), reading, ATTEMPT).known, function


@pytest.mark.parametrize("state", [JointState.UNKNOWN, JointState.GUESSED])
def test_what_was_not_seen_elsewhere_hides_nothing(state: JointState) -> None:
    whole = unseen(0, 0)
    for first, end in ((8, 11), (LOWEST + 4, LOWEST + 7), (46, 50)):
        part = unseen(first, end, state)
        for take in ALL:
            one, other = measured(part, take), measured(whole, take)
            assert one.known, (take, first)
            assert one.value == pytest.approx(other.value, abs=1e-6)
            assert one.sigma < other.sigma + 2


def test_a_single_frame_that_was_guessed_is_not_the_largest() -> None:
    """Beside a hand that is guessed 8 cm off for one frame, all others were seen."""
    whole, part = (
        measured(reading, "max", "wrist_forward") for reading in (unseen(0, 0), unseen(44, 45, JointState.GUESSED, "right_wrist"))
    )
    assert part.known
    assert part.value == pytest.approx(whole.value, abs=0.1)


def test_what_rises_to_where_it_was_not_seen_may_have_been_larger_there() -> None:
    """Of two dips the deeper one is lost at its lowest: the shallower one is not the deepest of all for certain."""
    joints = np.concatenate((dipping()[20:41], dipping()[19:41], dipping()[20:37]))
    joints[:21] = joints[0] + 0.6 * (joints[:21] - joints[0])
    lost = joints.copy()
    lost[30:34] = np.nan
    whole, part = (
        evaluate(
            Measure(signal="knee_flexion", over=("start", "peak"), take="max"),
            Reading(known_track(one, FRAME_S, 0.005), "right", told=Stature(1.5, 0.0)),
            replace(ATTEMPT, moments_s=(0.1, 0.2, 1.3, 1.8)),
        )
        for one in (joints, lost)
    )
    assert whole.known
    assert not part.known or part.sigma > whole.value - part.value > 0


def test_what_was_not_seen_for_long_may_have_been_anything() -> None:
    assert not measured(unseen(38, 52), "max").known
    assert measured(unseen(38, 46), "max").known


def test_a_top_at_the_end_of_a_stretch_has_no_bend() -> None:
    """Between two frames: of a ramp the bend is what noise makes it, and the sigma anything."""
    t_s = np.arange(COUNT) * FRAME_S
    joints = np.stack([figure({"right_shank": turned(10 + 40 * t + 1e-9 * t**2, LEFT, DOWN)}) for t in t_s])
    series = Reading(known_track(joints, FRAME_S), "right", EXACT, Stature(1.5, 0.0)).of(CATALOGUE["knee_flexion"], "lead")
    last = top(series, stretch(series, 0.5, 1.21))
    assert last is not None
    assert not last.bends
    assert top_sigma_s(series, last) == pytest.approx(FRAME_S / 2)


def test_a_stretch_that_ends_before_it_begins_is_unknown_and_says_why() -> None:
    short = replace(ATTEMPT, moments_s=(0.2, 0.6, 0.7, 1.8))
    found = evaluate(
        Measure(signal="knee_flexion", over=("exertion", "peak"), shift_s=(0.2, -0.2), take="max"), unseen(0, 0), short
    )
    assert not found.known
    assert found.why == BACKWARDS


def speed(reading: Reading) -> Measured:
    return measured(reading, "max", "wrist_speed")


def test_a_speed_is_not_made_of_places_that_nobody_saw() -> None:
    """A wrist that is guessed 8 cm off in one frame has 2 m/s in the seen ones beside it, and a largest speed is just that."""
    reading = unseen(44, 45, JointState.GUESSED, "right_wrist")
    series = reading.of(CATALOGUE["wrist_speed"], "right")
    assert np.flatnonzero(~series.seen[10:50]).tolist() == [32, 33, 34, 35, 36]
    angular = unseen(44, 45, JointState.GUESSED, "right_ankle").of(CATALOGUE["knee_angular_speed"], "right")
    assert np.flatnonzero(~angular.seen[10:50]).tolist() == [32, 33, 34, 35, 36]
    whole, part = speed(unseen(0, 0)), speed(reading)
    assert not part.known or part.value == pytest.approx(whole.value, abs=0.2)


def test_a_speed_is_as_unsure_as_the_places_that_it_is_made_of() -> None:
    track = known_track(dipping(), FRAME_S, 0.005)
    covariance_m2 = track.covariance_m2.copy()
    covariance_m2[44, coco.INDEX["right_wrist"]] *= 100
    one, other = (
        Reading(replace(track, covariance_m2=each), "right", told=Stature(1.5, 0.0)).of(CATALOGUE["wrist_speed"], "right").sigma
        for each in (track.covariance_m2, covariance_m2)
    )
    assert (other[[42, 43, 44, 45, 46]] > 2 * one[[42, 43, 44, 45, 46]]).all()
    np.testing.assert_allclose(other[[40, 48]], one[[40, 48]])
