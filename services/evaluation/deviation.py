"""How far each joint is from the standard in each frame, and which colour that is.

A joint is green where it is surely within the limit, red where it is surely beyond twice the limit, yellow between. The limit is
the action's tolerance for the joint, or what good performances differ by, whichever is larger. Where it was not seen, or the error
of its place is too large to tell, it is grey: a colour that nobody can vouch for is never shown.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float, UInt8
from models.interpolation import between
from models.messages.feedback import Colour
from models.skeleton import coco
from models.teaching.schema import Tolerance
from models.teaching.standard import Standard
from services.evaluation.alignment import AlignedTrack
from services.evaluation.normalise import size_m
from services.evaluation.signals.reading import rate
from services.evaluation.track import Track
from services.evaluation.uncertainty import NETWORK, Uncertainty

SPREADS: Final = 2.0
"""Good performances differ by up to so many of their own standard deviations."""
RED: Final = 2.0
"""Red begins at so many limits."""
TOO_UNCERTAIN: Final = 0.75
"""A joint whose error is larger than this share of its limit is grey."""
_HEAD: Final = ("nose", "eye", "ear")
_HIPS: Final = (coco.INDEX["left_hip"], coco.INDEX["right_hip"])
_LEFT: Final = (coco.INDEX["left_shoulder"], coco.INDEX["left_hip"])
_RIGHT: Final = (coco.INDEX["right_shoulder"], coco.INDEX["right_hip"])


@dataclass(frozen=True, eq=False)
class Deviation:
    """Of an attempt from its standard.

    Attributes:
        distance: (T, 17) in limits: 1 is as far as may be; NaN where unknown.
        sigma: (T, 17) standard deviation of that; NaN where unknown.
        colours: (T, 17) `Colour`.
    """

    distance: Float
    sigma: Float
    colours: UInt8


def deviate(
    aligned: AlignedTrack, track: Track, standard: Standard, tolerance: Tolerance, model: Uncertainty = NETWORK
) -> Deviation:
    """Compare an attempt with its standard, joint by joint.

    Args:
        aligned: the track along the standard.
        track: the same that was aligned, leading with the right (`services.evaluation.normalise.lead_right`). Colours are of its
            joints: of a pupil who leads with the left, exchange left and right (`models.skeleton.coco.MIRROR`).
        standard: the same, too.
        tolerance: of the action.
        model: of the joints' errors.
    """
    apart = aligned.joints_m - between(aligned.standard_m, aligned.frames)
    metres = np.linalg.norm(apart, axis=2)
    limits = between(np.fmax(tolerances_m(tolerance, standard.stature_m), SPREADS * standard.spread_m), aligned.frames)
    distance = metres / limits
    with np.errstate(invalid="ignore", divide="ignore"):
        towards = apart / metres[..., None]
    sigma = _sigma_m(aligned, track, np.nan_to_num(towards), model) / limits
    sigma = np.where(np.isfinite(distance), sigma, np.nan)
    return Deviation(distance, sigma, colours_of(distance, sigma, track))


def colours_of(distance: Float, sigma: Float, track: Track) -> UInt8:
    """(T, 17) `Colour` of distances in limits, (T, 17), and their standard deviations."""
    with np.errstate(invalid="ignore"):
        judged = track.seen & np.isfinite(distance) & (sigma <= TOO_UNCERTAIN)
        colours = np.full(distance.shape, Colour.YELLOW, np.uint8)
        colours[distance + sigma <= 1] = Colour.GREEN
        colours[distance - sigma > RED] = Colour.RED
    colours[~judged] = Colour.GREY
    return colours


def tolerances_m(tolerance: Tolerance, stature_m: float) -> Float:
    """(17,) of the joints of somebody of this stature."""
    parts = [name.split("_")[-1] for name in coco.NAMES]
    return np.array([getattr(tolerance, "head" if part in _HEAD else part) for part in parts]) * stature_m / 100


def _sigma_m(aligned: AlignedTrack, track: Track, towards: Float, model: Uncertainty) -> Float:
    """(T, 17) standard deviation of the distance along (T, 17, 3) unit vectors in the standard's frame."""
    turn = aligned.placing.matrix
    scales, landmarks = np.square(model.noise_scale)[:, None, None], np.square(model.landmark_m)[:, None, None]
    joints = scales * track.covariance_m2 + landmarks * np.eye(3)
    # The middle of the hips is above the origin: its error moves all joints. Both hips are wrong alike: it is as large as theirs.
    hips = joints[:, _HIPS].mean(axis=1) * np.outer((1, 1, 0), (1, 1, 0))
    covariance = turn @ (joints + hips[:, None]) @ turn.T
    along = np.einsum("tja,tjab,tjb->tj", towards, covariance, towards)
    # Where the distance is about nothing it has no direction, and the error is in all of them.
    nowhere = np.trace(covariance, axis1=2, axis2=3) / 3
    for moved in _of_the_whole(aligned, track.frame_s, model):
        along, nowhere = along + (towards * moved).sum(axis=2) ** 2, nowhere + (moved**2).sum(axis=2) / 3
    return np.asarray(np.sqrt(np.where((towards == 0).all(axis=2), nowhere, along)))


def _of_the_whole(aligned: AlignedTrack, frame_s: float, model: Uncertainty) -> tuple[Float, Float, Float]:
    """(T, 17, 3) each: how far every joint is moved by one standard deviation of where the body is taken to face, of how large it
    is taken to be, and of when it is where it is."""
    joints, scale = aligned.joints_m, aligned.placing.scale
    width = float(np.nanmedian(np.linalg.norm(joints[:, _LEFT].sum(axis=1) - joints[:, _RIGHT].sum(axis=1), axis=1)))
    errors = np.array(model.landmark_m)[:, None] * model.mixed
    turn = scale * float(np.linalg.norm(errors[_LEFT, :].sum(axis=0) - errors[_RIGHT, :].sum(axis=0))) / width
    ends = np.hypot(model.landmark_m[coco.INDEX["left_shoulder"]], model.landmark_m[coco.INDEX["left_ankle"]])
    growth = scale * float(ends) / size_m(joints)
    return turn * joints[..., [1, 0, 2]] * (-1.0, 1.0, 0.0), growth * joints, model.timing_s * np.nan_to_num(rate(joints, frame_s))
