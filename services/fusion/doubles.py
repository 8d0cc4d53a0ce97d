"""A limb that the network names twice: once as the left one, once as the right one.

A network that does not find a foot, for it is hidden, swung, or beside a clearer one, often puts its point on the other foot. Where
both points of a pair lie together though they are expected apart, one picture has hardly seen both, and the point that is further
from where it is expected counts for little. Without that, several cameras that make the same mistake agree in space, on the other
foot. It does count for something: what is expected may be wrong, and hands do meet.
"""

from dataclasses import replace
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.compiled import Counts, compiled
from models.skeleton import coco
from services.fusion.joint_filter import Expectation
from services.fusion.views import Sighting, Views

_PAIRS: Final = np.array(
    [[coco.INDEX[f"{side}_{part}"] for side in ("left", "right")] for part in ("elbow", "wrist", "knee", "ankle")]
)
"""Limbs: shoulders and hips, eyes and ears are seen one behind the other all the time."""
_TOGETHER: Final = 0.4
"""Points that are nearer to each other than this share of what is expected are one and the same."""
_ONE_M: Final = 0.06
"""Points that are nearer to each other, across the line of sight, may be of one limb."""
_GATE: Final = 4.0
"""Squared distance in sigmas from where it is expected, within which a point is not doubted."""


def single(sighting: Sighting, expected: Expectation, doubt: float) -> Sighting:
    """The sighting with the sigma of points that double another one multiplied by `doubt`."""
    seen = sighting.points_px, sighting.sigma_px, sighting.usable
    doubled = find_doubles(*seen, expected.points_px, expected.variance_px2, expected.known, _PAIRS, _TOGETHER, _GATE)
    return replace(sighting, sigma_px=np.where(doubled, doubt, 1.0) * sighting.sigma_px) if doubled.any() else sighting


@compiled
def find_doubles(
    points: Float,
    sigma: Float,
    usable: Bool,
    expected: Float,
    variance: Float,
    known: Bool,
    pairs: Counts,
    together: float,
    gate: float,
) -> Bool:
    """(J,) which points are another limb's: of each pair at most one."""
    doubled = np.zeros(points.shape[0], np.bool_)
    for pair in range(pairs.shape[0]):
        left, right = pairs[pair]
        if not (usable[left] and usable[right] and known[left] and known[right]):
            continue
        seen2 = (points[left, 0] - points[right, 0]) ** 2 + (points[left, 1] - points[right, 1]) ** 2
        apart2 = (expected[left, 0] - expected[right, 0]) ** 2 + (expected[left, 1] - expected[right, 1]) ** 2
        if seen2 > together * together * apart2:
            continue
        worst, worst2 = left, 0.0
        for joint in pairs[pair]:
            du, dv = points[joint, 0] - expected[joint, 0], points[joint, 1] - expected[joint, 1]
            distance2 = (du * du + dv * dv) / (sigma[joint] ** 2 + variance[joint])
            if distance2 > worst2:
                worst, worst2 = joint, distance2
        doubled[worst] = worst2 > gate
    return doubled


def untwinned(views: Views, points: Float, usable: Bool, centre_m: Float) -> Bool:
    """(C, 17) which points may be triangulated from without any memory: none that could be the other limb's.

    Where at least two cameras see the limbs of a pair apart, those that see them together do not count: limbs do lie one before the
    other in some pictures, but then the others suffice.

    Args:
        views: the cameras.
        points, usable: (C, 17, 2) undistorted pixels and (C, 17) of one instant.
        centre_m: (3,) the body's centre then.
    """
    return find_apart(points, usable, views.projections, np.append(centre_m, 1.0), _PAIRS, _ONE_M)


@compiled
def find_apart(points: Float, usable: Bool, projections: Float, centre: Float, pairs: Counts, one_m: float) -> Bool:
    """The kernel of `untwinned`; `centre` is homogeneous."""
    out = usable.copy()
    cameras = projections.shape[0]
    together = np.zeros(cameras, np.bool_)
    for pair in range(pairs.shape[0]):
        left, right = pairs[pair]
        apart = 0
        for camera in range(cameras):
            p = projections[camera]
            focal = np.sqrt(p[0, 0] ** 2 + p[0, 1] ** 2 + p[0, 2] ** 2)
            depth = p[2, 0] * centre[0] + p[2, 1] * centre[1] + p[2, 2] * centre[2] + p[2, 3]
            both = usable[camera, left] and usable[camera, right]
            du, dv = points[camera, left, 0] - points[camera, right, 0], points[camera, left, 1] - points[camera, right, 1]
            together[camera] = both and np.sqrt(du * du + dv * dv) * depth < one_m * focal
            apart += both and not together[camera]
        if apart >= 2:
            for camera in range(cameras):
                if together[camera]:
                    out[camera, left] = out[camera, right] = False
    return out
