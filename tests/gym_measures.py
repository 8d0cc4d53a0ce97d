"""One measure of each fault of jumps, squat, run, roll and cartwheel, as a teacher would take it: it grows with its severity."""

from collections.abc import Callable

import numpy as np

from models.motions import mat
from models.motions.motion import RATE_HZ
from models.skeleton import coco_feet, smpl
from tests.action_measures import Seen
from tests.motion_laws import intervals


def flight(seen: Seen) -> tuple[int, int]:
    """First sample and one past the last of the longest time in the air."""
    return max(intervals(np.asarray(~seen.motion.contacts.any(1))), key=lambda span: span[1] - span[0])


def jump_distance_m(seen: Seen) -> float:
    """From the big toes at take-off to the nearer heel at landing, as with a tape."""
    off, on = flight(seen)
    body = seen.figure.subject.body
    before, after = (body.coco_m(seen.motion.pose(number)) for number in (0, on + round(0.15 * RATE_HZ)))
    toes = max(before[coco_feet.INDEX[f"{side}_big_toe"], 0] for side in ("left", "right"))
    heel = min(after[coco_feet.INDEX[f"{side}_heel"], 0] for side in ("left", "right"))
    assert off < on
    return float(heel - toes)


def jump_no_arm_swing(seen: Seen) -> float:
    """How little the wrist travels up and down against the shoulder until the take-off."""
    height = (seen.joint("left_wrist") - seen.joint("left_shoulder"))[: flight(seen)[0], 2]
    return -float(np.ptp(height))


def jump_stiff_landing(seen: Seen) -> float:
    return -float(seen.bend_deg("left_knee")[flight(seen)[1] :].max())


def jump_no_crouch(seen: Seen) -> float:
    return -float(seen.bend_deg("left_knee")[: flight(seen)[0]].max())


def jump_upright_takeoff(seen: Seen) -> float:
    """Degrees by which the line from the ball of the foot to the neck is steeper than 45 at take-off."""
    off = flight(seen)[0]
    line = (seen.joint("neck") - seen.joint("left_foot"))[off]
    return float(np.degrees(np.arctan2(line[2], line[0])))


def squat_knees_in(seen: Seen) -> float:
    """How much nearer the knees are to one another than the ankles, at the lowest point."""
    knees, ankles = ((seen.joint(f"left_{name}") - seen.joint(f"right_{name}"))[seen.peak, 1] for name in ("knee", "ankle"))
    return float(ankles - knees)


def squat_heels_up(seen: Seen) -> float:
    return float(seen.joint("left_ankle")[seen.peak, 2])


def squat_back_rounded(seen: Seen) -> float:
    """Degrees between pelvis and chest."""
    turns = seen.placed.turns[seen.peak]
    up = turns[[smpl.INDEX["pelvis"], smpl.INDEX["spine3"]], :, 2]
    return float(np.degrees(np.arccos(np.clip(up[0] @ up[1], -1, 1))))


def squat_trunk_forward(seen: Seen) -> float:
    return float(seen.trunk_lean_deg()[seen.peak])


def squat_too_shallow(seen: Seen) -> float:
    return -float(seen.bend_deg("left_knee").max())


def star_arms_half(seen: Seen) -> float:
    return -float((seen.joint("left_wrist") - seen.joint("left_shoulder"))[:, 2].max())


def star_legs_together(seen: Seen) -> float:
    return -float((seen.joint("left_ankle") - seen.joint("right_ankle"))[:, 1].max())


def star_out_of_time(seen: Seen) -> float:
    """Seconds by which the hands are highest after the feet are widest."""
    hands = (seen.joint("left_wrist") - seen.joint("left_shoulder"))[:, 2]
    feet = (seen.joint("left_ankle") - seen.joint("right_ankle"))[:, 1]
    return float(hands.argmax() - feet.argmax()) / RATE_HZ


def run_quick(seen: Seen) -> slice:
    return slice(seen.exertion, seen.peak)


def run_no_arm_drive(seen: Seen) -> float:
    return -float(np.ptp((seen.joint("left_wrist") - seen.joint("left_shoulder"))[run_quick(seen), 0]))


