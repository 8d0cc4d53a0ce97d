"""The trunk in a picture: where it points, so that a crop can be turned with it."""

import math

from models.arrays import Bool, Float
from models.skeleton import coco

_LEFT_SHOULDER, _RIGHT_SHOULDER, _LEFT_HIP, _RIGHT_HIP = coco.TRUNK


def lean_rad(points_px: Float, known: Bool, shortest_px: float) -> float | None:
    """Angle of the trunk, 0 upright and positive leaning to +x on the screen.

    Args:
        points_px: (17, 2) COCO keypoints, y down.
        known: (17,) which of them to believe.
        shortest_px: a trunk shorter than this says nothing: the person bends towards the camera or away.

    Returns:
        The angle within +-pi, or None if it cannot be told.
    """
    if not known[list(coco.TRUNK)].all():
        return None
    shoulders = (points_px[_LEFT_SHOULDER] + points_px[_RIGHT_SHOULDER]) / 2
    hips = (points_px[_LEFT_HIP] + points_px[_RIGHT_HIP]) / 2
    x, y = (float(value) for value in shoulders - hips)
    return math.atan2(x, -y) if math.hypot(x, y) >= shortest_px else None
