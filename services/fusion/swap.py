"""Left-right swap repair.

Seen from behind or from the side, a network confuses left and right: of the whole body, of an arm or leg from some joint
outwards, or of eyes and ears. Each way of exchanging is weighed against what fusion expects the camera to see.
"""

from dataclasses import replace
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.compiled import compiled
from models.skeleton import coco
from services.fusion.joint_filter import Expectation
from services.fusion.views import Sighting

_INDEX = coco.INDEX
_CHAINS: Final = np.array(
    [
        [_INDEX["left_shoulder"], _INDEX["left_elbow"], _INDEX["left_wrist"]],
        [_INDEX["left_hip"], _INDEX["left_knee"], _INDEX["left_ankle"]],
        [_INDEX["left_eye"], _INDEX["left_ear"], _INDEX["left_ear"]],
    ]
)
_MIRROR: Final = np.array(coco.MIRROR)
_CLIP: Final = 16.0
"""Squared distance in sigmas beyond which one more does not count: an outlier decides nothing."""
_MARGIN: Final = 8.0
"""How much better an exchange must be before it is believed."""
_ALONE: Final = 24.0
"""The same for a head that turns without arms and legs: eyes and ears are close together, and noise would turn them."""
_HEAD: Final = 2


def repair(sighting: Sighting, expected: Expectation) -> tuple[Sighting, Bool]:
    """The sighting with left and right as expected, and which joints were exchanged (17,)."""
    seen = sighting.points_px, sighting.sigma_px, sighting.usable
    swapped = find_swaps(*seen, expected.points_px, expected.variance_px2, expected.known, _CHAINS, _MIRROR, _CLIP, _MARGIN, _ALONE)
    return exchange(sighting, swapped), swapped


def exchange(sighting: Sighting, swapped: Bool) -> Sighting:
    """The sighting with the flagged joints (17,), which come in pairs, exchanged for their counterparts."""
    if not swapped.any():
        return sighting
    order = np.where(swapped, _MIRROR, np.arange(coco.COUNT))
    return replace(sighting, points_px=sighting.points_px[order], sigma_px=sighting.sigma_px[order], usable=sighting.usable[order])


@compiled
def find_swaps(
    points: Float,
    sigma: Float,
    usable: Bool,
    expected: Float,
    variance: Float,
    known: Bool,
    chains: Float,
    mirror: Float,
    clip: float,
    margin: float,
    margin_alone: float,
) -> Bool:
    """For each chain, exchange nothing, or everything from one of its joints outwards, whichever fits best."""
    swapped = np.zeros(points.shape[0], np.bool_)
    gain = np.empty(chains.shape[1])
    for chain in range(chains.shape[0]):
        for level in range(chains.shape[1]):
            gain[level] = 0.0
            left = chains[chain, level]
            right = mirror[left]
            if level and chains[chain, level - 1] == left:
                continue
            for seen, place in ((left, left), (right, right), (left, right), (right, left)):
                if usable[seen] and known[place]:
                    du, dv = points[seen, 0] - expected[place, 0], points[seen, 1] - expected[place, 1]
                    distance2 = min((du * du + dv * dv) / (sigma[seen] ** 2 + variance[place]), clip)
                    gain[level] += distance2 if seen == place else -distance2
        turned = swapped[chains[0, 0]] and swapped[chains[1, 0]]
        best, best_level, total = margin_alone if chain == _HEAD and not turned else margin, -1, 0.0
        for level in range(chains.shape[1] - 1, -1, -1):
            total += gain[level]
            if total > best:
                best, best_level = total, level
        if best_level >= 0:
            for level in range(best_level, chains.shape[1]):
                swapped[chains[chain, level]] = True
                swapped[mirror[chains[chain, level]]] = True
    return swapped