def run_no_knee_lift(seen: Seen) -> float:
    """How far the highest knee stays under the hip."""
    return float((seen.joint("left_hip") - seen.joint("left_knee"))[run_quick(seen), 2].min())


def run_overstride(seen: Seen) -> float:
    """Furthest that an ankle is before the pelvis as its foot lands."""
    ahead = []
    for number, side in enumerate(("left", "right")):
        lands = [first for first, _ in intervals(seen.motion.contacts[:, number]) if seen.exertion <= first <= seen.peak]
        ahead += [float((seen.joint(f"{side}_ankle") - seen.joint("pelvis"))[at, 0]) for at in lands]
    return max(ahead)


def run_leans_back(seen: Seen) -> float:
    return -float(seen.trunk_lean_deg()[run_quick(seen)].mean())


def roll_back(seen: Seen) -> slice:
    first, last = intervals(seen.motion.contacts[:, 4])[0]
    return slice(first, last)


def roll_head_not_tucked(seen: Seen) -> float:
    """Degrees by which the chin is not on the chest as the back touches the mat."""
    at = roll_back(seen).start
    up = seen.placed.turns[at][[smpl.INDEX["spine3"], smpl.INDEX["head"]], :, 2]
    return -float(np.degrees(np.arccos(np.clip(up[0] @ up[1], -1, 1))))


def roll_legs_open(seen: Seen) -> float:
    return float((seen.joint("left_knee") - seen.joint("right_knee"))[roll_back(seen), 1].max())


def roll_hands_to_get_up(seen: Seen) -> float:
    """How low a hand is after the back has left the mat; and, once it is on the mat, for how long."""
    after = slice(roll_back(seen).stop, seen.end - round(0.45 * RATE_HZ))
    height = seen.joint("left_wrist")[after, 2] - mat.HEIGHT_M
    return -float(height.min()) + 0.05 * len(height) / RATE_HZ


def wheel_bent_legs(seen: Seen) -> float:
    return float(seen.bend_deg("left_knee")[seen.peak])


def wheel_arms_bent(seen: Seen) -> float:
    return float(seen.bend_deg("left_elbow")[seen.peak])


def wheel_no_straight_line(seen: Seen) -> float:
    """How far the hands are from the line of the feet."""
    hands = (seen.joint("left_wrist") + seen.joint("right_wrist"))[seen.peak, 0] / 2
    return float(hands - seen.joint("left_ankle")[0, 0])


def wheel_legs_not_apart(seen: Seen) -> float:
    return -float(abs((seen.joint("left_ankle") - seen.joint("right_ankle"))[seen.peak, 1]))


MEASURES: dict[str, dict[str, Callable[[Seen], float]]] = {
    "long_jump": {
        "no_arm_swing": jump_no_arm_swing,
        "stiff_landing": jump_stiff_landing,
        "no_crouch": jump_no_crouch,
        "upright_takeoff": jump_upright_takeoff,
    },
    "squat": {
        "knees_in": squat_knees_in,
        "heels_up": squat_heels_up,
        "back_rounded": squat_back_rounded,
        "trunk_forward": squat_trunk_forward,
        "too_shallow": squat_too_shallow,
    },
    "star_jump": {
        "arms_half": star_arms_half,
        "legs_together": star_legs_together,
        "out_of_time": star_out_of_time,
        "stiff_landing": jump_stiff_landing,
    },
    "run": {
        "no_arm_drive": run_no_arm_drive,
        "no_knee_lift": run_no_knee_lift,
        "overstride": run_overstride,
        "leans_back": run_leans_back,
    },
    "forward_roll": {
        "head_not_tucked": roll_head_not_tucked,
        "legs_open": roll_legs_open,
        "hands_to_get_up": roll_hands_to_get_up,
    },
    "cartwheel": {
        "bent_legs": wheel_bent_legs,
        "arms_bent": wheel_arms_bent,
        "no_straight_line": wheel_no_straight_line,
        "legs_not_apart": wheel_legs_not_apart,
    },
}
"""A larger value is a worse fault."""
