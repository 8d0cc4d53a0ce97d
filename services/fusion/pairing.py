"""How well two persons in the pictures of two cameras agree to be one, for all pairs of persons at once.

Eight cameras that see three people have 252 pairs of persons, nearly all of different people. What is worth being triangulated is
decided by the epipolar constraint alone: Sampson's distance, in sigmas, is what moves both points least so that their rays meet.
Source: Hartley and Zisserman, "Multiple View Geometry", ch. 9 and 11.4.
"""

from typing import Final

import numpy as np

from models.arrays import Float
from models.compiled import Counts
from services.fusion.config import TriangulationConfig
from services.fusion.views import Sighting, Views

_VIEWS: Final = 2
"""Both views may be off by an inlier's distance."""


def disagreements(views: Views, persons: list[Sighting], least: int, share: float, config: TriangulationConfig) -> Float:
    """(n, n) mean Geman-McClure cost of the joints that a pair has in common; infinite for pairs that are not one person.

    Args:
        views: the cameras.
        persons: n sightings at one instant.
        least, share: so many joints, and such a share of the common ones, must agree.
        config: robustness.
    """
    if not persons:
        return np.zeros((0, 0))
    cameras = np.array([person.camera for person in persons])
    usable = np.stack([person.usable for person in persons])
    common = usable[:, None] & usable & (cameras[:, None] != cameras)[..., None]
    distance2 = np.where(common, _sampson2(views, cameras, persons), np.inf)
    agreeing = (distance2 <= _VIEWS * config.inlier_sigmas2).sum(axis=2)
    scale2 = _VIEWS * config.robust_sigmas**2
    cost = np.where(common, 1.0 - scale2 / (distance2 + scale2), 0.0).sum(axis=2)
    count = common.sum(axis=2)
    agreed = agreeing >= np.maximum(least, share * count)
    return np.where(agreed, cost / np.maximum(count, 1), np.inf)


def _sampson2(views: Views, cameras: Counts, persons: list[Sighting]) -> Float:
    """(n, n, 17) squared Sampson distances in sigmas of all pairs of sightings."""
    points = np.stack([person.points_px for person in persons])
    pixels = np.concatenate((points, np.ones_like(points[..., :1])), axis=2)
    variance = np.stack([person.sigma_px for person in persons]) ** 2
    rays = np.einsum("nij,nkj->nki", views.rays[cameras], pixels)
    base = views.centres_m[cameras][:, None] - views.centres_m[cameras]
    # The epipolar plane's normal for i's ray and j's centre, seen as a line in j's picture.
    normals = np.cross(base[:, :, None], rays[:, None])
    lines = np.einsum("mij,nmki->nmkj", views.rays[cameras], normals)
    across = np.einsum("nmkj,mkj->nmk", lines, pixels)
    spread = (lines[..., :2] ** 2).sum(axis=3) * variance
    with np.errstate(divide="ignore", invalid="ignore"):
        distance2: Float = across**2 / (spread + spread.swapaxes(0, 1))
    return distance2
