"""Standards that are made of a pupil's performance: whole, found again, fair to others; and what can be none."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from models.messages.feedback import Colour, Feedback
from models.messages.motion import JointState
from models.motions.motion import Handed
from models.skeleton import coco
from models.teaching.showing import PerformanceError
from models.teaching.standard import FRAME_S, Exemplar, Standard, decode, encode
from services.evaluation.appraisal import Moments, appraise
from services.evaluation.attempt import FoundAttempt
from services.evaluation.attempts import AttemptFinder
from services.evaluation.config import EvaluationConfig
from services.evaluation.new_standard import standard_of
from services.evaluation.normalise import facing, mirrored, root_m
from services.evaluation.search import attempts_in, leading_side
from services.evaluation.track import Track, known_track
from tests.demonstrations import hidden, shown
from tests.pupils import pupil
from tests.taught import placed, shipped, some

pytestmark = pytest.mark.slow

SIDED = ("badminton_clear", "soccer_kick", "cartwheel")
ALL = tuple(shipped().standards)
WAIT = 30


@cache
def made(action: str, handed: Handed = "right", seed: int = 1) -> Standard:
    track, attempt = shown(action, handed, seed=seed)
    return standard_of(track, attempt, shipped().standards[action], "shown by a pupil of 13")


def taught_by(standard: Standard) -> EvaluationConfig:
    """What is taught where a school has recorded this one."""
    read = decode(encode(standard), "own")
    return EvaluationConfig({read.action: shipped().teachings[read.action]}, {read.action: read})


def judged(track: Track, attempt: FoundAttempt, config: EvaluationConfig) -> Feedback:
    return appraise(track, attempt, "chosen", Moments(float(track.t_s[-1]), 10**12, 0), config)


def shares(feedback: Feedback) -> dict[Colour, float]:
    return {colour: float((feedback.colours == colour).mean()) for colour in Colour}


def copied(standard: Standard, handed: Handed = "right", size: float = 1.0) -> tuple[Track, FoundAttempt]:
    """Somebody of another size does exactly what the standard shows, elsewhere in the room."""
    joints = placed(size * standard.joints_m, handed)
    waiting = np.concatenate([np.repeat(joints[:1], WAIT, axis=0), joints, np.repeat(joints[-1:], WAIT, axis=0)])
    start, exertion, peak, end = (moment_s + WAIT * FRAME_S for moment_s in standard.moments_s)
    return known_track(waiting, FRAME_S, 0.008), FoundAttempt(standard.action, handed, (start, exertion, peak, end))


@pytest.mark.parametrize("action", ALL)
def test_a_performance_becomes_a_standard_in_the_canonical_frame_with_its_keyframes_and_size(action: str) -> None:
    track, attempt = shown(action)
    standard = made(action)
    np.testing.assert_allclose(root_m(standard.joints_m)[0, :2], 0.0, atol=1e-9)
    np.testing.assert_allclose(facing(standard.joints_m)[0], (1.0, 0.0), atol=0.1)
    np.testing.assert_allclose(np.diff(standard.moments_s), np.diff(attempt.moments_s), atol=1e-9)
    assert standard.moments_s[0] == pytest.approx(0.2, abs=FRAME_S)
    first = round(track.frame_at(attempt.moments_s[0]) - standard.moments_s[0] / FRAME_S)
    np.testing.assert_allclose(standard.joints_m[..., 2], track.joints_m[first : first + len(standard.joints_m), :, 2], atol=1e-9)
    assert standard.stature_m == pytest.approx(pupil(13.0).body.stature_m, abs=0.05)
    assert len(standard.exemplars) == 7
    assert standard.spread_m.shape == standard.joints_m.shape[:2]
    assert 0.5 < np.nanmedian(standard.spread_m) / np.nanmedian(shipped().standards[action].spread_m) < 2
    again = decode(encode(standard), "own")
    np.testing.assert_allclose(again.joints_m, standard.joints_m, atol=3e-4)


@pytest.mark.parametrize("action", SIDED)
def test_of_a_left_handed_pupil_the_mirror_image_is_the_standard(action: str) -> None:
    track, attempt = shown(action, "left")
    standard = made(action, "left")
    mirror = known_track(mirrored(track.joints_m), FRAME_S, 0.008)
    right = standard_of(mirror, replace(attempt, handed="right"), shipped().standards[action], "")
    np.testing.assert_allclose(standard.joints_m, right.joints_m, atol=1e-9)


@pytest.mark.parametrize("handed", ["right", "left"])
@pytest.mark.parametrize("size", [0.75, 1.15])
def test_who_copies_the_standard_of_a_left_handed_pupil_is_green(handed: Handed, size: float) -> None:
    standard = made("badminton_clear", "left")
    config = taught_by(standard)
    track, true = copied(standard, handed, size)
    (found,) = attempts_in(track, config.standards["badminton_clear"])
    assert found.handed == handed
    np.testing.assert_allclose(found.moments_s, true.moments_s, atol=0.07)
    share = shares(judged(track, found, config))
    assert share[Colour.GREEN] > 0.97
    assert share[Colour.RED] == share[Colour.GREY] == 0


def test_others_who_do_it_well_are_mostly_green_and_who_does_something_else_is_not() -> None:
    config = taught_by(made("badminton_clear", "left"))
    track, attempt = shown("badminton_clear", "right", years=11.0, tempo=1.15, seed=7)
    assert shares(judged(track, attempt, config))[Colour.GREEN] > 0.8
    wrong = track.joints_m.copy()
    shoulder, elbow, wrist = (coco.INDEX[f"right_{part}"] for part in ("shoulder", "elbow", "wrist"))
    wrong[:, elbow], wrong[:, wrist] = wrong[:, shoulder] - (0.0, 0.0, 0.25), wrong[:, shoulder] - (0.0, 0.0, 0.5)
    feedback = judged(replace(track, joints_m=wrong), attempt, config)
    peak = round((feedback.keyframes_ns[2] - feedback.t_first_ns) / feedback.frame_ns)
    assert (feedback.colours[peak - 1 : peak + 2, [elbow, wrist]] == Colour.RED).all()


@pytest.mark.parametrize("action", ALL)
def test_attempts_are_found_and_timed_by_a_recorded_standard_as_by_the_shipped_one(action: str) -> None:
    handed: Handed = "left" if action in SIDED else "right"
    config = taught_by(made(action, handed))
    finder = AttemptFinder(tuple({**some(*ALL).standards, **config.standards}.values()))
    for years, tempo, seed in ((8.0, 1.15, 11), (16.0, 0.9, 12), (30.0, 1.0, 13)):
        track, true = shown(action, years=years, tempo=tempo, seed=seed)
        finder.reset()
        found = [finder.push(joints, t_s) for joints, t_s in zip(track.joints_m, track.t_s.tolist(), strict=True)]
        (attempt,) = (one for one in found if one is not None)
        assert (attempt.action, attempt.handed) == (action, "right")
        np.testing.assert_allclose(attempt.moments_s, true.moments_s, atol=0.1 + 1e-9)


@pytest.mark.parametrize("action", ["squat", "star_jump", "long_jump"])
def test_an_action_that_no_side_leads_is_led_by_none_also_when_a_real_pupil_showed_it(action: str) -> None:
    standard = made(action)
    apart = np.abs(standard.joints_m - mirrored(standard.joints_m)).max()
    assert apart > 0.02, "the pupil was too even to prove anything"
    track, _ = shown(action, seed=5)
    finder = AttemptFinder((standard,))
    mirror = mirrored(track.joints_m)
    found = [finder.push(joints, t_s) for joints, t_s in zip(mirror, track.t_s.tolist(), strict=True)]
    assert [one.handed for one in found if one is not None] == ["right"]


def test_the_spread_is_the_bases_at_the_same_keyframes_and_at_the_new_size() -> None:
    base = shipped().standards["squat"]
    track, attempt = shown("squat", years=8.0)
    standard = standard_of(track, attempt, base, "")
    ratio = standard.stature_m / base.stature_m
    assert ratio < 0.95
    for ours_s, theirs_s in zip(standard.moments_s, base.moments_s, strict=True):
        ours, theirs = ours_s / FRAME_S, theirs_s / FRAME_S
        between = [
            np.interp(place, np.arange(len(rows)), rows[:, 9])
            for place, rows in ((ours, standard.spread_m), (theirs, base.spread_m))
        ]
        assert between[0] == pytest.approx(ratio * between[1], rel=0.1)
    unknown = replace(base, spread_m=np.full_like(base.spread_m, np.nan))
    assert np.isnan(standard_of(track, attempt, unknown, "").spread_m).all()


def test_exemplars_are_the_bases_and_do_not_grow() -> None:
    track, attempt = shown("squat")
    base = shipped().standards["squat"]
    first = standard_of(track, attempt, base, "")
    assert first.exemplars == (base.performance, *base.exemplars)
    assert len(standard_of(track, attempt, first, "").exemplars) == len(first.exemplars)


def test_what_is_known_badly_is_unknown_and_the_rest_is_kept() -> None:
    track, attempt = shown("badminton_clear")
    start, exertion, *_ = attempt.moments_s
    few = round((exertion - start) * 0.2 / FRAME_S)
    at, wrist = round(track.frame_at(start)) + 2, coco.INDEX["left_wrist"]
    covariance = track.covariance_m2.copy()
    covariance[at : at + few, wrist] = np.eye(3) * 0.3**2
    vague = Track(track.t_s, track.joints_m, covariance, track.states)
    standard = standard_of(vague, attempt, shipped().standards["badminton_clear"], "")
    unknown = np.asarray(np.isnan(standard.joints_m).any(axis=2))
    assert unknown[:, wrist].sum() == few > 0
    assert unknown.sum() == few
    # Nobody is judged by what is not known, and all else is still green.
    config = taught_by(standard)
    copy, true = copied(made("badminton_clear"))
    share = shares(judged(copy, true, config))
    assert share[Colour.RED] == 0
    assert share[Colour.GREEN] > 0.95


def guessed(track: Track, joint: int, first: int, frames: int) -> Track:
    """The same, with a joint that is surely wrong and sure of itself: of what fusion guessed it keeps the small covariance."""
    rows = slice(first, first + frames)
    joints, covariance, states = track.joints_m.copy(), track.covariance_m2.copy(), track.states.copy()
    joints[rows, joint] += (0.1, 0.0, 0.0)
    covariance[rows, joint] = np.eye(3) * 0.005**2
    states[rows, joint] = JointState.GUESSED
    return Track(track.t_s, joints, covariance, states)


def test_what_was_only_guessed_is_unknown_however_sure_it_is_of_itself() -> None:
    track, attempt = shown("badminton_clear")
    wrist, first = coco.INDEX["left_wrist"], round(track.frame_at(attempt.moments_s[0])) + 2
    base = shipped().standards["badminton_clear"]
    standard = standard_of(guessed(track, wrist, first, 5), attempt, base, "")
    unknown = np.asarray(np.isnan(standard.joints_m).any(axis=2))
    assert (unknown[:, wrist].sum(), unknown.sum()) == (5, 5)
    assert standard.stature_m == pytest.approx(standard_of(track, attempt, base, "").stature_m, abs=0.01)
    phase = round((attempt.moments_s[1] - attempt.moments_s[0]) / FRAME_S)
    with pytest.raises(PerformanceError, match="too little of the left wrist from start to exertion"):
        standard_of(guessed(track, wrist, first, phase), attempt, base, "")


def test_who_was_guessed_to_be_taller_before_and_after_is_as_tall_as_he_was_seen_to_be() -> None:
    track, attempt = shown("squat")
    base = shipped().standards["squat"]
    joints, states = track.joints_m.copy(), track.states.copy()
    first, last = (round(track.frame_at(moment_s)) for moment_s in (attempt.moments_s[0], attempt.moments_s[-1]))
    for around in (slice(first - 8), slice(last + 8, None)):
        joints[around] *= 1.25
        states[around] = JointState.GUESSED
    told = standard_of(Track(track.t_s, joints, track.covariance_m2, states), attempt, base, "").stature_m
    assert told == pytest.approx(standard_of(track, attempt, base, "").stature_m, abs=0.02)


@pytest.mark.parametrize(
    ("joints", "phases", "told"),
    [
        (("right_wrist",), (1, 2), "right wrist from exertion to peak"),
        (("left_knee", "left_ankle"), (0, 1), "left knee and left ankle from start to exertion"),
        (coco.NAMES[5:], (2, 3), "whole body from peak to end"),
    ],
)
def test_a_limb_that_is_hidden_in_a_phase_is_refused_by_its_name_and_phase(
    joints: tuple[str, ...], phases: tuple[int, int], told: str
) -> None:
    track, attempt = shown("basketball_shot")
    unseen = hidden(track, joints, *(attempt.moments_s[phase] for phase in phases))
    with pytest.raises(PerformanceError, match=f"was not seen well enough: too little of the {told}"):
        standard_of(unseen, attempt, shipped().standards["basketball_shot"], "")


def test_of_a_left_handed_pupil_hidden_limbs_are_named_as_the_pupils_own() -> None:
    track, attempt = shown("badminton_clear", "left")
    unseen = hidden(track, ("left_wrist",), *attempt.moments_s[1:3])
    with pytest.raises(PerformanceError, match="too little of the left wrist from"):
        standard_of(unseen, attempt, shipped().standards["badminton_clear"], "")


def test_a_head_that_is_never_seen_is_no_reason_to_refuse_it() -> None:
    track, attempt = shown("soccer_kick")
    headless = hidden(track, coco.NAMES[:5], 0.0, float(track.t_s[-1]))
    standard = standard_of(headless, attempt, shipped().standards["soccer_kick"], "")
    assert standard.stature_m == pytest.approx(made("soccer_kick").stature_m, abs=0.06)
    copy, true = copied(made("soccer_kick"))
    feedback = judged(copy, true, taught_by(standard))
    assert (feedback.colours[:, :5] == Colour.GREY).all()
    assert (feedback.colours[:, 5:] == Colour.GREEN).mean() > 0.95


def test_whose_hip_was_hidden_as_he_began_is_told_so_and_not_that_he_did_not_stand() -> None:
    track, attempt = shown("squat")
    begun_s = attempt.moments_s[0]
    unseen = hidden(track, ("left_hip",), begun_s - 0.3, begun_s + 0.12)
    with pytest.raises(PerformanceError, match=r"^does not show both shoulders and both hips at once in its first 0.3 s"):
        standard_of(unseen, attempt, shipped().standards["squat"], "")


def test_nothing_and_nonsense_are_refused() -> None:
    track, attempt = shown("squat")
    base = shipped().standards["squat"]
    nobody = known_track(np.full_like(track.joints_m, np.nan), FRAME_S)
    still = known_track(np.repeat(track.joints_m[:1], len(track), axis=0), FRAME_S, 0.008)
    giant = known_track(2.0 * track.joints_m, FRAME_S, 0.008)
    flying = known_track(track.joints_m + np.array((0.0, 0.0, 0.9)), FRAME_S, 0.008)
    sunk = known_track(track.joints_m - (0.0, 0.0, 0.2), FRAME_S, 0.008)
    upside_down = known_track(track.joints_m * (1, -1, -1) + (0, 0, 2), FRAME_S, 0.008)
    far = known_track(track.joints_m + np.arange(len(track))[:, None, None] * (0.5, 0.0, 0.0), FRAME_S, 0.008)
    for one, told in (
        (nobody, "too little of the whole body from start to exertion; of the whole body from exertion to peak"),
        (upside_down, "does not show the pupil standing upright"),
        (still, "hardly moves between its keyframes"),
        (giant, "nobody is"),
        (flying, "does not stand on the floor at height 0"),
        (sunk, "does not stand on the floor at height 0"),
        (far, "stays within"),
    ):
        with pytest.raises(PerformanceError, match=told):
            standard_of(one, attempt, base, "")
    long = known_track(np.concatenate([track.joints_m] * 12), FRAME_S, 0.008)
    with pytest.raises(PerformanceError, match="takes longer than the 20 s"):
        standard_of(long, replace(attempt, moments_s=(1.0, 2.0, 3.0, 25.0)), base, "")


def test_an_attempt_at_the_very_ends_of_its_track_becomes_a_standard() -> None:
    track, attempt = shown("basketball_shot")
    first, last = (round(track.frame_at(attempt.moments_s[k])) for k in (0, 3))
    part = track.part(first, last + 1)
    start, end = float(part.t_s[0]), float(part.t_s[-1])
    short = replace(attempt, moments_s=(start, *attempt.moments_s[1:3], end))
    standard = standard_of(part, short, shipped().standards["basketball_shot"], "")
    assert standard.moments_s[0] == 0
    assert len(standard.joints_m) == len(part)


def test_a_file_that_ends_with_the_attempt_holds_it() -> None:
    for action in ("squat", "badminton_clear", "long_jump"):
        track, true = shown(action, seed=4)
        last = round(track.frame_at(true.moments_s[-1]))
        (found,) = attempts_in(track.part(WAIT - 5, last + 2), shipped().standards[action])
        np.testing.assert_allclose(found.moments_s, true.moments_s, atol=0.1 + 1e-9)
        assert attempts_in(track.part(0, WAIT), shipped().standards[action]) == ()


@pytest.mark.parametrize("action", ALL)
def test_the_side_that_leads_is_told_by_the_standard(action: str) -> None:
    track, attempt = shown(action)
    standard = shipped().standards[action]
    assert leading_side(track, attempt.moments_s, standard) == "right"
    mirror = known_track(mirrored(track.joints_m), FRAME_S)
    sides = leading_side(mirror, attempt.moments_s, standard)
    assert sides == ("left" if action in {*SIDED, "basketball_shot", "volleyball_spike", "run"} else "right")
    unknown = known_track(np.full_like(track.joints_m, np.nan), FRAME_S)
    assert leading_side(unknown, attempt.moments_s, standard) == "right"


def test_a_standard_with_unknown_joints_is_looked_for_as_one_without() -> None:
    base = shipped().standards["long_jump"]
    joints = base.joints_m.copy()
    joints[:20, [7, 9]] = np.nan
    performance = Exemplar(joints, base.moments_s)
    partly = replace(base, performance=performance, exemplars=())
    track, true = shown("long_jump", seed=6)
    (found,) = attempts_in(track, partly)
    np.testing.assert_allclose(found.moments_s, true.moments_s, atol=0.2)
