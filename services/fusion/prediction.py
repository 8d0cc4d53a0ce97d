"""Where each camera will find the pupil: the loop back from 3D to the crops."""

from typing import Final

import numpy as np

from models.camera.pinhole import Camera
from models.messages.control import CropPrediction
from models.messages.observation import Crop
from models.skeleton.trunk import lean_rad
from services.fusion.person_estimates import PersonEstimates

CROP_MARGIN: Final = 1.3
"""Side of the crop over the extent of the joints: crown and toes reach beyond them, and a prediction errs."""
_MIN_JOINTS: Final = 5
_MIN_SIDE_PX: Final = 32.0
SHORT_TRUNK: Final = 0.1
"""Trunk length over the joints' extent under which its direction says nothing."""
_REACH: Final = 4.0
"""Sides of the picture within which a projected joint is believed."""
_VELOCITY_SPAN_S: Final = 0.05


def predict_crop(pupil: PersonEstimates, camera: Camera, t_ns: int) -> CropPrediction | None:
    """The pupil's crop in one camera at an instant; None if it is not known, or out of the picture."""
    t_s = t_ns * 1e-9
    joints_m, known = pupil.skeleton(t_s)
    if known.sum() < _MIN_JOINTS:
        return None
    pixels = camera.project(joints_m)
    # Near the camera's plane a joint is projected anywhere; where it is says nothing of where to look.
    known &= (np.abs(pixels) < _REACH * max(camera.size_px)).all(axis=1)
    if known.sum() < _MIN_JOINTS:
        return None
    extent_px = float(np.ptp(pixels[known], axis=0).max())
    lean = lean_rad(pixels, known, SHORT_TRUNK * extent_px)
    crop = Crop.around(pixels[known], lean or 0.0, CROP_MARGIN, _MIN_SIDE_PX)
    half = 0.5 * crop.side_px
    if not (-half < crop.centre_x_px < camera.size_px[0] + half and -half < crop.centre_y_px < camera.size_px[1] + half):
        return None
    ahead = camera.project(np.stack((pupil.body.at(t_s)[:3], pupil.body.at(t_s + _VELOCITY_SPAN_S)[:3])))
    velocity = (ahead[1] - ahead[0]) / _VELOCITY_SPAN_S
    if not (np.abs(ahead) < _REACH * max(camera.size_px)).all():
        velocity = np.zeros(2)
    return CropPrediction(crop, t_ns, float(velocity[0]), float(velocity[1]))
