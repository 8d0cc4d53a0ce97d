"""The posture in which every action begins and ends: upright and still, feet hip-wide, arms hanging."""

from functools import lru_cache
from typing import Final

import numpy as np

from models.arrays import Float
from models.body.pose import Pose
from models.motions import posing, rotations
from models.motions.figure import Figure, figure_of
from models.motions.inverse_kinematics import STRAIGHT_DEG, limb_of
from models.motions.subject import Subject
from models.skeleton import smpl

TOES_OUT_DEG: Final = 7.0
_WEIGHT_BEHIND_BALL: Final = 0.5
"""The centre of mass is over this share of the way from the ball of the foot back to the ankle."""
_ROUNDS: Final = 12

_BODY: Final = {"facing": 0.0, "tip": 0.0, "side": 0.0, "lean": 0.0, "bow": 0.0, "twist": 0.0}
_ARM: Final = {
    "upper": (0.02, 0.17, -1.0),
    "fore": (1.0, -0.15, 0.0),
    "bend": 14.0,
    "turn": 15.0,
    "wrist": 4.0,
    "cock": 0.0,
    "curl": 22.0,
}
_LEG: Final = {"thigh": (0.0, 0.0, -1.0), "bend": 12.0, "turn": TOES_OUT_DEG, "toes": 0.0}


def stand(subject: Subject) -> Pose:
    """Upright, looking along x, the pelvis over the origin, both soles on the floor."""
    return stand_of(figure_of(subject))


def stand_of(figure: Figure) -> Pose:
    """The same of a figure."""
    values = {name: np.asarray(value, np.float64)[None] for name, value in standing_values(figure).items()}
    local = posing.upper_body(figure, values)
    posing.legs(figure, values, values["pelvis"], local)
    return Pose(values["pelvis"][0], rotations.vectors(local)[0])


@lru_cache(maxsize=64)
def standing_values(figure: Figure) -> dict[str, Float]:
    """What all words of the vocabulary are in this posture, and `pelvis` and the footprints in metres."""
    sides = posing.SIDES
    values: dict[str, Float] = {name: np.array(value) for name, value in _BODY.items()}
    values["gaze"] = np.zeros(2)
    for side in sides:
        values |= {f"{side}_arm.{name}": np.array(value) for name, value in _ARM.items()}
        values |= {f"{side}_leg.{name}": np.array(value) for name, value in _LEG.items()}
        out = 1.0 if side == "left" else -1.0
        values |= {f"{side}_foot.{name}": np.array(value) for name, value in (("pitch", 0.0), ("hold", 1.0), ("knee", 0.0))}
        values[f"{side}_foot.yaw"] = np.array(out * TOES_OUT_DEG)
    forward, height = 0.0, figure.leg_m
    for _ in range(_ROUNDS):
        values["pelvis"] = np.array((0.0, 0.0, height))
        for side in sides:
            hip = figure.bones_m[smpl.INDEX[f"{side}_hip"]]
            values[f"{side}_foot.place"] = np.array((forward, hip[1], 0.0))
        forward, height = _corrected(figure, values)
    return values


def _corrected(figure: Figure, values: dict[str, Float]) -> tuple[float, float]:
    """Where the footprints must be to lie under the weight, and the pelvis for the shorter leg's knee to be just not straight."""
    batch = {name: value[None] for name, value in values.items()}
    local = posing.upper_body(figure, batch)
    posing.legs(figure, batch, batch["pelvis"], local)
    placed = figure.place_local(batch["pelvis"], local)
    weight = figure.centres_of_mass_m(placed)[0, 0]
    ankles = {side: figure.soles[side].ankle_m(np.zeros(1)) for side in posing.SIDES}
    forward = weight - _WEIGHT_BEHIND_BALL * float(np.mean([back for back, _ in ankles.values()]))
    heights = []
    for side, (back, up) in ankles.items():
        limb = limb_of(figure, side, "leg")
        hip, yaw = figure.bones_m[limb.root], np.radians(posing.OUT[side][1] * TOES_OUT_DEG)
        away = np.array((forward + back[0] * np.cos(yaw), hip[1] + back[0] * np.sin(yaw))) - hip[:2]
        heights.append(up[0] + np.sqrt(limb.span_m(np.radians(STRAIGHT_DEG[0])) ** 2 - np.sum(away**2)) - hip[2])
    return float(forward), float(min(heights))
