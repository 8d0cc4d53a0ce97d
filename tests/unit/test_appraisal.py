"""One attempt judged: what is known is said alike whoever performs it and wherever, and what is not known is grey."""

import math
from dataclasses import replace

import numpy as np
import pytest

from models.messages import codec
from models.messages.feedback import Colour, Feedback
from models.messages.motion import JointState
from models.motions.actions.library import ACTIONS
from models.motions.motion import Handed
from models.skeleton import coco
from services.evaluation.appraisal import FAIR_SHARE, Moments, appraise, verdict_of
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.measured import Measured
from services.evaluation.track import Track
from tests.taught import performance, shipped

NOW_NS = 10**15
HARDLY_SEEN = {"run", "cartwheel"}
"""An overstride may have been one, by 28 %; bent arms are upside down: "What stays weak" in docs/teaching.md."""


def judged(track: Track, attempt: FoundAttempt, speed: float = 1.0) -> Feedback:
    moments = Moments(float(track.t_s[-1]), NOW_NS, 3, speed)
    feedback = appraise(track, attempt, "chosen", moments, shipped())
    return codec.decode(codec.encode(feedback), Feedback)  # whatever is said can be sent


@pytest.mark.parametrize("handed", ["right", "left"])
@pytest.mark.parametrize("action", ACTIONS)
def test_the_standard_itself_is_green_wherever_it_is_performed_and_with_either_side(action: str, handed: Handed) -> None:
    feedback = judged(*performance(action, handed))
    assert (feedback.action, feedback.handed, feedback.epoch) == (action, handed, 3)
    assert (feedback.colours == Colour.GREEN).mean() > 0.95
    assert not (feedback.colours == Colour.RED).any()
    assert feedback.score is not None
    assert feedback.score > 85
    assert feedback.cue == ""
    assert feedback.silence == ("unsure" if action in HARDLY_SEEN else "fine")
    beside = np.linalg.norm(feedback.standard_m - feedback.joints_m, axis=2)
    assert np.nanmax(beside) < 0.02


@pytest.mark.parametrize("number", [1, 3])
def test_the_standard_has_the_pupils_size_and_stands_where_he_is(number: int) -> None:
    track, attempt = performance("basketball_shot", "left", number)
    feedback = judged(track, attempt)
    hips = [coco.INDEX["left_hip"], coco.INDEX["right_hip"]]
    ours, theirs = (joints[:, hips, :2].mean(axis=1) for joints in (feedback.joints_m, feedback.standard_m))
    assert theirs == pytest.approx(ours, abs=1e-3)
    shank = [
        np.linalg.norm(j[:, coco.INDEX["left_knee"]] - j[:, coco.INDEX["left_ankle"]], axis=1).mean()
        for j in (feedback.joints_m, feedback.standard_m)
    ]
    assert shank[1] == pytest.approx(shank[0], rel=0.08)
    assert np.linalg.norm(feedback.standard_m - feedback.joints_m, axis=2).mean() < 0.1


def test_a_joint_that_was_not_seen_is_grey_and_says_nothing() -> None:
    track, attempt = performance("basketball_shot")
    states = track.states.copy()
    wrist, ankle = coco.INDEX["right_wrist"], coco.INDEX["left_ankle"]
    states[:, wrist] = JointState.GUESSED
    joints_m, covariance_m2 = track.joints_m.copy(), track.covariance_m2.copy()
    states[:, ankle], joints_m[:, ankle], covariance_m2[:, ankle] = JointState.UNKNOWN, np.nan, np.nan
    feedback = judged(Track(track.t_s, joints_m, covariance_m2, states), attempt)
    assert (feedback.colours[:, [wrist, ankle]] == Colour.GREY).all()
    assert (np.delete(feedback.colours, [wrist, ankle], axis=1) == Colour.GREEN).mean() > 0.9
    assert feedback.silence == "unseen"
    assert (feedback.joints_m[:, ankle] == 0).all()
    hand = next(measure for measure in feedback.measures if measure.name == "hand_height")
    assert hand.verdict == "unknown"
    assert hand.value is None


def test_where_a_fault_was_not_judged_silence_is_no_approval_however_good_all_else_is() -> None:
    track, attempt = performance("basketball_shot")
    states, joints_m, covariance_m2 = track.states.copy(), track.joints_m.copy(), track.covariance_m2.copy()
    ankle = coco.INDEX["left_ankle"]
    states[:, ankle], joints_m[:, ankle], covariance_m2[:, ankle] = JointState.UNKNOWN, np.nan, np.nan
    feedback = judged(Track(track.t_s, joints_m, covariance_m2, states), attempt)
    assert [judgement.fault for judgement in feedback.judgements if not judgement.known] == ["no_knee_bend"]
    assert feedback.score is not None
    assert feedback.score > 85
    assert (feedback.cue, feedback.silence) == ("", "unsure")


def test_of_somebody_who_is_not_seen_at_all_nothing_is_said() -> None:
    track, attempt = performance("squat")
    nobody = Track(
        track.t_s,
        np.full_like(track.joints_m, np.nan),
        np.full_like(track.covariance_m2, np.nan),
        np.full_like(track.states, JointState.UNKNOWN),
    )
    feedback = judged(nobody, attempt)
    assert (feedback.score, feedback.cue, feedback.praise) == (None, "", "")
    assert feedback.silence == "unseen"
    assert {measure.verdict for measure in feedback.measures} == {"unknown"}
    assert not any(judgement.known for judgement in feedback.judgements)
    assert (feedback.colours == Colour.GREY).all()
    assert np.isnan(feedback.standard_m).all()


