"""Attempts in a stream: found once each, as they end, by either side; and nothing is found where there is none."""

import numpy as np
import pytest

from models.arrays import Float
from models.motions.actions.library import ACTIONS
from models.motions.motion import Handed
from models.skeleton import coco
from models.teaching.standard import FRAME_S, Exemplar, Standard
from services.evaluation.attempt import FoundAttempt
from services.evaluation.attempts import AttemptFinder
from services.evaluation.features import Features, features_of
from services.evaluation.keyframes import refine
from services.evaluation.normalise import mirrored
from services.evaluation.track import known_track
from tests.bench.teaching.finding import shipped

ASIDE = ("basketball_shot", "badminton_clear", "volleyball_spike", "soccer_kick", "run", "cartwheel")
"""Actions that one side leads."""
WAIT = 45
NEAR_S = 3 / 30 + 1e-9


def standards(but_last: bool = True) -> list[Standard]:
    """The shipped ones, without the exemplar that the tests perform."""
    return [
        Standard(one.action, one.version, one.origin, one.performance, one.spread_m, one.stature_m, one.exemplars[:-1])
        if but_last
        else one
        for one in shipped()
    ]


def performed(action: str) -> Exemplar:
    """What the finder does not know: a grown-up, a little slow."""
    return next(one.exemplars[-1] for one in shipped() if one.action == action)


def stream(*exemplars: Exemplar, seed: int = 0) -> tuple[Float, list[tuple[float, ...]]]:
    """(T, 17, 3) performances with a wait before, between and after them, and their true moments; a centimetre of noise."""
    parts, moments, count, at = [], [], 0, np.zeros(3)
    for exemplar in exemplars:
        joints = exemplar.joints_m + at
        parts += [np.repeat(joints[:1], WAIT, axis=0), joints]
        moments.append(tuple((count + WAIT) * FRAME_S + moment_s for moment_s in exemplar.moments_s))
        count += WAIT + len(joints)
        hips = joints[-1, 11:13].mean(axis=0) - exemplar.joints_m[0, 11:13].mean(axis=0)
        at = np.array((hips[0], hips[1], 0.0))
    parts.append(np.repeat(parts[-1][-1:], WAIT, axis=0))
    joints = np.concatenate(parts)
    return joints + np.random.default_rng(seed).normal(0, 0.006, joints.shape), moments


def stretched(joints_m: Float, count: int) -> Float:
    """(count, 17, 3) the same motion at another tempo."""
    at = np.linspace(0, len(joints_m) - 1, count)
    columns = joints_m.reshape(len(joints_m), -1).T
    return np.stack([np.interp(at, range(len(joints_m)), column) for column in columns], axis=1).reshape(count, *joints_m.shape[1:])


def found(finder: AttemptFinder, joints_m: Float) -> list[tuple[FoundAttempt, float]]:
    """Attempts, and when they were decided on."""
    decided = []
    for number, frame in enumerate(joints_m):
        attempt = finder.push(frame, number * FRAME_S)
        if attempt is not None:
            decided.append((attempt, number * FRAME_S))
    return decided


@pytest.fixture(scope="module")
def finder() -> AttemptFinder:
    return AttemptFinder(standards())


@pytest.mark.parametrize("handed", ["right", "left"])
@pytest.mark.parametrize("action", list(ACTIONS))
def test_an_attempt_is_found_once_soon_after_its_end_with_its_side_and_keyframes(
    finder: AttemptFinder, action: str, handed: Handed
) -> None:
    joints, (moments,) = stream(performed(action))
    finder.choose(None)
    finder.reset()
    ((attempt, decided_s),) = found(finder, joints if handed == "right" else mirrored(joints))
    assert attempt.action == action
    assert attempt.handed == (handed if action in ASIDE else "right")
    assert np.abs(np.array(attempt.moments_s) - moments).max() <= NEAR_S
    assert decided_s - moments[-1] <= 0.65


