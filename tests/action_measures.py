"""One measure of each fault, as a teacher would take it from the motion: it must grow with the fault's severity."""

from collections.abc import Callable

import numpy as np

from models.arrays import Float
from models.motions import rotations
from models.motions.figure import Placed, figure_of
from models.motions.motion import RATE_HZ, Motion
from models.motions.subject import Subject
from models.skeleton import smpl
from tests.motion_laws import in_air, intervals


class Seen:
    """A right-handed motion with what measures need."""

    def __init__(self, motion: Motion, subject: Subject) -> None:
        self.motion = motion
        self.figure = figure_of(subject)
        self.placed: Placed = self.figure.place(motion.translations_m, motion.rotations_rad)
        attempt = motion.attempts[0]
        self.exertion, self.peak = (round(at_s * RATE_HZ) for at_s in (attempt.exertion_s, attempt.peak_s))
        self.end = round(attempt.end_s * RATE_HZ)

    def joint(self, name: str) -> Float:
        """(T, 3) in the world."""
        return self.placed.joints_m[:, smpl.INDEX[name]]

    def bend_deg(self, name: str) -> Float:
        """(T,) between the bones above and below a joint; 0 is straight."""
        joint = smpl.INDEX[name]
        child = smpl.PARENTS.index(joint)
        above = rotations.unit(self.placed.joints_m[:, joint] - self.placed.joints_m[:, smpl.PARENTS[joint]])
        below = rotations.unit(self.placed.joints_m[:, child] - self.placed.joints_m[:, joint])
        return np.asarray(np.degrees(np.arccos(np.clip((above * below).sum(-1), -1, 1))))

    def in_chest(self, vector: Float) -> Float:
        """(T, 3) world vectors in the chest's frame."""
        return rotations.through(self.placed.turns[:, smpl.INDEX["spine3"]].swapaxes(-1, -2), vector)

    def trunk_lean_deg(self) -> Float:
        """(T,) of the line from the pelvis to the neck, to the front of the world."""
        trunk = self.joint("neck") - self.joint("pelvis")
        return np.asarray(np.degrees(np.arctan2(trunk[:, 0], trunk[:, 2])))


def shot_elbow_out(seen: Seen) -> float:
    """Degrees of the upper arm to the side, when the ball is over the forehead."""
    arm = seen.in_chest(seen.joint("right_elbow") - seen.joint("right_shoulder"))[seen.peak - round(0.185 * RATE_HZ)]
    return float(np.degrees(np.arctan2(-arm[1], arm[0])))


def shot_no_knee_bend(seen: Seen) -> float:
    return -float(seen.bend_deg("right_knee")[: seen.peak].max())


def shot_no_follow_through(seen: Seen) -> float:
    """How far the wrist is under the height of the release's, 0.42 s later; against the head."""
    wrist = (seen.joint("right_wrist") - seen.joint("head"))[:, 2]
    return float(wrist[seen.peak] - wrist[seen.peak + round(0.42 * RATE_HZ)])


def shot_ball_from_chest(seen: Seen) -> float:
    """How far the wrist is under the shoulder when the arm begins to extend."""
    at = seen.peak - round(0.185 * RATE_HZ)
    return float((seen.joint("right_shoulder") - seen.joint("right_wrist"))[at, 2])


def clear_hit_too_low(seen: Seen) -> float:
    return -float((seen.joint("right_wrist") - seen.joint("right_shoulder"))[seen.peak, 2])


def clear_no_body_turn(seen: Seen) -> float:
    """Shoulders' line against the net's before the hit."""
    across = seen.joint("left_shoulder") - seen.joint("right_shoulder")
    return -float(np.degrees(np.arctan2(across[:, 0], across[:, 1]))[: seen.peak].max())


def clear_straight_arm(seen: Seen) -> float:
    return -float(seen.bend_deg("right_elbow")[: seen.peak].max())


def clear_no_follow_through(seen: Seen) -> float:
    """How far across the body the wrist gets within 0.35 s."""
    wrist = seen.in_chest(seen.joint("right_wrist") - seen.joint("spine3"))[seen.peak : seen.peak + round(0.35 * RATE_HZ)]
    return -float(wrist[:, 1].max() - wrist[:, 2].min())


def spike_arm_not_back(seen: Seen) -> float:
    """How far before the shoulders the elbow is, on the average of the tenth of a second in which it should be behind them."""
    drawn = slice(seen.peak - round(0.16 * RATE_HZ), seen.peak - round(0.06 * RATE_HZ))
    return float(seen.in_chest(seen.joint("right_elbow") - seen.joint("right_shoulder"))[drawn, 0].mean())


def spike_hit_behind(seen: Seen) -> float:
    return -float((seen.joint("right_wrist") - seen.joint("head"))[seen.peak, 0])


def spike_late_hit(seen: Seen) -> float:
    """Seconds from the middle of the flight to the hit."""
    first, last = intervals(in_air(seen.motion))[-1]
    return float((seen.peak - (first + last - 1) / 2) / RATE_HZ)


def spike_one_foot_landing(seen: Seen) -> float:
    """Seconds between the feet's landings."""
    landings = [next(first for first, _ in intervals(seen.motion.contacts[:, side]) if first > seen.peak) for side in (0, 1)]
    return abs(landings[0] - landings[1]) / RATE_HZ


def kick_support_foot_behind(seen: Seen) -> float:
    """How far the support foot's ball is behind the ball."""
    return float((seen.motion.things[0].translations_m - seen.joint("left_foot"))[seen.peak, 0])


def kick_no_backswing(seen: Seen) -> float:
    return -float(seen.bend_deg("right_knee")[seen.exertion - round(0.02 * RATE_HZ) : seen.peak].max())


def kick_lean_back(seen: Seen) -> float:
    return -float(seen.trunk_lean_deg()[seen.peak])


def kick_no_follow_through(seen: Seen) -> float:
    return -float(seen.joint("right_ankle")[seen.peak : seen.peak + round(0.4 * RATE_HZ), 2].max())


MEASURES: dict[str, dict[str, Callable[[Seen], float]]] = {
    "basketball_shot": {
        "elbow_out": shot_elbow_out,
        "no_knee_bend": shot_no_knee_bend,
        "no_follow_through": shot_no_follow_through,
        "ball_from_chest": shot_ball_from_chest,
    },
    "badminton_clear": {
        "hit_too_low": clear_hit_too_low,
        "no_body_turn": clear_no_body_turn,
        "straight_arm": clear_straight_arm,
        "no_follow_through": clear_no_follow_through,
    },
    "volleyball_spike": {
        "arm_not_back": spike_arm_not_back,
        "hit_behind": spike_hit_behind,
        "late_hit": spike_late_hit,
        "one_foot_landing": spike_one_foot_landing,
    },
    "soccer_kick": {
        "support_foot_behind": kick_support_foot_behind,
        "no_backswing": kick_no_backswing,
        "lean_back": kick_lean_back,
        "no_follow_through": kick_no_follow_through,
    },
}
"""A larger value is a worse fault."""
