"""Laws of putting motions together: placing is rigid, seams do not jump, attempts keep their order and times."""

from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.arrays import Float
from models.body.pose import Pose
from models.motions import rotations, sequence
from models.motions.motion import CONTACTS, RATE_HZ, Attempt, Motion, Thing
from models.motions.sequence import Act, Sequence
from models.motions.standpoint import Standpoint, standpoint_of
from models.skeleton import smpl

BEGINNING = Pose(np.array((0.0, 0.0, 0.9)), np.random.default_rng(1).normal(0, 0.3, (smpl.COUNT, 3)) * (np.arange(24) > 0)[:, None])
"""What all acts of these tests begin and end in: any pose whose pelvis stands upright."""

places = st.builds(Standpoint, st.floats(-9, 9), st.floats(-9, 9), st.floats(-9, 9))
seeds = st.integers(0, 2**20)
few = settings(max_examples=6)


def some_motion(seed: int) -> Motion:
    """Begins and ends in `BEGINNING`, somewhere else; in between it does anything."""
    generator = np.random.default_rng(seed)
    count = int(generator.integers(8, 60))
    share = np.linspace(0, 1, count)
    bump = (np.sin(np.pi * share) ** 2)[:, None]
    goal = Standpoint(*(float(value) for value in generator.normal(0, 2, 3)))
    heading = rotations.about(2, share * goal.heading_rad)
    swing = rotations.matrices(bump * generator.normal(0, 1, 3))
    turned = np.tile(BEGINNING.rotations_rad, (count, 1, 1)) + bump[..., None] * generator.normal(0, 0.5, (smpl.COUNT, 3))
    turned[:, 0] = rotations.vectors(heading @ swing)
    path = BEGINNING.translation_m + share[:, None] * goal.place_m + bump * generator.normal(0, 0.3, 3)
    attempts: tuple[Attempt, ...] = ()
    if count > 16:
        moments = np.sort(generator.choice(np.arange(1, count - 1), 4, replace=False)) / RATE_HZ
        start_s, exertion_s, peak_s, end_s = (float(moment) for moment in moments)
        attempts = (Attempt(f"action{seed}", "right", start_s, exertion_s, peak_s, end_s),)
    tracks = generator.normal(size=(2, count, 3))
    tracks[:, : int(generator.integers(0, count - 2))] = np.nan
    things = (Thing("basketball", tracks[0], tracks[1]),) if seed % 2 else ()
    return Motion(path, turned, generator.random((count, len(CONTACTS))) < 0.5, attempts, things)


def acts_of(motions: list[Motion]) -> list[Act]:
    def act_of(motion: Motion) -> Act:
        return lambda _: motion

    return [act_of(motion) for motion in motions]


def difference(one: Pose, other: Pose) -> float:
    """Largest of metres and radians."""
    first, second = rotations.matrices(one.rotations_rad), rotations.matrices(other.rotations_rad)
    turned = np.linalg.norm(rotations.vectors(first.swapaxes(-1, -2) @ second), axis=-1)
    return float(max(np.abs(one.translation_m - other.translation_m).max(), turned.max()))


def joints_m(motion: Motion) -> Float:
    """(T, 24, 3) of a figure whose bones are all (0.1, 0.2, 0.3)."""
    turns = rotations.matrices(motion.rotations_rad)
    joints = np.zeros((*turns.shape[:2], 3))
    joints[:, 0] = motion.translations_m
    for joint, parent in enumerate(smpl.PARENTS[1:], start=1):
        turns[:, joint] = turns[:, parent] @ turns[:, joint]
        joints[:, joint] = joints[:, parent] + turns[:, parent] @ np.array((0.1, 0.2, 0.3))
    return joints


