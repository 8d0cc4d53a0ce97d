"""What does not matter to attempts and to equation 19: where in the room, how tall, which side, how fast."""

from functools import cache

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from models.arrays import Float
from models.motions.actions.library import ACTIONS
from models.teaching.standard import FRAME_S
from services.evaluation.alignment import align, warp
from services.evaluation.attempts import AttemptFinder
from services.evaluation.energy import keyframes_of_energy, motion_energy
from services.evaluation.features import features_of, mirrored_features
from services.evaluation.keyframes import in_order, keyframes_of, room_for
from services.evaluation.normalise import lead_right, mirrored
from services.evaluation.track import known_track
from tests.bench.teaching.finding import shipped

pytestmark = pytest.mark.slow

ANGLES = st.floats(-np.pi, np.pi)
PLACES = st.tuples(st.floats(-20, 20), st.floats(-20, 20))
SIZES = st.floats(0.6, 1.5)
ALL = list(ACTIONS)


def moved(joints_m: Float, angle: float, place: tuple[float, float], size: float) -> Float:
    """By another pupil, elsewhere in a room that is turned."""
    rotation = np.array(((np.cos(angle), -np.sin(angle), 0), (np.sin(angle), np.cos(angle), 0), (0, 0, 1)))
    return np.asarray(size * joints_m @ rotation.T + (*place, 0.0))


def performed(action: str) -> Float:
    standard = next(one for one in shipped() if one.action == action)
    joints = standard.exemplars[-1].joints_m
    return np.concatenate((np.repeat(joints[:1], 15, axis=0), joints, np.repeat(joints[-1:], 15, axis=0)))


@cache
def finder() -> AttemptFinder:
    return AttemptFinder(shipped())


def found(joints_m: Float) -> list[tuple[str, str, tuple[float, ...]]]:
    finder().reset()
    attempts = (finder().push(joints, number * FRAME_S) for number, joints in enumerate(joints_m))
    return [(one.action, one.handed, one.moments_s) for one in attempts if one is not None]


@cache
def plain(action: str) -> list[tuple[str, str, tuple[float, ...]]]:
    """What is found of it where it was performed."""
    return found(performed(action))


@settings(max_examples=20, deadline=None)
@given(st.sampled_from(ALL), ANGLES, PLACES, SIZES)
def test_neither_room_nor_size_changes_what_is_found(action: str, angle: float, place: tuple[float, float], size: float) -> None:
    ((name, handed, moments),) = found(moved(performed(action), angle, place, size))
    assert (name, handed) == plain(action)[0][:2] == (action, "right")
    np.testing.assert_allclose(moments, plain(action)[0][2], atol=1e-4)


@settings(max_examples=10, deadline=None)
@given(st.sampled_from(ALL), st.tuples(st.integers(0, 59), st.integers(0, 16)))
def test_features_of_the_mirrored_motion_are_the_mirrored_features(action: str, unknown: tuple[int, int]) -> None:
    joints = performed(action)[15:75].copy()
    joints[unknown] = np.nan
    np.testing.assert_array_equal(mirrored_features(features_of(joints, FRAME_S)), features_of(mirrored(joints), FRAME_S))


@settings(max_examples=10, deadline=None)
@given(st.sampled_from(["badminton_clear", "soccer_kick", "cartwheel"]), ANGLES)
def test_in_the_mirror_the_other_side_leads_and_nothing_else_changes(action: str, angle: float) -> None:
    ((name, handed, moments),) = found(moved(mirrored(performed(action)), angle, (1.0, 2.0), 1.0))
    assert (name, handed) == (action, "left")
    np.testing.assert_allclose(moments, plain(action)[0][2], atol=0.02)


@settings(max_examples=20, deadline=None)
@given(st.sampled_from(ALL), ANGLES, PLACES, SIZES)
def test_an_alignment_knows_no_room_size_or_side(action: str, angle: float, place: tuple[float, float], size: float) -> None:
    standard = next(one for one in shipped() if one.action == action)
    joints = standard.exemplars[0].joints_m
    plain = align(known_track(joints, FRAME_S), standard)
    other = align(lead_right(known_track(moved(mirrored(joints), angle, place, size), FRAME_S), "left"), standard)
    assert plain is not None
    assert other is not None
    assert np.isclose(other.alignment.cost, plain.alignment.cost, rtol=1e-6)
    np.testing.assert_allclose(other.joints_m, plain.joints_m, atol=1e-7)


