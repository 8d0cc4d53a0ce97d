"""Hands that bear: arms turned so that the palms lie on the ground where they were put, as in a cartwheel."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.body.limits import limits_rad
from models.compiled import Counts
from models.motions import rotations, splines
from models.motions.figure import Figure, Placed
from models.motions.inverse_kinematics import limb_of, reach
from models.skeleton import smpl

FOREARM_TURN_RAD: Final = np.radians(75.0)
"""How far the forearm turns about itself for a hand; what is left is the wrist's."""
_LIFTS: Final = 4
_EASE: Final = 8
"""Poses before and after, over which a hand is lifted that would be in the ground."""
_FLOATS_M: Final = 0.001
_WITHIN: Final = 0.98
"""A wrist that would have to bend further than it can leaves the palm a little off the ground."""
_THUMB_UP_RAD: Final = np.radians(8.0)
"""A relaxed thumb hangs below the palm: the hand leans off it, so that thumb and edge both touch."""


@dataclass(frozen=True, eq=False)
class Palm:
    """A hand that is put on the ground.

    Attributes:
        side: left or right.
        wrist_m: (T, 3) where the wrist goes, if the hand bears.
        yaw_rad: (T,) to where the fingers point, about z.
        bears: (T,) from 0, the arm as it was, to 1, the palm on the ground.
        out: where the elbow points when the hand bears, (T, 3) in the world, or None: where it pointed before.
        points: on its way to the ground and from it the arm points to where the hand bears; or else it is held against the chest
            as it is when the hand bears.
    """

    side: str
    wrist_m: Float
    yaw_rad: Float
    bears: Float
    out: Float | None = None
    points: bool = True


def flat(side: str, yaw_rad: Float) -> Float:
    """(T, 3, 3) a hand with its palm down and its fingers along the yaw, from the T-pose into the world."""
    mirror = 1.0 if side == "left" else -1.0
    return rotations.about(2, yaw_rad - mirror * np.pi / 2) @ rotations.about(1, np.full(len(yaw_rad), -_THUMB_UP_RAD))


def wrist_height_m(figure: Figure, side: str) -> float:
    """Of the wrist over the ground that a flat palm lies on."""
    body = figure.subject.body
    skin, wrist = body.model.skin, smpl.INDEX[f"{side}_wrist"]
    carried = (np.isin(skin.joints, (wrist, smpl.INDEX[f"{side}_hand"])) * skin.weights).sum(1)
    hand = body.rest_vertices_m[carried > 0.5] - body.rest_joints_m[wrist]
    mirror = 1.0 if side == "left" else -1.0
    turned = hand @ flat(side, np.array((mirror * np.pi / 2,)))[0].T
    return float(-turned[:, 2].min())


def bear(figure: Figure, palm: Palm, pelvis_m: Float, local: Float) -> Float:
    """Turn one arm of (T, 24, 3, 3) rotations against the parents, in place.

    Returns:
        (T,) how far the wrist of a hand that bears stays from where it should be, metres: the arm is too short.
    """
    side = palm.side
    limb = limb_of(figure, side, "arm")
    collar, wrist, hand = (smpl.INDEX[f"{side}_{name}"] for name in ("collar", "wrist", "hand"))
    placed = figure.place_local(pelvis_m, local)
    to_end = palm.wrist_m - placed.joints_m[:, limb.root]
    axis = rotations.through(placed.turns[:, limb.root], np.broadcast_to(limb.hinge_axis, to_end.shape))
    if palm.out is not None:
        axis = np.cross(palm.out, to_end)
    upper, bend = reach(limb, to_end, axis)
    bent = rotations.about(limb.axis, limb.sense * bend)
    turn, rest = _about_forearm((upper @ bent).swapaxes(-1, -2) @ flat(side, palm.yaw_rad))
    rest = _within(figure, wrist, rest)
    joints = [limb.root, limb.hinge, wrist, hand]
    shoulder = placed.turns[:, collar].swapaxes(-1, -2) @ upper
    bearing = np.stack((shoulder, bent @ rotations.about(1, turn), rest, np.broadcast_to(np.eye(3), rest.shape)), axis=1)
    if not palm.points:
        bearing = bearing[_nearest_that_bears(palm.bears)]
    share = np.broadcast_to(palm.bears[:, None], (len(to_end), len(joints)))
    used = palm.bears > 0
    local[:, joints] = np.where(used[:, None, None, None], rotations.between(local[:, joints], bearing, share), local[:, joints])
    now = figure.place_local(pelvis_m, local).joints_m[:, wrist]
    return np.asarray(np.linalg.norm(now - palm.wrist_m, axis=-1) * (palm.bears >= 1))


