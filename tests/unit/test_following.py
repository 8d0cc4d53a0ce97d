"""Which moment of the standard a frame is beside: one each, and none can be passed over for nothing."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from models.arrays import Float
from models.interpolation import between
from models.skeleton import coco
from models.teaching.standard import FRAME_S
from services.evaluation.alignment import AlignedTrack, align
from services.evaluation.following import FASTEST, bridged, dwelling, follow
from services.evaluation.track import Track, known_track
from tests.taught import shallow_squat, shipped

HIPS = [coco.INDEX["left_hip"], coco.INDEX["right_hip"]]


def _motion(frames: int, seed: int, joints: int = 5) -> Float:
    return np.random.default_rng(seed).normal(size=(frames, joints, 3)).cumsum(axis=0)


def test_the_same_motion_is_followed_frame_by_frame_and_a_slower_one_evenly() -> None:
    motion = _motion(20, 1)
    assert follow(motion, motion).tolist() == list(range(20))
    slower = between(motion, np.arange(39) / 2)
    assert follow(slower, motion) == pytest.approx(np.arange(39) / 2)


def test_who_dwells_is_beside_the_moment_at_which_he_dwells() -> None:
    motion = _motion(30, 2)
    dwelling = np.concatenate((motion[:15], np.repeat(motion[14:15], 12, axis=0), motion[15:]))
    frames = follow(dwelling, motion)
    assert np.abs(frames[14:26] - 14).max() < 0.5
    assert np.linalg.norm(between(motion, frames) - dwelling, axis=2).mean() < 0.4


def _distances(ours: Float, theirs: Float) -> Float:
    """(T, M) sums of squared distances; of what is known, for what is not as well."""
    squared = ((ours[:, None] - theirs[None]) ** 2).sum(axis=3)
    known = np.isfinite(squared).sum(axis=2)
    return np.asarray(np.divide(squared.shape[2] * np.nansum(squared, axis=2), known, out=np.zeros(known.shape), where=known > 0))


def _least(ours: Float, theirs: Float, most: int) -> float:
    """The least cost, by trying all ways to each moment, `most` half steps at a time."""
    moments = np.arange(2 * len(ours) - 1) * (len(theirs) - 1) / (2 * len(ours) - 2)
    apart = _distances(ours, between(theirs, moments))
    costs = np.where(np.arange(len(moments)) == 0, apart[0], np.inf)
    for row in apart[1:]:
        before = np.concatenate((np.full(most, np.inf), costs))
        costs = np.min([before[ahead : ahead + len(costs)] for ahead in range(most + 1)], axis=0) + row
    return float(costs[-1])


@example(6, 2, 9, 0.2)  # who dwells
@settings(deadline=None, max_examples=40)
@given(st.integers(2, 25), st.integers(1, 25), st.integers(0, 2**31), st.sampled_from((0.0, 0.2, 0.7)))
def test_no_other_way_that_is_allowed_costs_less(ours: int, theirs: int, seed: int, unknown: float) -> None:
    random = np.random.default_rng(seed)
    one, other = _motion(ours, seed), _motion(theirs, seed + 1)
    one[random.uniform(size=one.shape[:2]) < unknown] = np.nan
    frames = follow(one, other)
    steps = np.diff(frames)
    assert (frames[0], frames[-1]) == (0, theirs - 1)
    assert (steps >= 0).all()
    most = int(2 * FASTEST * dwelling(one, other))
    assert (steps <= most / 2 * (theirs - 1) / (ours - 1) + 1e-9).all()
    cost = _distances(one, between(other, frames)).diagonal().sum()
    assert cost == pytest.approx(_least(one, other, most))


def test_a_single_frame_and_a_single_moment_are_no_error() -> None:
    assert follow(_motion(1, 0), _motion(7, 1)).tolist() == [0]
    assert follow(_motion(7, 0), _motion(1, 1)).tolist() == [0] * 7


@pytest.mark.parametrize(("ours", "theirs"), [(_motion(0, 0), _motion(3, 0)), (_motion(3, 0), _motion(0, 0)),
                                              (_motion(3, 0), _motion(3, 0, 4))])  # fmt: skip
def test_what_cannot_be_followed_is_refused(ours: Float, theirs: Float) -> None:
    with pytest.raises(ValueError, match="cannot be followed"):
        follow(ours, theirs)


def test_frames_without_any_joint_lie_between_their_neighbours_and_others_are_left_alone() -> None:
    motion = _motion(8, 4)
    motion[2:4], motion[5, 1], motion[7] = np.nan, np.nan, np.nan
    whole = bridged(motion)
    np.testing.assert_allclose(whole[2], (2 * motion[1] + motion[4]) / 3)
    np.testing.assert_allclose(whole[7], motion[6])
    assert np.isnan(whole[5, 1]).all()
    left = [0, 1, 4, 5, 6]
    np.testing.assert_array_equal(whole[left], motion[left])
    nothing = np.full((3, 5, 3), np.nan)
    assert bridged(nothing) is nothing


def aligned_with(action: str, track: Track) -> AlignedTrack:
    found = align(track, shipped().standards[action])
    assert found is not None
    return found


def aligned(track: Track) -> AlignedTrack:
    return aligned_with("squat", track)


def test_the_model_beside_who_squats_half_as_deep_is_deep_only_while_he_is_deepest() -> None:
    """Equation 19 gives all deep frames of the standard to his deepest one, and every other frame finds its like."""
    joints = shallow_squat(0.5)
    found = aligned(known_track(joints, FRAME_S))
    ours, theirs = (motion[:, HIPS, 2].mean(axis=1) for motion in (joints, between(found.standard_m, found.frames)))
    bottom = int(ours.argmin())
    assert theirs[bottom] < ours[bottom] - 0.1
    assert theirs.min() == pytest.approx(shipped().standards["squat"].joints_m[:, HIPS, 2].mean(axis=1).min(), abs=0.02)
    assert np.count_nonzero(theirs < ours - 0.05) > 5


def test_a_frame_that_was_lost_takes_no_more_of_the_standard_than_its_neighbours_do() -> None:
    """With an arm that is always wrong every frame costs; one that shows nothing cost nothing, however much it passed over."""
    joints = shipped().standards["squat"].joints_m.copy()
    joints[:, [coco.INDEX["left_wrist"], coco.INDEX["left_elbow"]]] += (0.0, 0.4, 0.3)
    lost = len(joints) // 3
    joints[lost] = np.nan
    found = aligned(known_track(joints, FRAME_S))
    assert np.count_nonzero(found.alignment.path[:, 0] == lost) <= 3
    steps = np.diff(found.frames)[lost - 1 : lost + 1]
    assert steps.max() <= 1.5


def test_a_pupil_of_whom_one_hip_is_lost_for_a_moment_is_followed_as_if_it_was_not() -> None:
    joints = shipped().standards["squat"].joints_m.copy()
    lost = slice(len(joints) // 2 - 3, len(joints) // 2 + 3)
    joints[lost, HIPS[0]] = np.nan
    found = aligned(known_track(joints, FRAME_S))
    # Through the hole he goes evenly, as nobody does; a tenth of a second is little.
    assert np.abs(found.frames - np.arange(len(joints))).max() <= 3


@pytest.mark.parametrize("action", ["basketball_shot", "squat"])
@pytest.mark.parametrize("dwells", [0.0, 0.8, 1.0])
@pytest.mark.parametrize("pace", [1.0, 1.3, 1.6])
def test_who_dwells_before_he_is_quick_is_not_beside_a_moment_that_is_past(action: str, dwells: float, pace: float) -> None:
    """He holds the ball as long as the whole shot takes; that makes him no slower in the shot itself."""
    standard = shipped().standards[action]
    last, held = len(standard.joints_m) - 1, standard.moments_s[1] / FRAME_S
    before, after = np.arange(0, held, pace), np.append(np.arange(held, last, pace), last)
    shown = np.concatenate((before, np.full(round(dwells * last), held), after))
    found = aligned_with(action, known_track(between(standard.joints_m, shown), FRAME_S))
    apart_m = np.linalg.norm(between(found.standard_m, found.frames) - found.joints_m, axis=2)
    assert apart_m.max() < 0.07


def test_only_what_takes_longer_than_in_the_standard_is_dwelling() -> None:
    motion = np.cumsum(np.full((40, 5, 3), 0.02), axis=0)
    held = np.concatenate((motion[:20], np.repeat(motion[19:20], 40, axis=0), motion[20:]))
    assert dwelling(motion, motion) == 1
    assert dwelling(motion, held) == 1
    assert dwelling(held, held) == 1
    assert dwelling(held, motion) == pytest.approx(2, rel=0.15)
    assert dwelling(between(motion, np.arange(0, 39, 0.5)), motion) == 1
    assert dwelling(motion[:1].repeat(9, axis=0), motion) == 3
    unseen = held.copy()
    unseen[20:60] = np.nan
    assert dwelling(unseen, motion) == 1
    assert dwelling(np.full_like(motion, np.nan), np.full_like(motion, np.nan)) == 1
    assert dwelling(motion, motion[:1]) == 1


@settings(deadline=None, max_examples=30)
@given(st.integers(2, 30), st.integers(1, 30), st.integers(0, 2**31), st.floats(0, 1), st.floats(0, 1))
def test_dwelling_is_bounded_whatever_was_seen_and_known_to_no_size_of_the_body(
    ours: int, theirs: int, seed: int, unknown: float, still: float
) -> None:
    random = np.random.default_rng(seed)
    one, other = _motion(ours, seed), _motion(theirs, seed + 1)
    one[random.uniform(size=ours) < still] = one[0]
    one[random.uniform(size=one.shape[:2]) < unknown] = np.nan
    assert 1 <= dwelling(one, other) <= 3
    assert dwelling(2 * one, 2 * other) == dwelling(one, other)
