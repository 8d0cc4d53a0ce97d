"""How a body's mass is shared among its segments, by age, and where its centre of mass is.

Shares of children: Jensen, "Changes in segment inertia proportions between 4 and 20 years", J. Biomechanics 22, 1989 (6 years),
and Jensen, "Body segment mass, radius and radius of gyration proportions of children", J. Biomechanics 19, 1986 (12 and 15 years);
measured on boys, used for girls, too. Adults: de Leva, "Adjustments to Zatsiorsky-Seluyanov's segment inertia parameters",
J. Biomechanics 29, 1996, table 4. Between the ages the shares are interpolated. The segments' own centres are de Leva's at every
age, but the head's, which is put between the ears (Winter, "Biomechanics and Motor Control of Human Movement", table 4.1).
"""

from typing import Final

import numpy as np

from models.arrays import Float
from models.body.prior import SEXES, Sex
from models.skeleton import coco, coco_feet, smpl

SEGMENTS: Final = (
    *("head", "trunk"),
    *(f"{side}_{part}" for part in ("upper_arm", "forearm", "hand", "thigh", "shank", "foot") for side in ("left", "right")),
)
"""The neck counts with the head at 6 years and, as the sources have it, with the trunk later."""

_CHILDREN_PERCENT: Final = {
    6.0: (18.2, 43.0, 2.4, 1.3, 0.8, 8.5, 4.6, 1.9),
    12.0: (10.1, 41.7, 3.2, 1.7, 0.9, 11.0, 5.3, 2.1),
    15.0: (6.7, 41.6, 3.5, 1.7, 0.8, 12.1, 5.6, 2.1),
}
"""Head, trunk, then upper arm, forearm, hand, thigh, shank and foot of one side."""
_GROWN_UP_YEARS: Final = 20.0
_ADULTS_PERCENT: Final = {
    "male": (6.94, 43.46, 2.71, 1.62, 0.61, 14.16, 4.33, 1.37),
    "female": (6.68, 42.57, 2.55, 1.38, 0.56, 14.78, 4.81, 1.29),
}
_AGES: Final = np.array((*_CHILDREN_PERCENT, _GROWN_UP_YEARS))

_LINES: Final = {
    "trunk": (("left_shoulder", "right_shoulder"), ("left_hip", "right_hip"), (0.4310, 0.3782)),
    "upper_arm": (("shoulder",), ("elbow",), (0.5772, 0.5754)),
    "forearm": (("elbow",), ("wrist",), (0.4574, 0.4559)),
    "hand": (("wrist",), ("hand",), (0.7900, 0.7474)),
    "thigh": (("hip",), ("knee",), (0.4095, 0.3612)),
    "shank": (("knee",), ("ankle",), (0.4395, 0.4352)),
    "foot": (("heel",), ("big_toe",), (0.4415, 0.4014)),
}
"""Segment: (from, to, share of the way for the sexes in the order of `SEXES`); two points mean their middle."""

_HAND_BEYOND: Final = 0.25
"""Of the forearm's length: 0.79 of a hand of 86 mm on a forearm of 269 mm."""


def mass_shares(age_years: float, sex: Sex) -> Float:
    """(14,) share of each of `SEGMENTS` in the body's mass; they sum to 1. Below 6 years as at 6, from 20 years as adults."""
    table = np.array((*_CHILDREN_PERCENT.values(), _ADULTS_PERCENT[sex]))
    shares = np.array([np.interp(age_years, _AGES, column) for column in table.T])
    both_sides = np.concatenate((shares[:2], np.repeat(shares[2:], 2)))
    return np.asarray(both_sides / both_sides.sum())


def coco_shares(age_years: float, sex: Sex | None = None) -> Float:
    """(17,) share of each COCO point in the centre of mass, where only these points are known; they sum to 1.

    A hand is in line with its forearm, its centre a quarter of the forearm's length (de Leva's lengths) beyond the wrist; a foot is
    where its ankle is. None takes the mean of the sexes.
    """
    return np.asarray(np.mean([_coco_shares(age_years, one) for one in (SEXES if sex is None else (sex,))], axis=0))


def _coco_shares(age_years: float, sex: Sex) -> Float:
    points = dict(zip(coco.NAMES, np.eye(coco.COUNT), strict=True))
    centres = [(points["left_ear"] + points["right_ear"]) / 2]
    for segment in SEGMENTS[1:]:
        side, part = ("", segment) if segment in _LINES else (segment[: segment.index("_") + 1], segment[segment.index("_") + 1 :])
        if part == "foot":
            centres.append(points[side + "ankle"])
        elif part == "hand":
            centres.append(points[side + "wrist"] + _HAND_BEYOND * (points[side + "wrist"] - points[side + "elbow"]))
        else:
            near, far, shares = _LINES[part]
            start, end = (np.mean([points[side + name] for name in names], axis=0) for names in (near, far))
            centres.append(start + shares[SEXES.index(sex)] * (end - start))
    return np.asarray(mass_shares(age_years, sex) @ np.array(centres))


def segment_centres_m(joints_m: Float, coco_m: Float, sex: Sex) -> Float:
    """(14, 3) centre of mass of each of `SEGMENTS`.

    Args:
        joints_m: (24, 3) as `Body.joints_m`.
        coco_m: (23, 3) as `Body.coco_m`.
        sex: of the person.
    """
    points = {**dict(zip(coco_feet.NAMES, coco_m, strict=True)), **dict(zip(smpl.NAMES, joints_m, strict=True))}
    centres = [(points["left_ear"] + points["right_ear"]) / 2]
    for segment in SEGMENTS[1:]:
        side, part = ("", segment) if segment in _LINES else (segment[: segment.index("_") + 1], segment[segment.index("_") + 1 :])
        near, far, shares = _LINES[part]
        start, end = (np.mean([points[side + name] for name in names], axis=0) for names in (near, far))
        centres.append(start + shares[SEXES.index(sex)] * (end - start))
    return np.array(centres)


def centre_of_mass_m(joints_m: Float, coco_m: Float, age_years: float, sex: Sex) -> Float:
    """(3,) centre of mass of the whole body. Arguments as `segment_centres_m` and `mass_shares`."""
    return np.asarray(mass_shares(age_years, sex) @ segment_centres_m(joints_m, coco_m, sex))