@few
@given(seed=seeds, at=places)
def test_placing_is_rigid(seed: int, at: Standpoint) -> None:
    motion = some_motion(seed)
    placed = at.motion(motion)
    points = np.concatenate((joints_m(motion), *(thing.translations_m[:, None] for thing in motion.things)), axis=1)
    moved = np.concatenate((joints_m(placed), *(thing.translations_m[:, None] for thing in placed.things)), axis=1)
    np.testing.assert_allclose(moved, at.place_m + points @ at.turn.T, atol=1e-9)
    np.testing.assert_array_equal(placed.contacts, motion.contacts)
    assert placed.attempts == motion.attempts
    for thing, own in zip(placed.things, motion.things, strict=True):
        np.testing.assert_array_equal(np.isnan(thing.rotations_rad), np.isnan(own.rotations_rad))


@few
@given(seed=seeds, first=places, second=places)
def test_placing_twice_is_placing_once(seed: int, first: Standpoint, second: Standpoint) -> None:
    motion = some_motion(seed)
    once, twice = second.of(first).motion(motion), second.motion(first.motion(motion))
    assert max(difference(once.pose(number), twice.pose(number)) for number in range(len(once.times_s))) < 1e-8


@settings(max_examples=30)
@given(inner=places, outer=places)
def test_a_frame_and_its_inverse_undo_one_another(inner: Standpoint, outer: Standpoint) -> None:
    back = outer.of(inner.within(outer))
    assert (back.x_m, back.y_m) == pytest.approx((inner.x_m, inner.y_m), abs=1e-9)
    assert np.cos(back.heading_rad - inner.heading_rad) == pytest.approx(1.0)


@few
@given(numbers=st.lists(seeds, min_size=1, max_size=5), start=places)
def test_no_pose_jumps_at_a_seam(numbers: list[int], start: Standpoint) -> None:
    whole = Sequence(acts_of([some_motion(number) for number in numbers]), start)
    assert difference(whole.pose_at(0.0), start.pose(BEGINNING)) < 1e-9
    for seam in whole.seams_s[1:]:
        assert difference(whole.pose_at(seam - 1e-7), whole.pose_at(seam)) < 1e-4
    last = whole.pose_at(whole.duration_s)
    assert difference(last, whole.end.pose(BEGINNING)) < 1e-9
    assert difference(standpoint_of(last).pose(BEGINNING), last) < 1e-9


@few
@given(numbers=st.lists(seeds, min_size=1, max_size=5), start=places, share=st.floats(0, 1))
def test_every_act_is_performed_as_it_is_where_the_last_one_ended(numbers: list[int], start: Standpoint, share: float) -> None:
    motions = [some_motion(number) for number in numbers]
    whole = Sequence(acts_of(motions), start)
    assert whole.duration_s == pytest.approx(sum(motion.duration_s for motion in motions))
    at = start
    for motion, begins in zip(motions, whole.seams_s, strict=True):
        inner = share * motion.duration_s * (1 - 1e-9)
        assert difference(whole.pose_at(begins + inner), at.pose(motion.pose_at(inner))) < 1e-6
        at = at.of(standpoint_of(motion.pose(len(motion.times_s) - 1)))


@few
@given(numbers=st.lists(seeds, min_size=1, max_size=6), start=places)
def test_attempts_keep_their_order_lengths_and_poses(numbers: list[int], start: Standpoint) -> None:
    motions = [some_motion(number) for number in numbers]
    whole = Sequence(acts_of(motions), start)
    own = [(attempt, motion) for motion in motions for attempt in motion.attempts]
    assert [attempt.action for attempt in whole.attempts] == [attempt.action for attempt, _ in own]
    for earlier, later in zip(whole.attempts, whole.attempts[1:], strict=False):
        assert earlier.end_s <= later.start_s
    for found, (attempt, motion) in zip(whole.attempts, own, strict=True):
        assert found.end_s - found.start_s == pytest.approx(attempt.end_s - attempt.start_s)
        pelvis = whole.pose_at(found.peak_s).rotations_rad[1:]
        np.testing.assert_allclose(pelvis, motion.pose_at(attempt.peak_s).rotations_rad[1:], atol=1e-5)


