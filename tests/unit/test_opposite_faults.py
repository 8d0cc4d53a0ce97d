"""The opposite of a fault is no good performance: it is not praised, and nobody is told that nothing was wrong."""

from dataclasses import replace

import numpy as np
import pytest
from msgspec import structs

from models.skeleton import coco
from services.evaluation.attempt import FoundAttempt
from services.evaluation.cues import Said, choose
from services.evaluation.faults import judge
from services.evaluation.signals.reading import Reading
from services.evaluation.track import Track
from tests.taught import performance, shipped


def said_of(fault: str, track: Track, attempt: FoundAttempt) -> Said:
    """By a file that looks for this fault alone."""
    whole = shipped().teachings[attempt.action]
    only = structs.replace(whole, fault=tuple(one for one in whole.fault if one.name == fault))
    return choose(only, judge(only, Reading(track, attempt.handed), attempt), ())


def arms_earlier(track: Track, frames: int) -> Track:
    """Upper arms and forearms are where they would be so many frames later, from their shoulders."""
    joints = track.joints_m.copy()
    later = np.minimum(np.arange(len(joints)) + frames, len(joints) - 1)
    for side in ("left", "right"):
        shoulder = joints[:, coco.INDEX[f"{side}_shoulder"]]
        for part in ("elbow", "wrist"):
            joint = coco.INDEX[f"{side}_{part}"]
            joints[:, joint] = shoulder + (joints[:, joint] - shoulder)[later]
    return replace(track, joints_m=joints)


def standing_foot_ahead(track: Track, attempt: FoundAttempt, metres: float) -> Track:
    """Around the hit, further to where the hips go."""
    hips = track.joints_m[:, [coco.INDEX["left_hip"], coco.INDEX["right_hip"]], :2].mean(axis=1)
    start, _, peak, _ = (round(track.frame_at(moment_s)) for moment_s in attempt.moments_s)
    ahead = (hips[peak] - hips[start]) / np.linalg.norm(hips[peak] - hips[start])
    joints = track.joints_m.copy()
    joints[peak - 4 : peak + 8, coco.INDEX["left_ankle"], :2] += metres * ahead
    return replace(track, joints_m=joints)


@pytest.mark.parametrize(
    ("action", "fault"),
    [("star_jump", "out_of_time"), ("volleyball_spike", "late_hit"), ("soccer_kick", "support_foot_behind")],
)
def test_the_standard_itself_is_not_the_opposite_of_a_fault(action: str, fault: str) -> None:
    assert said_of(fault, *performance(action)).fine


def test_arms_that_open_before_the_legs_did_not_open_together_with_them() -> None:
    track, attempt = performance("star_jump")
    assert said_of("out_of_time", arms_earlier(track, 5), attempt) == Said()


def test_who_hits_while_he_still_rises_did_not_hit_at_the_top() -> None:
    track, attempt = performance("volleyball_spike")
    assert said_of("late_hit", arms_earlier(track, 3), attempt) == Said()


def test_a_standing_foot_that_is_far_ahead_was_not_beside_the_ball() -> None:
    track, attempt = performance("soccer_kick")
    assert said_of("support_foot_behind", standing_foot_ahead(track, attempt, 0.2), attempt) == Said()
