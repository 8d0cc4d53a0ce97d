"""Where each camera will find the pupil: the loop back from 3D to the crops."""

import math
from typing import Final

import numpy as np

from models.arrays import Float
from models.camera.pinhole import Camera
from models.messages.control import CropPrediction
from models.messages.observation import Crop
from models.skeleton import coco
from services.fusion.pupil import Pupil

_MARGIN: Final = 1.3
"""Side of the crop over the extent of the joints: crown and toes reach beyond them, and a prediction errs."""
_MIN_JOINTS: Final = 5
_MIN_SIDE_PX: Final = 32.0
_VELOCITY_SPAN_S: Final = 0.05


def predict_crop(pupil: Pupil, camera: Camera, t_ns: int) -> CropPrediction | None:
    """The pupil's crop in one camera at an instant; None if it is not known, or out of the picture."""
    t_s = t_ns * 1e-9
    joints_m, known = pupil.skeleton(t_s)
    if known.sum() < _MIN_JOINTS:
        return None
    pixels = camera.project(joints_m)
    known &= np.isfinite(pixels).all(axis=1)
    if known.sum() < _MIN_JOINTS:
        return None
    crop = crop_around(pixels, known)
    half = 0.5 * crop.side_px
    if not (-half < crop.centre_x_px < camera.size_px[0] + half and -half < crop.centre_y_px < camera.size_px[1] + half):
        return None
    ahead = camera.project(np.stack((pupil.body.at(t_s)[:3], pupil.body.at(t_s + _VELOCITY_SPAN_S)[:3])))
    velocity = (ahead[1] - ahead[0]) / _VELOCITY_SPAN_S
    if not np.isfinite(velocity).all():
        velocity = np.zeros(2)
    return CropPrediction(crop, t_ns, float(velocity[0]), float(velocity[1]))


def crop_around(pixels: Float, known: np.typing.NDArray[np.bool_]) -> Crop:
    """The square, turned with the trunk, around the known (17,) of the joints (17, 2)."""
    angle = trunk_angle(pixels, known)
    c, s = math.cos(angle), math.sin(angle)
    turned = pixels[known] @ np.array(((c, -s), (s, c)))
    low, high = turned.min(axis=0), turned.max(axis=0)
    centre = 0.5 * (low + high) @ np.array(((c, s), (-s, c)))
    side = max(_MARGIN * float((high - low).max()), _MIN_SIDE_PX)
    return Crop(float(centre[0]), float(centre[1]), side, angle)


def trunk_angle(pixels: Float, known: np.typing.NDArray[np.bool_]) -> float:
    """Radians by which the trunk leans towards +x on the screen; 0 if it is not known or seen end-on."""
    if not known[list(coco.TRUNK)].all():
        return 0.0
    left_shoulder, right_shoulder, left_hip, right_hip = pixels[list(coco.TRUNK)]
    up = 0.5 * (left_shoulder + right_shoulder - left_hip - right_hip)
    extent = float(np.ptp(pixels[known], axis=0).max())
    if float(np.hypot(*up)) < 0.1 * extent:
        return 0.0
    return math.atan2(float(up[0]), float(-up[1]))