def test_by_keyframes_that_were_not_seen_nothing_is_measured_or_coloured_and_the_pupil_is_shown() -> None:
    track, attempt = performance("squat")
    feedback = judged(track, replace(attempt, timed=False))
    assert (feedback.score, feedback.cue, feedback.praise) == (None, "", "")
    assert {measure.verdict for measure in feedback.measures} == {"unknown"}
    assert not any(judgement.known for judgement in feedback.judgements)
    assert (feedback.colours == Colour.GREY).all()
    assert np.isnan(feedback.standard_m).all()
    assert (feedback.states == JointState.SEEN).all()


def test_a_keyframe_around_which_nobody_saw_the_pupil_is_told() -> None:
    track, attempt = performance("squat")
    hidden = np.abs(track.t_s - attempt.moment_s("peak")) <= 0.15
    states, joints_m, covariance_m2 = track.states.copy(), track.joints_m.copy(), track.covariance_m2.copy()
    states[hidden], joints_m[hidden], covariance_m2[hidden] = JointState.UNKNOWN, np.nan, np.nan
    assert judged(track, attempt).keyframes_unseen == ()
    assert judged(Track(track.t_s, joints_m, covariance_m2, states), attempt).keyframes_unseen == ("peak",)
    assert judged(track, replace(attempt, timed=False)).keyframes_unseen == ("start", "exertion", "peak", "end")


def test_joints_that_are_known_too_badly_are_grey() -> None:
    track, attempt = performance("squat")
    vague = Track(track.t_s, track.joints_m, track.covariance_m2 + 0.25 * np.eye(3), track.states)
    feedback = judged(vague, attempt)
    assert (feedback.colours == Colour.GREY).all()
    assert feedback.cue == ""


def test_keyframes_are_on_the_boxs_clock_and_within_the_frames() -> None:
    track, attempt = performance("long_jump")
    feedback = judged(track, attempt)
    ages_s = [(NOW_NS - t_ns) * 1e-9 for t_ns in feedback.keyframes_ns]
    assert ages_s == pytest.approx([float(track.t_s[-1]) - moment_s for moment_s in attempt.moments_s], abs=1e-6)
    assert feedback.id == feedback.keyframes_ns[-1] // 10**6
    assert feedback.frame_of(feedback.keyframes_ns[0]) == round((attempt.moments_s[0] - track.t_s[0]) * 30)


def test_in_a_replay_at_half_speed_an_attempt_lasts_as_long_as_it_did() -> None:
    track, attempt = performance("long_jump")
    feedback = judged(track, attempt, speed=0.5)
    start_s, end_s = attempt.moments_s[0], attempt.moments_s[-1]
    assert (NOW_NS - feedback.keyframes_ns[-1]) * 1e-9 == pytest.approx((float(track.t_s[-1]) - end_s) / 0.5, abs=1e-6)
    assert (feedback.keyframes_ns[-1] - feedback.keyframes_ns[0]) * 1e-9 == pytest.approx(end_s - start_s, abs=1e-6)


def test_an_attempt_before_the_clock_began_is_judged_all_the_same() -> None:
    track, attempt = performance("squat")
    feedback = appraise(track, attempt, "chosen", Moments(float(track.t_s[-1]), 0, 0), shipped())
    assert feedback.t_first_ns == 0
    assert list(feedback.keyframes_ns) == sorted(set(feedback.keyframes_ns))


def test_an_attempt_of_which_but_a_piece_is_there_is_judged_on_that() -> None:
    track, attempt = performance("squat")
    judged(track.part(20, len(track)), attempt)
    for first, end in ((20, 22), (len(track) - 2, len(track)), (0, 2)):
        feedback = judged(track.part(first, end), attempt)
        assert (feedback.score, feedback.cue, feedback.praise) == (None, "", "")
    with pytest.raises(ValueError, match="of 1 frames has 1"):
        judged(track.part(20, 21), attempt)


@pytest.mark.parametrize(
    ("value", "sigma", "verdict"),
    [
        (15.0, 1.0, "good"),
        (20.5, 1.0, "fair"),
        (21.0 + FAIR_SHARE * 10.0, 1.0, "fair"),
        (21.5 + FAIR_SHARE * 10.0, 1.0, "poor"),
        (6.0, 1.0, "poor"),
        (15.0, 5.1, "unknown"),
        (90.0, 5.1, "unknown"),
    ],
)
def test_a_measure_is_judged_in_the_pupils_favour_and_not_at_all_if_it_may_be_anything(
    value: float, sigma: float, verdict: str
) -> None:
    assert verdict_of(Measured("a", value, sigma, "deg", known=True), 10.0, 20.0) == verdict


def test_a_measure_that_is_not_known_has_no_verdict() -> None:
    assert verdict_of(Measured("a", math.nan, math.nan, "deg", known=False), 10.0, 20.0) == "unknown"
    assert verdict_of(Measured("a", 15.0, 1.0, "deg", known=False), 10.0, 20.0) == "unknown"