def _eased(lift_m: Float) -> Float:
    """(T,) no less, and without corners, so that an arm that is nearly straight does not jerk."""
    if not lift_m.any():
        return lift_m
    most = np.max([np.roll(lift_m, step) for step in range(-_EASE, _EASE + 1)], axis=0)
    return splines.softened(most, _EASE / 2)


def _nearest_that_bears(bears: Float) -> Counts:
    """(T,) number of the nearest pose in which the hand bears as much as it ever does."""
    most = np.flatnonzero(bears >= bears.max() - 1e-9)
    times = np.arange(len(bears))
    after = np.clip(np.searchsorted(most, times), 0, len(most) - 1)
    before = np.clip(after - 1, 0, None)
    return np.where(times - most[before] < most[after] - times, most[before], most[after])


def settle(figure: Figure, side: str, ground_m: float, bears: Bool, pelvis_m: Float, local: Float) -> None:
    """Lift a hand out of the ground wherever it would be in it, and let it down to the ground where it bears (T,), in place.

    The hand keeps its turn as far as the wrist can.
    """
    limb = limb_of(figure, side, "arm")
    collar, wrist = (smpl.INDEX[f"{side}_{name}"] for name in ("collar", "wrist"))
    for _ in range(_LIFTS):
        placed = figure.place_local(pelvis_m, local)
        low = lowest_m(figure, side, placed) - ground_m
        lift = np.where(bears, -low, _eased(np.maximum(-low, 0.0)))
        sunk = np.flatnonzero(np.abs(lift) > np.where(bears, _FLOATS_M, 0.0))
        if not len(sunk):
            return
        target = placed.joints_m[sunk, wrist].copy()
        target[:, 2] += lift[sunk]
        axis = rotations.through(placed.turns[sunk, limb.root], np.broadcast_to(limb.hinge_axis, target.shape))
        upper, bend = reach(limb, target - placed.joints_m[sunk, limb.root], axis)
        bent = rotations.about(limb.axis, limb.sense * bend)
        turn, rest = _about_forearm((upper @ bent).swapaxes(-1, -2) @ placed.turns[sunk, wrist])
        local[sunk, limb.root] = placed.turns[sunk, collar].swapaxes(-1, -2) @ upper
        local[sunk, limb.hinge] = bent @ rotations.about(1, turn)
        local[sunk, wrist] = _within(figure, wrist, rest)


def lowest_m(figure: Figure, side: str, placed: Placed) -> Float:
    """(T,) the lowest skin of a hand over the floor."""
    joints = [smpl.INDEX[f"{side}_{name}"] for name in ("wrist", "hand")]
    heights = [
        placed.joints_m[:, joint, 2] + (placed.turns[:, joint, 2] @ _skin_of(figure, joint).T).min(1) for joint in joints
    ]  # fmt: skip
    return np.asarray(np.minimum(*heights))


def _within(figure: Figure, wrist: int, turn: Float) -> Float:
    bounds = limits_rad(figure.subject.age_years)[wrist] * _WITHIN
    return rotations.matrices(np.clip(rotations.vectors(turn), bounds[:, 0], bounds[:, 1]))


def _skin_of(figure: Figure, joint: int) -> Float:
    """(N, 3) the skin that a joint carries, from the joint, in the T-pose."""
    body = figure.subject.body
    skin = body.model.skin
    carried = ((skin.joints == joint) * skin.weights).sum(1) > 0.5
    return np.asarray(body.rest_vertices_m[carried] - body.rest_joints_m[joint])


def _about_forearm(hand: Float) -> tuple[Float, Float]:
    """A hand against the forearm as a turn about the forearm (T,) and what is left for the wrist (T, 3, 3)."""
    quaternion = rotations.quaternions(hand)
    turn = 2 * np.arctan2(quaternion[:, 2], quaternion[:, 0])
    turn = (turn + np.pi) % (2 * np.pi) - np.pi
    turn = FOREARM_TURN_RAD * np.tanh(turn / FOREARM_TURN_RAD)
    return turn, rotations.about(1, -turn) @ hand
