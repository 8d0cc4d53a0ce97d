"""From the values of a coach's words (`models.motions.vocabulary`) to the turns of all joints, for many poses at once."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float
from models.motions import rotations
from models.motions.figure import Figure
from models.motions.grounding import Footing, footing
from models.motions.inverse_kinematics import Limb, aim, hinge_axis_of, limb_of, reach
from models.skeleton import smpl

SIDES: Final = ("left", "right")
OUT: Final = {"left": np.array((1.0, 1.0, 1.0)), "right": np.array((1.0, -1.0, 1.0))}
"""(front, out, up) into (x, y, z)."""
Values = Mapping[str, Float]
"""(T,) or (T, 3) of each word, by names such as `tip`, `left_arm.upper`, `left_foot.place`."""

_SPINE: Final = tuple(smpl.INDEX[name] for name in ("spine1", "spine2", "spine3"))
_SHARES: Final = np.array(((0.34, 0.39, 0.28), (0.33, 0.33, 0.36), (0.33, 0.28, 0.36)))
"""(3, 3) of the trunk's side, lean and twist that each joint of the spine takes: as their ranges are."""
_NECK_SHARE: Final = 0.45
_HEAD_RANGE_DEG: Final = np.array((40.0, 50.0, 70.0))
"""(side, lean, turn) that neck and head do together, well inside their limits."""
_CLEARANCE_M: Final = 0.003
"""Of a foot in the air."""
_PALM_SHARE: Final = 0.8
"""Of the way from the wrist to the fingers' roots, where the palm touches what it holds."""
_TWIST_DEG: Final = 80.0
_WRIST_RANGE_DEG: Final = np.array((75.0, 15.0, 32.0))


@dataclass(frozen=True, eq=False)
class Guide:
    """A hand whose palm stays on a ball that the other hand carries. Vectors are in the other hand's frame.

    Attributes:
        side: the hand that follows.
        centre_m: (3,) of the ball from the other wrist.
        gap_m: from the centre to the wrist's level, past the palm's thickness.
        towards: (T, 3) from the centre to the palm.
        fingers: (T, 3) to where the fingers point; what of it lies along `towards` is left out.
        weight: (T,) 1 follows, 0 goes by its own words.
        pole: (3,) to where its elbow points, in the chest's frame.
    """

    side: str
    centre_m: Float
    gap_m: float
    towards: Float
    fingers: Float
    weight: Float
    pole: Float


def upper_body(figure: Figure, values: Values, guides: tuple[Guide, ...] = ()) -> Float:
    """(T, 24, 3, 3) rotations against the parents of all but the legs, which stay as in the T-pose."""
    count = len(values["tip"])
    local = np.broadcast_to(np.eye(3), (count, smpl.COUNT, 3, 3)).copy()
    facing, tip, side = (np.radians(values[name]) for name in ("facing", "tip", "side"))
    local[:, 0] = rotations.about(2, facing) @ rotations.about(1, tip) @ rotations.about(0, side)
    trunk = np.radians(np.stack([values[name] for name in ("bow", "lean", "twist")], axis=-1))
    chest = local[:, 0]
    for joint, share in zip(_SPINE, _SHARES, strict=True):
        local[:, joint] = rotations.matrices(trunk * share)
        chest = chest @ local[:, joint]
    _turn_head(local, chest, values["gaze"])
    for arm_side in SIDES:
        _bend_arm(figure, arm_side, values, local)
    for guide in guides:
        _follow(figure, guide, local)
    return local


def _turn_head(local: Float, chest: Float, gaze: Float) -> None:
    wanted = rotations.about(2, np.radians(gaze[:, 0])) @ rotations.about(1, np.radians(gaze[:, 1]))
    turn = rotations.vectors(chest.swapaxes(-1, -2) @ wanted)
    most = np.radians(_HEAD_RANGE_DEG)
    turn = most * np.tanh(turn / most)
    neck, head = smpl.INDEX["neck"], smpl.INDEX["head"]
    local[:, neck], local[:, head] = rotations.matrices(_NECK_SHARE * turn), rotations.matrices((1 - _NECK_SHARE) * turn)