@settings(max_examples=50, deadline=None)
@given(
    hnp.arrays(np.float64, st.tuples(st.integers(1, 30), st.just(17), st.just(3)), elements=st.floats(-3, 3)),
    st.lists(st.integers(1, 4), min_size=30, max_size=30),
    st.booleans(),
)
def test_a_time_warped_copy_is_apart_by_nothing_whichever_way_round(motion: Float, repeats: list[int], turned: bool) -> None:
    slower = np.repeat(motion, repeats[: len(motion)], axis=0)
    pair = (motion, slower) if turned else (slower, motion)
    assert warp(*pair).cost == 0.0
    assert warp(*pair, radius=4 * len(motion)).cost == 0.0


@settings(max_examples=30, deadline=None)
@given(
    hnp.arrays(np.float64, st.tuples(st.integers(1, 12), st.just(17), st.just(3)), elements=st.floats(-2, 2)),
    hnp.arrays(np.float64, st.tuples(st.integers(1, 12), st.just(17), st.just(3)), elements=st.floats(-2, 2)),
    st.integers(0, 12),
)
def test_a_wider_band_never_costs_more_and_a_path_goes_on_in_every_step(ours: Float, theirs: Float, radius: int) -> None:
    narrow, wide = warp(ours, theirs, radius), warp(ours, theirs)
    assert wide.cost <= narrow.cost + 1e-9
    assert np.isclose(warp(theirs, ours).cost, wide.cost)
    steps = np.diff(narrow.path, axis=0)
    assert narrow.path[0].tolist() == [0, 0]
    assert narrow.path[-1].tolist() == [len(ours) - 1, len(theirs) - 1]
    assert ((steps == 0) | (steps == 1)).all()
    assert (steps.sum(axis=1) >= 1).all()


@settings(max_examples=30, deadline=None)
@given(
    hnp.arrays(
        np.float64,
        st.tuples(st.integers(0, 60), st.just(17), st.just(3)),
        elements=st.one_of(st.floats(-100, 100), st.just(float("nan")), st.just(0.0)),
    )
)
def test_garbage_is_no_attempt_and_breaks_nothing(joints: Float) -> None:
    assert found(joints) == []
    keyframes_of(joints, FRAME_S, shipped(), "squat")
    keyframes = keyframes_of_energy(joints)
    assert len(motion_energy(joints)) == len(joints)
    assert ((keyframes > 0) & (keyframes < len(joints))).all()


@settings(max_examples=20, deadline=None)
@given(st.sampled_from(ALL), st.integers(1, 10), st.floats(0, 1), st.integers(10, 30))
def test_a_third_of_a_second_of_an_attempt_again_and_again_is_none(action: str, length: int, where: float, times: int) -> None:
    joints = performed(action)
    first = int(where * (len(joints) - length))
    assert found(np.tile(joints[first : first + length], (times, 1, 1))) == []


@given(st.floats(0.2, 3.0), ANGLES, PLACES)
def test_energy_grows_with_the_square_of_size_and_knows_no_place(size: float, angle: float, place: tuple[float, float]) -> None:
    joints = performed("squat")
    np.testing.assert_allclose(
        motion_energy(moved(joints, angle, place, size)), size**2 * motion_energy(joints), rtol=1e-6, atol=1e-12
    )
    assert keyframes_of_energy(moved(joints, angle, place, size)).tolist() == keyframes_of_energy(joints).tolist()


@given(st.lists(st.floats(-50, 150), min_size=4, max_size=4), st.integers(5, 100))
def test_keyframes_follow_one_another_within_the_frames_and_those_that_do_stay(frames: list[float], count: int) -> None:
    assume(count >= room_for(FRAME_S))
    ordered = in_order(np.array(frames), count, FRAME_S)
    assert ordered[0] >= 0
    assert ordered[-1] <= count - 1
    assert (np.diff(ordered) >= 1).all()
    np.testing.assert_allclose(in_order(ordered, count, FRAME_S), ordered)