def test_several_in_a_row_are_found_each_for_itself(finder: AttemptFinder) -> None:
    actions = ["squat", "soccer_kick", "squat", "star_jump", "cartwheel"]
    joints, moments = stream(*map(performed, actions))
    finder.reset()
    attempts = [attempt for attempt, _ in found(finder, joints)]
    assert [attempt.action for attempt in attempts] == actions
    for attempt, true in zip(attempts, moments, strict=True):
        assert np.abs(np.array(attempt.moments_s) - true).max() <= NEAR_S


def test_only_what_was_chosen_is_looked_for(finder: AttemptFinder) -> None:
    joints, _ = stream(performed("squat"), performed("star_jump"), performed("soccer_kick"))
    finder.reset()
    finder.choose("star_jump")
    assert [attempt.action for attempt, _ in found(finder, joints)] == ["star_jump"]
    finder.choose(None)
    with pytest.raises(ValueError, match="no standard of 'handstand'"):
        finder.choose("handstand")


def test_a_choice_tells_of_the_attempt_that_was_waited_for_and_the_same_one_again_changes_nothing(finder: AttemptFinder) -> None:
    joints, (moments,) = stream(performed("squat"))
    over = round(moments[-1] / FRAME_S) + 4
    finder.choose(None)
    finder.reset()
    assert not found(finder, joints[:over])
    waited_for = finder.finish()
    assert waited_for is not None
    assert waited_for.action == "squat"
    assert finder.finish() is None
    finder.reset()
    assert not found(finder, joints[:over])
    finder.choose(None)
    waited_for = finder.finish()
    assert waited_for is not None
    assert waited_for.action == "squat"


def test_what_was_performed_before_it_was_chosen_is_not_told_as_chosen(finder: AttemptFinder) -> None:
    before, _ = stream(performed("squat"))
    after, _ = stream(performed("squat"))
    finder.choose("soccer_kick")
    finder.reset()
    assert not found(finder, before)
    finder.choose("squat")
    attempts = [finder.push(joints, (len(before) + number) * FRAME_S) for number, joints in enumerate(after)]
    (attempt,) = [attempt for attempt in attempts if attempt is not None]
    assert attempt.moments_s[0] > len(before) * FRAME_S
    finder.choose(None)


def test_an_attempt_with_which_the_stream_begins_is_found(finder: AttemptFinder) -> None:
    joints, (moments,) = stream(performed("soccer_kick"))
    finder.choose(None)
    finder.reset()
    ((attempt, _),) = found(finder, joints[round(moments[0] / FRAME_S) :])
    assert attempt.action == "soccer_kick"


def test_a_movement_as_slow_as_counts_is_found_though_it_takes_half_a_minute() -> None:
    squat = performed("squat")
    joints = stretched(squat.joints_m, round(18.0 / FRAME_S))
    share = (len(joints) - 1) / (len(squat.joints_m) - 1)
    start, exertion, peak, end = (share * moment_s for moment_s in squat.moments_s)
    unknown = np.full(joints.shape[:2], np.nan)
    slow = Standard("squat", 1, "made for this test", Exemplar(joints, (start, exertion, peak, end)), unknown, 1.6)
    slower = stretched(joints, round(1.6 * len(joints)))
    performance = np.concatenate((np.repeat(slower[:1], WAIT, axis=0), slower, np.repeat(slower[-1:], WAIT, axis=0)))
    attempts = [attempt.action for attempt, _ in found(AttemptFinder((slow,)), performance)]
    assert "squat" in attempts


def test_a_child_after_a_grown_up_is_measured_anew() -> None:
    joints, (moments,) = stream(performed("star_jump"))
    nobody = np.full((round(1.5 / FRAME_S), *joints.shape[1:]), np.nan)
    grown_up = 1.5 * joints[:60]
    alone = features_of(joints, FRAME_S)
    features = Features(FRAME_S)
    for frame in (*grown_up, *nobody):
        features.push(frame)
    after = np.stack([features.push(frame) for frame in joints])
    jump = slice(round(moments[0] / FRAME_S), round(moments[-1] / FRAME_S))
    np.testing.assert_allclose(after[jump], alone[jump], atol=0.05)


def test_an_attempt_with_a_gap_and_an_unseen_arm_is_found(finder: AttemptFinder) -> None:
    joints, _ = stream(performed("long_jump"))
    joints[WAIT + 30 : WAIT + 37] = np.nan
    joints[:, [7, 9]] = np.nan
    finder.reset()
    assert [attempt.action for attempt, _ in found(finder, joints)] == ["long_jump"]