@few
@given(numbers=st.lists(seeds, min_size=1, max_size=5), start=places, cut=st.tuples(st.floats(0, 1), st.floats(0, 1)))
def test_a_window_is_what_the_sequence_does_then(numbers: list[int], start: Standpoint, cut: tuple[float, float]) -> None:
    motions = [some_motion(number) for number in numbers]
    whole = Sequence(acts_of(motions), start)
    begin_s, end_s = sorted(share * whole.duration_s for share in cut)
    if round(begin_s * RATE_HZ) == round(end_s * RATE_HZ):
        with pytest.raises(ValueError, match="has no window"):
            whole.window(begin_s, end_s)
        return
    window, first = whole.window(begin_s, end_s), round(begin_s * RATE_HZ)
    for number in range(0, len(window.times_s), 7):
        at_s = min((first + number) / RATE_HZ, whole.duration_s)
        assert difference(window.pose(number), whole.pose_at(at_s)) < 1e-6
        if at_s not in whole.seams_s:
            act = int(np.searchsorted(whole.seams_s, at_s)) - 1
            bears = motions[act].contacts[round((at_s - whole.seams_s[act]) * RATE_HZ)]
            np.testing.assert_array_equal(window.contacts[number], bears)
    for attempt in window.attempts:
        assert attempt.start_s >= 0
        assert attempt.end_s <= window.duration_s + 1e-9
        assert attempt.action in {other.action for other in whole.attempts}
    assert len(window.things) <= 1  # all basketballs are one


@few
@given(numbers=st.lists(seeds, min_size=2, max_size=5))
def test_what_is_forgotten_is_performed_again_and_is_the_same(numbers: list[int]) -> None:
    acts = acts_of([some_motion(number) for number in numbers])
    kept = Sequence(acts).motion()
    with patch.object(sequence, "KEPT_POSES", 10):
        forgetful = Sequence(acts)
        again = forgetful.motion()
        assert forgetful.kept_poses < 61  # one act
    np.testing.assert_array_equal(kept.translations_m, again.translations_m)
    np.testing.assert_array_equal(kept.rotations_rad, again.rotations_rad)
    np.testing.assert_array_equal(kept.contacts, again.contacts)


def test_things_are_carried_along_and_are_not_there_in_between() -> None:
    with_ball, without = some_motion(1), some_motion(2)
    whole = Sequence(acts_of([with_ball, without, with_ball])).motion()
    (ball,) = whole.things
    there = np.isfinite(ball.translations_m[:, 0])
    count = len(with_ball.times_s)
    assert there[:count].sum() == np.isfinite(with_ball.things[0].translations_m[:, 0]).sum()
    assert not there[count : count + len(without.times_s) - 2].any()
    assert there[-1]
    np.testing.assert_allclose(
        ball.translations_m[:count][there[:count]], with_ball.things[0].translations_m[there[:count]], atol=1e-9
    )


def test_an_act_that_begins_in_another_pose_is_refused() -> None:
    good = some_motion(3)
    bent = good.rotations_rad.copy()
    bent[0, smpl.INDEX["left_knee"], 1] += 0.2
    bad = Motion(good.translations_m, bent, good.contacts)
    with pytest.raises(ValueError, match=r"act 1 does not begin as the one before it ends: .* left_knee by 1\d\.\d degrees"):
        Sequence(acts_of([good, bad]))


def test_a_sequence_of_nothing_and_times_outside_are_refused() -> None:
    with pytest.raises(ValueError, match="at least one act"):
        Sequence([])
    whole = Sequence(acts_of([some_motion(4)]))
    for at_s in (-0.1, whole.duration_s + 0.1, float("nan")):
        with pytest.raises(ValueError, match="poses from 0 to"):
            whole.pose_at(at_s)
