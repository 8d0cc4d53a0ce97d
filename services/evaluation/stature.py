"""How tall a pupil is, from the lengths between his joints.

Thigh, shank, trunk and neck together are most of a standing body, whatever its proportions, so their sum says more than any single
bone (Trotter and Gleser, "Estimation of stature from long bones of American Whites and Negroes", Am. J. Physical Anthropology 10,
1952: 3 to 4 cm from one bone). The line was fitted to 1500 bodies of 5 to 60 years of the shipped model, whose own residual is
0.4 %; people differ from one another by more than its bodies do, which the sigma allows for.
"""

import math
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
_GUESSED: Final = 0.08
"""Of a length that no frame shows but by guessed joints: so far it may be off, as a share of it."""
_TRUNK_QUANTILE: Final = 0.75
"""A bent back brings shoulders and hips together; of all lengths of a trunk the longer ones are of the straight one."""
_FEWEST: Final = 5
"""Frames that show a length."""
_OF_MEDIAN: Final = 1.25
"""Standard deviation of a median over that of a mean."""


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
    """Estimate it over all frames of a track: from joints that were seen; of a length that they do not show, from guessed ones."""
    seen = _lengths(np.where(track.seen[..., None], track.joints_m, np.nan))
    total, variance = 0.0, _lengths_sigma_m(model) ** 2
    for (lengths, quantile), (guessed, _) in zip(seen, _lengths(track.joints_m), strict=True):
        length, scatter = _typical(lengths, quantile, track.frame_s, model)
        if math.isnan(length):
            length, scatter = _typical(guessed, quantile, track.frame_s, model)
            scatter = math.hypot(scatter, _GUESSED * length)
        total += length
        variance += scatter**2
    metres = SLOPE * total + CONSTANT_M
    return Stature(metres, math.hypot(_PEOPLE * metres, SLOPE * math.sqrt(variance)))


def _lengths(joints_m: Float) -> list[tuple[Float, float]]:
    """Thigh, shank, trunk and neck of (T, 17, 3) joints: in each frame, NaN where not shown, and which quantile of them counts."""
    points = {name: joints_m[:, index] for name, index in coco.INDEX.items()}
    shoulders, hips, ears = (_middle(points, part) for part in ("shoulder", "hip", "ear"))
    thighs, shanks = (_sides(points, *ends) for ends in (("hip", "knee"), ("knee", "ankle")))
    trunk, neck = (np.linalg.norm(above - below, axis=1) for above, below in ((shoulders, hips), (ears, shoulders)))
    half = 0.5
    return [(thighs, half), (shanks, half), (trunk, _TRUNK_QUANTILE), (neck, half)]


def _typical(lengths: Float, quantile: float, frame_s: float, model: Uncertainty) -> tuple[float, float]:
    """Of lengths, and what it may be off by chance; NaN where too few are known."""
    known = lengths[np.isfinite(lengths)]
    if len(known) < _FEWEST:
        return math.nan, math.nan
    # Frames that follow one another have nearly the same noise.
    independent = model.independent(len(known), frame_s)
    return float(np.quantile(known, quantile)), _OF_MEDIAN * float(known.std()) / math.sqrt(independent)


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
