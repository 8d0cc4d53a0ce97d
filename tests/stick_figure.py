"""A figure whose joints stand where a test puts them: limbs along given directions, for angles that are known by construction."""

from collections.abc import Mapping
from typing import Final

import numpy as np

from models.arrays import Float
from models.skeleton import coco
from services.evaluation.track import Track, known_track

FRONT, LEFT, UP = np.eye(3)
DOWN: Final = -UP
_LENGTHS_M: Final = {"thigh": 0.40, "shank": 0.38, "upper_arm": 0.28, "forearm": 0.24}
STANDING: Final = dict.fromkeys(_LENGTHS_M, DOWN)


def figure(limbs: Mapping[str, Float] | None = None, trunk: Float = UP, hips: Float = LEFT, shoulders: Float = LEFT) -> Float:
    """(17, 3) joints of somebody who faces x with his hips 0.85 m over the floor.

    Args:
        limbs: direction of each limb as "left_thigh"; those left out hang.
        trunk: direction from hips to shoulders.
        hips, shoulders: direction from the right one to the left one.
    """
    directions = {f"{side}_{limb}": DOWN for side in ("left", "right") for limb in _LENGTHS_M} | dict(limbs or {})
    points: dict[str, Float] = {}
    middle = 0.85 * UP
    chest = middle + 0.5 * unit(trunk)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        points[f"{side}_hip"] = middle + sign * 0.12 * unit(hips)
        points[f"{side}_shoulder"] = chest + sign * 0.16 * unit(shoulders)
        for near, limb, far in (
            ("hip", "thigh", "knee"),
            ("knee", "shank", "ankle"),
            ("shoulder", "upper_arm", "elbow"),
            ("elbow", "forearm", "wrist"),
        ):
            name = f"{side}_{limb}"
            points[f"{side}_{far}"] = points[f"{side}_{near}"] + _LENGTHS_M[limb] * unit(directions[name])
        points[f"{side}_ear"] = chest + 0.2 * unit(trunk) + sign * 0.07 * LEFT
        points[f"{side}_eye"] = points[f"{side}_ear"] + 0.08 * FRONT - sign * 0.04 * LEFT
    points["nose"] = chest + 0.2 * unit(trunk) + 0.1 * FRONT
    return np.array([points[name] for name in coco.NAMES])


def unit(vector: Float) -> Float:
    return np.asarray(vector / np.linalg.norm(vector))


def still(joints_m: Float, frames: int = 9, sigma_m: float = 0.005) -> Track:
    """A track of somebody who does not move."""
    return known_track(np.repeat(joints_m[None], frames, axis=0), 1 / 30, sigma_m)


def turned(degrees: float, about: Float, what: Float) -> Float:
    """A vector turned about an axis, counter-clockwise seen from its tip (Rodrigues)."""
    axis, angle = unit(about), np.radians(degrees)
    return np.asarray(np.cos(angle) * what + np.sin(angle) * np.cross(axis, what) + (1 - np.cos(angle)) * (axis @ what) * axis)
