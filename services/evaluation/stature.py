"""How tall a pupil is, from the lengths between his joints.

Thigh, shank, trunk and neck together are most of a standing body, whatever its proportions, so their sum says more than any single
bone (Trotter and Gleser, "Estimation of stature from long bones of American Whites and Negroes", Am. J. Physical Anthropology 10,
1952: 3 to 4 cm from one bone). The line was fitted to 1500 bodies of 5 to 60 years of the shipped model, whose own residual is
0.4 %; people differ from one another by more than its bodies do, which the sigma allows for.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float
from models.skeleton import coco
from services.evaluation.track import Track
from services.evaluation.uncertainty import NETWORK, Uncertainty

SLOPE: Final = 1.091
CONSTANT_M: Final = 0.083
"""Stature = `SLOPE` (thigh + shank + trunk + neck) + `CONSTANT_M`."""
_PEOPLE: Final = 0.012
"""What people of the same lengths differ in stature, as a share of it."""
_TRUNK_QUANTILE: Final = 0.75
"""A bent back brings shoulders and hips together; of all lengths of a trunk the longer ones are of the straight one."""
_FEWEST: Final = 5
"""Frames that show a length."""


@dataclass(frozen=True)
class Stature:
    """An estimate, or what somebody measured.

    Attributes:
        metres: standing height without shoes; NaN if the track does not tell.
        sigma_m: its standard deviation; NaN if it is not known.
    """

    metres: float
    sigma_m: float


def stature_of(track: Track, model: Uncertainty = NETWORK) -> Stature:
    """Estimate it over all frames of a track."""
    lengths = lengths_m(track.joints_m)
    slope_sigma_m = SLOPE * _lengths_sigma_m(model)
    metres = SLOPE * float(lengths.sum()) + CONSTANT_M
    return Stature(metres, float(np.hypot(_PEOPLE * metres, slope_sigma_m)))


def lengths_m(joints_m: Float) -> Float:
    """(4,) thigh, shank, trunk, neck of (T, 17, 3) joints; NaN for those that too few frames show."""
    points = {name: joints_m[:, index] for name, index in coco.INDEX.items()}
    shoulders, hips, ears = (_middle(points, part) for part in ("shoulder", "hip", "ear"))
    thighs, shanks = (_sides(points, *ends) for ends in (("hip", "knee"), ("knee", "ankle")))
    trunk, neck = (np.linalg.norm(above - below, axis=1) for above, below in ((shoulders, hips), (ears, shoulders)))
    half = 0.5
    return np.array([_typical(*one) for one in ((thighs, half), (shanks, half), (trunk, _TRUNK_QUANTILE), (neck, half))])


def _typical(lengths: Float, quantile: float) -> float:
    known = lengths[np.isfinite(lengths)]
    return float(np.quantile(known, quantile)) if len(known) >= _FEWEST else float("nan")


def _sides(points: dict[str, Float], near: str, far: str) -> Float:
    """Lengths of both sides one after the other: where one is hidden the other one tells."""
    return np.concatenate(
        [np.linalg.norm(points[f"{side}_{near}"] - points[f"{side}_{far}"], axis=1) for side in ("left", "right")]
    )


def _middle(points: dict[str, Float], part: str) -> Float:
    return (points[f"left_{part}"] + points[f"right_{part}"]) / 2


def _lengths_sigma_m(model: Uncertainty) -> float:
    """Of the sum of lengths: inner joints cancel where limbs are in line; ears and ankles stay."""
    return float(np.hypot(model.landmark_m[coco.INDEX["left_ear"]], model.landmark_m[coco.INDEX["left_ankle"]]))