def _bend_arm(figure: Figure, side: str, values: Values, local: Float) -> None:
    limb = limb_of(figure, side, "arm")
    mirror = 1.0 if side == "left" else -1.0
    word = {name: values[f"{side}_arm.{name}"] for name in ("upper", "fore", "bend", "turn", "wrist", "cock", "curl")}
    upper, fore = rotations.unit(word["upper"] * OUT[side]), word["fore"] * OUT[side]
    collar, elbow, wrist, hand = (smpl.INDEX[f"{side}_{name}"] for name in ("collar", "elbow", "wrist", "hand"))
    local[:, collar] = _collar(upper, mirror)
    turned = aim(limb, upper, np.cross(upper, fore))
    local[:, limb.root] = local[:, collar].swapaxes(-1, -2) @ turned
    local[:, elbow] = _bent(limb, np.radians(word["bend"])) @ rotations.about(1, np.radians(word["turn"]))
    flexion, deviation = -mirror * np.radians(word["wrist"]), -mirror * np.radians(word["cock"])
    local[:, wrist] = rotations.matrices(np.stack((flexion, np.zeros_like(flexion), deviation), axis=-1))
    local[:, hand] = rotations.about(0, -mirror * np.radians(word["curl"]))


def _collar(upper: Float, mirror: float) -> Float:
    """The shoulder girdle goes along with the arm: up with a raised one, to the front with one that reaches there.

    A third of the arm's elevation comes from the girdle (Inman et al., "Observations on the function of the shoulder joint",
    J. Bone and Joint Surgery 26, 1944), less below the horizontal.
    """
    raised = np.clip(upper[:, 2] + 0.4, 0.0, None) ** 2 / 1.96
    vector = np.stack((np.radians(30) * raised, np.zeros(len(upper)), np.radians(-14) * upper[:, 0]), axis=-1)
    return rotations.matrices(vector * np.array((mirror, 1.0, mirror)))


def _bent(limb: Limb, bend_rad: Float) -> Float:
    return rotations.about(limb.axis, limb.sense * bend_rad)


def _follow(figure: Figure, guide: Guide, local: Float) -> None:
    """Turn one arm so that its palm is on the ball; in the chest's frame, where the pelvis does not matter."""
    other = "left" if guide.side == "right" else "right"
    ours, theirs = (
        [smpl.INDEX[f"{side}_{name}"] for name in ("collar", "shoulder", "elbow", "wrist")] for side in (guide.side, other)
    )
    carrier, turn = _in_chest(figure, local, theirs)
    # In the T-pose the left hand's fingers point along y and its palm looks down; the right hand's fingers point the other way.
    out = OUT[guide.side][1]
    axes = rotations.frame(guide.towards, out * guide.fingers)
    hand = turn @ np.stack((np.cross(axes[..., 1], axes[..., 0]), axes[..., 1], axes[..., 0]), axis=-1)
    palm = figure.bones_m[smpl.INDEX[f"{guide.side}_hand"]] * _PALM_SHARE
    wrist = carrier + rotations.through(turn, guide.centre_m + guide.gap_m * axes[..., 0]) - rotations.through(hand, palm)
    limb = limb_of(figure, guide.side, "arm")
    shoulder, _ = _in_chest(figure, local, ours[:2])
    to_end = wrist - shoulder
    turned, bend = reach(limb, to_end, hinge_axis_of(to_end, np.broadcast_to(guide.pole, to_end.shape)))
    elbow = _bent(limb, bend)
    twist, rest = _hand_turns((turned @ elbow).swapaxes(-1, -2) @ hand)
    wanted = (local[:, ours[0]].swapaxes(-1, -2) @ turned, elbow @ twist, rest)
    for joint, there in zip(ours[1:], wanted, strict=True):
        local[:, joint] = rotations.between(local[:, joint], there, guide.weight)


def _hand_turns(hand: Float) -> tuple[Float, Float]:
    """Share a (T, 3, 3) turn of the hand against the forearm between the forearm's own twist and the wrist, within their ranges."""
    quaternion = rotations.quaternions(hand)
    most = np.radians(_TWIST_DEG)
    twist = rotations.about(1, most * np.tanh(2 * np.arctan2(quaternion[..., 2], quaternion[..., 0]) / most))
    ranges = np.radians(_WRIST_RANGE_DEG)
    rest = rotations.vectors(twist.swapaxes(-1, -2) @ hand)
    return twist, rotations.matrices(ranges * np.tanh(rest / ranges))


def _in_chest(figure: Figure, local: Float, chain: list[int]) -> tuple[Float, Float]:
    """Place (T, 3) and turn (T, 3, 3) of the last joint of a chain that begins at the chest, in the chest's frame."""
    place, turn = np.zeros((len(local), 3)), np.broadcast_to(np.eye(3), (len(local), 3, 3))
    for joint in chain:
        place = place + rotations.through(turn, figure.bones_m[joint])
        turn = turn @ local[:, joint]
    return place, turn


