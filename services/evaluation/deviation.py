"""How far each joint is from the standard in each frame, and which colour that is.

A joint is green where it is surely within the limit, red where it is surely beyond twice the limit, yellow between. The limit is
the action's tolerance for the joint, or what good performances differ by, whichever is larger. Where it was not seen, or the hips
and the heading by which it is compared were not, or the error of its place is too large to tell, it is grey: a colour that nobody
can vouch for is never shown. An error is as large as it is in its worst direction: two cameras side by side know hardly anything of
how far away a joint is.
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Bool, Float, UInt8
from models.interpolation import between
from models.messages.feedback import Colour
from models.skeleton import coco
from models.teaching.schema import Tolerance
from models.teaching.standard import Standard
from services.evaluation.alignment import AlignedTrack
from services.evaluation.normalise import size_m
from services.evaluation.signals.reading import rate
from services.evaluation.track import Track
from services.evaluation.uncertainty import NETWORK, Uncertainty, roots

SPREADS: Final = 2.0
"""Good performances differ by up to so many of their own standard deviations."""
RED: Final = 2.0
"""Red begins at so many limits."""
TOO_UNCERTAIN: Final = 0.75
"""A joint whose error is, in any direction, larger than this share of its limit is grey."""
_HEAD: Final = ("nose", "eye", "ear")
_HIPS: Final = (coco.INDEX["left_hip"], coco.INDEX["right_hip"])
_LEFT: Final = (coco.INDEX["left_shoulder"], coco.INDEX["left_hip"])
_RIGHT: Final = (coco.INDEX["right_shoulder"], coco.INDEX["right_hip"])


@dataclass(frozen=True, eq=False)
class Deviation:
    """Of an attempt from its standard.

    Attributes:
        distance: (T, 17) in limits: 1 is as far as may be; NaN where unknown.
        sigma: (T, 17) standard deviation of that, along the line to where it should be; NaN where unknown.
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
        towards = np.nan_to_num(apart / metres[..., None])
        covariance = _covariance_m2(aligned, track, model) / limits[..., None, None] ** 2
    known = np.isfinite(distance)
    covariance[~known] = 0.0
    whole = np.trace(covariance, axis1=2, axis2=3)
    # Where the distance is nothing it has no direction, and the error is in all of them.
    nowhere = (towards == 0).all(axis=2)
    along = np.where(nowhere, whole / 3, np.einsum("tja,tjab,tjb->tj", towards, covariance, towards)).clip(0.0, whole)
    sigma = np.where(known, np.sqrt(along), np.nan)
    widest = np.sqrt(np.linalg.eigvalsh(covariance)[..., -1])
    judged = _seen(aligned, track) & known & (widest <= TOO_UNCERTAIN)
    return Deviation(distance, sigma, _colours(distance, sigma, judged))


def _seen(aligned: AlignedTrack, track: Track) -> Bool:
    """(T, 17) where a joint was seen, and so was what it is compared by: both hips, and to where the pupil looked at first."""
    hips = track.seen[:, _HIPS].all(axis=1, keepdims=True)
    heading = track.seen[aligned.placing.frames, :][:, coco.TRUNK].all()
    return np.asarray(track.seen & hips & heading)


def _colours(distance: Float, sigma: Float, judged: Bool) -> UInt8:
    """(T, 17) `Colour` of distances in limits, (T, 17), and their standard deviations; grey where they are not judged."""
    colours = np.full(judged.shape, Colour.YELLOW, np.uint8)
    with np.errstate(invalid="ignore"):
        colours[distance + sigma <= 1] = Colour.GREEN
        colours[distance - sigma > RED] = Colour.RED
    colours[~judged] = Colour.GREY
    return colours


def tolerances_m(tolerance: Tolerance, stature_m: float) -> Float:
    """(17,) of the joints of somebody of this stature."""
    parts = [name.split("_")[-1] for name in coco.NAMES]
    return np.array([getattr(tolerance, "head" if part in _HEAD else part) for part in parts]) * stature_m / 100


def _covariance_m2(aligned: AlignedTrack, track: Track, model: Uncertainty) -> Float:
    """(T, 17, 3, 3) of the joints' places in the standard's frame."""
    turn = aligned.placing.matrix
    grown = model.grown(track.joints_m)
    scales, landmarks = (np.square(grown * sizes)[..., None, None] for sizes in (model.noise_scale, model.landmark_m))
    noise = scales * track.covariance_m2
    joints = noise + landmarks * np.eye(3)
    # The middle of the hips is above the origin: its error moves all joints. Both hips are wrong alike: it is as large as theirs.
    hips = joints[:, _HIPS].mean(axis=1) * np.outer((1, 1, 0), (1, 1, 0))
    covariance = turn @ (joints + hips[:, None]) @ turn.T
    heading_rad = _heading_sigma_rad(aligned, turn @ noise @ turn.T, track.frame_s, model)
    for moved in _of_the_whole(aligned, heading_rad, track.frame_s, model):
        covariance += moved[..., :, None] * moved[..., None, :]
    return np.asarray(covariance)


def _heading_sigma_rad(aligned: AlignedTrack, noise_m2: Float, frame_s: float, model: Uncertainty) -> float:
    """Standard deviation of where the body is taken to face, by (T, 17, 3, 3) noise in the standard's frame.

    The line of shoulders and hips is wrong by their landmarks, in all frames alike, and by the noise of the frames of which the
    heading is the mean; in those the body looks along x.
    """
    joints, frames = aligned.joints_m, aligned.placing.frames
    width = float(np.nanmedian(np.linalg.norm(joints[:, _LEFT].sum(axis=1) - joints[:, _RIGHT].sum(axis=1), axis=1)))
    errors = np.array(model.landmark_m)[:, None] * model.mixed
    landmarks_m = aligned.placing.scale * float(np.linalg.norm(errors[_LEFT, :].sum(axis=0) - errors[_RIGHT, :].sum(axis=0)))
    noise = model.mixed[:, :, None] * roots(noise_m2[frames, :])[..., 0, None, :]
    turning = noise[:, _LEFT].sum(axis=1) - noise[:, _RIGHT].sum(axis=1)
    noise_m = math.sqrt(float((turning**2).sum(axis=(1, 2)).mean()) / model.independent(len(frames), frame_s))
    return math.hypot(landmarks_m, noise_m) / width


def _of_the_whole(aligned: AlignedTrack, heading_rad: float, frame_s: float, model: Uncertainty) -> tuple[Float, Float, Float]:
    """(T, 17, 3) each: how far every joint is moved by one standard deviation of where the body is taken to face, of how large it
    is taken to be, and of when it is where it is."""
    joints, scale = aligned.joints_m, aligned.placing.scale
    ends = np.hypot(model.landmark_m[coco.INDEX["left_shoulder"]], model.landmark_m[coco.INDEX["left_ankle"]])
    growth = scale * float(ends) / size_m(joints)
    turned = heading_rad * joints[..., [1, 0, 2]] * (-1.0, 1.0, 0.0)
    return turned, growth * joints, model.timing_s * np.nan_to_num(rate(joints, frame_s))
