"""Boxes drawn by hand around people."""

import numpy as np

from models.arrays import Bool, Float


def inside(points_px: Float, box_px: Float) -> Bool:
    """Which points (..., 2) lie in a box (x0, y0, x1, y1)."""
    return np.asarray(((points_px >= box_px[:2]) & (points_px <= box_px[2:])).all(axis=-1))
