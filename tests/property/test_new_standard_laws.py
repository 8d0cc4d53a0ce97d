"""What does not matter to a recorded standard: where in the room, to where the pupil looks, which side leads, when it was."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.skeleton import coco
from models.teaching.showing import PerformanceError
from models.teaching.standard import FRAME_S, Standard, decode, encode
from services.evaluation.new_standard import standard_of
from services.evaluation.normalise import mirrored
from services.evaluation.resampling import resampled
from services.evaluation.track import Track, known_track
from tests.demonstrations import shown
from tests.taught import placed, shipped

pytestmark = pytest.mark.slow

ACTIONS = st.sampled_from(("badminton_clear", "squat", "long_jump", "cartwheel", "soccer_kick"))
ANGLES = st.floats(-np.pi, np.pi)
PLACES = st.tuples(st.floats(-20, 20), st.floats(-20, 20))
SECONDS = st.floats(0, 1e5)


def plain(action: str) -> Standard:
    track, attempt = shown(action)
    return standard_of(track, attempt, shipped().standards[action], "plain")


@settings(max_examples=25, deadline=None)
@given(ACTIONS, ANGLES, PLACES, SECONDS, st.booleans())
def test_neither_room_nor_side_nor_time_is_in_a_standard(
    action: str, angle: float, place: tuple[float, float], later_s: float, left: bool
) -> None:
    track, attempt = shown(action)
    joints = placed(mirrored(track.joints_m) if left else track.joints_m, "right", angle, place)
    moved = known_track(joints, FRAME_S, 0.008)
    later = Track(track.t_s + later_s, moved.joints_m, moved.covariance_m2, moved.states)
    start, exertion, peak, end = (moment_s + later_s for moment_s in attempt.moments_s)
    other = replace(attempt, handed="left" if left else "right", moments_s=(start, exertion, peak, end))
    same, expected = standard_of(later, other, shipped().standards[action], "moved"), plain(action)
    np.testing.assert_allclose(same.joints_m, expected.joints_m, atol=1e-6)
    np.testing.assert_allclose(same.spread_m, expected.spread_m, atol=1e-6)
    np.testing.assert_allclose(same.moments_s, expected.moments_s, atol=1e-6)
    assert same.stature_m == pytest.approx(expected.stature_m, abs=1e-6)


@settings(max_examples=25, deadline=None)
@given(ACTIONS, st.integers(0, 2**32 - 1), st.floats(0, 1))
def test_whatever_was_hidden_a_standard_is_whole_or_refused_in_one_line(action: str, seed: int, share: float) -> None:
    track, attempt = shown(action)
    random = np.random.default_rng(seed)
    gone = np.zeros(track.states.shape, np.bool_)
    for joint in np.flatnonzero(random.uniform(size=coco.COUNT) < share):
        first, count = random.integers(len(track)), random.integers(1, 40)
        gone[first : first + count, joint] = True
    joints = np.where(gone[..., None], np.nan, track.joints_m)
    try:
        standard = standard_of(known_track(joints, FRAME_S, 0.008), attempt, shipped().standards[action], "partly seen")
    except PerformanceError as error:
        told = str(error)
    else:
        told, known = "", np.asarray(np.isfinite(standard.joints_m).all(axis=2))
        assert known[:, 5:].mean(axis=0).min() > 0.3
        assert decode(encode(standard), "own").action == action
    assert "\n" not in told


@settings(max_examples=15, deadline=None)
@given(ACTIONS, st.sampled_from((24.0, 50.0, 59.94, 100.0, 250.0)))
def test_the_rate_of_a_file_is_not_in_a_standard(action: str, rate_hz: float) -> None:
    track, attempt = shown(action)
    fast = resampled(track, 1 / rate_hz)
    again = resampled(fast, FRAME_S)
    standard = standard_of(again, attempt, shipped().standards[action], "of another rate")
    expected = plain(action)
    count = min(len(standard.joints_m), len(expected.joints_m))
    off_m = np.linalg.norm(standard.joints_m[:count] - expected.joints_m[:count], axis=2)
    assert np.quantile(off_m, 0.95) < 0.01
    assert off_m.max() < 0.12