def legs(figure: Figure, values: Values, pelvis_m: Float, local: Float) -> dict[str, Footing]:
    """Turn the legs of (T, 24, 3, 3) rotations, in place: by targets where the feet are held, by angles where they are free.

    Args:
        figure: of the subject.
        values: words.
        pelvis_m: (T, 3) in the world.
        local: rotations against the parents, which are written to.

    Returns:
        How the feet that are held had to be pitched, by side.
    """
    held = {}
    pelvis = local[:, 0]
    for side in SIDES:
        limb = limb_of(figure, side, "leg")
        hip = pelvis_m + rotations.through(pelvis, figure.bones_m[limb.root])
        place, yaw, pitch, hold, knee = (values[f"{side}_foot.{name}"] for name in ("place", "yaw", "pitch", "hold", "knee"))
        held[side] = footing(figure, side, hip, place, np.radians(yaw), np.radians(pitch))
        joints = np.array([limb.root, limb.hinge, *(smpl.INDEX[f"{side}_{name}"] for name in ("ankle", "foot"))])
        target = _planted_leg(limb, held[side], hip, pelvis, np.radians(yaw), np.radians(yaw + OUT[side][1] * knee))
        local[:, joints] = target
        off = np.flatnonzero(hold < 1.0)
        if len(off):
            words = {name: value[off] for name, value in values.items() if name.startswith(f"{side}_leg.")}
            share = np.broadcast_to(1.0 - hold[off, None], (len(off), len(joints)))
            free = rotations.between(target[off], _free_leg(limb, side, words), share)
            _clear(figure, side, limb, hip[off], pelvis[off], free, _CLEARANCE_M * (1.0 - hold[off]))
            local[np.ix_(off, joints)] = free
    return held


def _clear(figure: Figure, side: str, limb: Limb, hip: Float, pelvis: Float, leg: Float, clearance_m: Float) -> None:
    """Bend (T, 4, 3, 3) legs, in place, as far as it takes to keep the foot (T,) metres over the floor; the foot keeps its turn."""
    thigh = pelvis @ leg[:, 0]
    shank = thigh @ leg[:, 1]
    foot = shank @ leg[:, 2]
    ankle = hip + rotations.through(thigh, limb.upper_m) + rotations.through(shank, limb.lower_m)
    toes = ankle + rotations.through(foot, figure.bones_m[smpl.INDEX[f"{side}_foot"]])
    lowest = figure.soles[side].lowest_m(np.stack((ankle, toes), axis=1), np.stack((foot, foot @ leg[:, 3]), axis=1)) - clearance_m
    sunk = np.flatnonzero(lowest < 0)
    if not len(sunk):
        return
    raised = ankle[sunk] - lowest[sunk, None] * np.array((0.0, 0.0, 1.0))
    turned, bend = reach(limb, raised - hip[sunk], thigh[sunk, :, 1], soft=False)
    knee = _bent(limb, bend)
    leg[sunk, 0] = pelvis[sunk].swapaxes(-1, -2) @ turned
    leg[sunk, 1] = knee
    leg[sunk, 2] = (turned @ knee).swapaxes(-1, -2) @ foot[sunk]


def _planted_leg(limb: Limb, foot: Footing, hip: Float, pelvis: Float, yaw_rad: Float, knee_rad: Float) -> Float:
    """(T, 4, 3, 3) hip, knee, ankle and toes of a leg whose foot is held; the knee points to its own yaw."""
    heading = rotations.about(2, yaw_rad)
    thigh, bend = reach(limb, foot.ankles_m - hip, rotations.about(2, knee_rad)[..., 1])
    knee = _bent(limb, bend)
    sole = heading @ rotations.about(1, foot.pitch_rad)
    ankle = (thigh @ knee).swapaxes(-1, -2) @ sole
    return np.stack((pelvis.swapaxes(-1, -2) @ thigh, knee, ankle, rotations.about(1, foot.toes_rad)), axis=1)


def _free_leg(limb: Limb, side: str, values: Values) -> Float:
    """(T, 4, 3, 3) hip, knee, ankle and toes of a leg that goes by angles."""
    outwards = 1.0 if side == "left" else -1.0
    thigh, bend, turn, toes = (values[f"{side}_leg.{name}"] for name in ("thigh", "bend", "turn", "toes"))
    direction = rotations.unit(thigh * OUT[side])
    # Turned out, the left leg turns to the left: about the line from the knee to the hip.
    turned = rotations.matrices(-direction * (outwards * np.radians(turn))[:, None])
    hip = turned @ aim(limb, direction, np.broadcast_to((0.0, 1.0, 0.0), direction.shape))
    still = np.broadcast_to(np.eye(3), hip.shape)
    return np.stack((hip, _bent(limb, np.radians(bend)), rotations.about(1, np.radians(toes)), still), axis=1)