def test_an_attempt_whose_keyframes_cannot_be_seen_has_them_where_the_standard_has(finder: AttemptFinder) -> None:
    joints, (moments,) = stream(performed("squat"))
    finder.choose(None)
    finder.reset()
    ((seen, _),) = found(finder, joints)
    joints[1:, [coco.INDEX["left_ankle"], coco.INDEX["right_ankle"]]] = np.nan
    finder.reset()
    ((attempt, _),) = found(finder, joints)
    assert (attempt.action, seen.timed, attempt.timed) == ("squat", True, False)
    assert np.abs(np.array(attempt.moments_s) - moments).max() < 0.4


def test_what_is_hardly_seen_is_no_attempt(finder: AttemptFinder) -> None:
    joints, _ = stream(performed("squat"))
    hidden = joints.copy()
    hidden[WAIT + 10 : -WAIT - 10] = np.nan
    unseen = np.full_like(joints, np.nan)
    only_legs = joints.copy()
    only_legs[:, :11] = np.nan
    for nothing in (hidden, unseen, only_legs):
        finder.reset()
        assert not found(finder, nothing)


def test_waiting_and_the_same_half_again_and_again_are_no_attempts(finder: AttemptFinder) -> None:
    still = np.repeat(performed("squat").joints_m[:1], 300, axis=0) + np.random.default_rng(1).normal(0, 0.01, (300, 17, 3))
    joints, _ = stream(performed("star_jump"))
    looping = np.tile(joints[WAIT : WAIT + 25], (12, 1, 1))
    for nothing in (still, looping):
        finder.reset()
        assert not found(finder, nothing)


def test_half_an_attempt_before_the_stream_begins_anew_does_not_count(finder: AttemptFinder) -> None:
    joints, _ = stream(performed("forward_roll"))
    half = len(joints) // 2
    finder.reset()
    assert not found(finder, joints[:half])
    finder.reset()
    assert not found(finder, joints[half:])


def test_who_moves_is_told_from_who_waits(finder: AttemptFinder) -> None:
    joints, (moments,) = stream(performed("run"))
    finder.reset()
    states = []
    for number, frame in enumerate(joints):
        finder.push(frame, number * FRAME_S)
        states.append(finder.state)
    assert set(states[10:WAIT]) == {"waiting"}
    assert states[round(moments[2] / FRAME_S)] == "moving"
    assert states[-1] == "waiting"


def test_an_attempt_that_was_found_roughly_is_put_right() -> None:
    joints, (moments,) = stream(performed("volleyball_spike"))
    rough = FoundAttempt("volleyball_spike", "left", tuple(moment + 0.15 for moment in moments))  # type: ignore[arg-type]
    refined = refine(known_track(mirrored(joints), FRAME_S), rough, standards())
    assert np.abs(np.array(refined.moments_s) - moments).max() <= NEAR_S


def test_an_attempt_of_which_nothing_is_known_stays_as_it_was_found() -> None:
    joints, (moments,) = stream(performed("squat"))
    rough = FoundAttempt("squat", "right", moments)  # type: ignore[arg-type]
    unseen = known_track(np.full_like(joints, np.nan), FRAME_S)
    assert refine(unseen, rough, standards()) == rough
    assert refine(known_track(joints, FRAME_S), rough, []) == rough
    assert refine(known_track(joints[:1], FRAME_S), rough, standards()) == rough
    assert refine(known_track(joints[:0], FRAME_S), rough, standards()) == rough


def test_a_standard_of_somebody_who_does_not_move_finds_nothing() -> None:
    still = Exemplar(np.repeat(performed("squat").joints_m[:1], 60, axis=0), (0.2, 0.6, 1.0, 1.8))
    statue = Standard("statue", 1, "a test", still, np.zeros((60, 17)), 1.5)
    joints, _ = stream(performed("squat"))
    finder = AttemptFinder([statue, *standards()])
    assert [attempt.action for attempt, _ in found(finder, joints)] == ["squat"]
