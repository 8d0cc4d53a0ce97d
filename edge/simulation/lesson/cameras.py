"""The cameras that a lesson plan asks for."""

from dataclasses import replace

import numpy as np
from msgspec import UNSET

from edge.simulation.lesson.plan import Plan
from edge.simulation.rigs.arrangements import make_rig
from models.camera.pinhole import Camera
from models.camera.rig import Rig
from models.errors import UserError


def rig_of(plan: Plan) -> Rig:
    """The cameras of a plan, as they are calibrated.

    Raises:
        UserError: there is no such rig, or it has fewer cameras.
    """
    rig = make_rig(plan.rig, plan.split, plan.seed)
    count = len(rig) if plan.cameras is UNSET else plan.cameras
    if count > len(rig):
        raise UserError(f"cameras: rig '{plan.rig}' has {len(rig)}, not {count}; ask for fewer, or name another rig")
    cameras = rig.cameras[:count]
    return Rig(cameras if plan.size_px is UNSET else tuple(resized(camera, plan.size_px) for camera in cameras))


def resized(camera: Camera, size_px: tuple[int, int]) -> Camera:
    """The same camera with pictures of another size: as wide as before, and as high as that then shows."""
    scale = size_px[0] / camera.size_px[0]
    matrix = camera.matrix_px.copy()
    matrix[:2, :2] *= scale
    # Pixel centres are at whole numbers: the middle of a picture w wide is at (w - 1) / 2.
    middle, before = (np.asarray(size, np.float64) / 2 - 0.5 for size in (size_px, camera.size_px))
    matrix[:2, 2] = middle + (matrix[:2, 2] - before) * scale
    return replace(camera, size_px=size_px, matrix_px=matrix)
