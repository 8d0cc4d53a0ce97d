"""How far each joint is from the standard in each frame, and which colour that is.

A joint is green where it is surely within the limit, red where it is surely beyond twice the limit, yellow between. The limit is
the action's tolerance for the joint, or what good performances differ by, whichever is larger. Where it was not seen, or the error
of its place is too large to tell, it is grey: a colour that nobody can vouch for is never shown.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float, UInt8
from models.compiled import Counts
from models.messages.feedback import Colour
from models.skeleton import coco
from models.teaching.schema import Tolerance
from models.teaching.standard import Standard
from services.evaluation.alignment import AlignedTrack
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
    frames = _frames(aligned)
    apart = aligned.joints_m[frames[:, 0]] - aligned.standard_m[frames[:, 1]]
    metres = np.linalg.norm(apart, axis=2)
    limits = np.fmax(tolerances_m(tolerance, standard.stature_m), SPREADS * standard.spread_m)[frames[:, 1]]
    distances = metres / limits
    # Of all frames of the standard that a frame of the pupil's is aligned with, the nearest counts: it is no fault to dwell.
    distance, nearest = _least(distances, frames[:, 0], len(track))
    with np.errstate(invalid="ignore", divide="ignore"):
        towards = apart[nearest, np.arange(coco.COUNT)] / metres[nearest, np.arange(coco.COUNT)][..., None]
    sigma = _sigma_m(aligned, track, np.nan_to_num(towards), model) / limits[nearest, np.arange(coco.COUNT)]
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


def _frames(aligned: AlignedTrack) -> Counts:
    """(L, 2) pairs of frames of the attempt and the standard; each pair once, in the order of the attempt."""
    return np.unique(aligned.alignment.path, axis=0).astype(np.int64)


def _least(values: Float, rows: Counts, count: int) -> tuple[Float, Counts]:
    """(count, J) least value of each row's entries, and its place among them; NaN where all are."""
    filled = np.where(np.isnan(values), np.inf, values)
    first = np.searchsorted(rows, np.arange(count))
    least = np.minimum.reduceat(filled, first, axis=0)
    places = np.empty(least.shape, np.int64)
    for row in range(count):
        end = first[row + 1] if row + 1 < count else len(rows)
        places[row] = first[row] + filled[first[row] : end].argmin(axis=0)
    return np.where(np.isinf(least), np.nan, least), places


def _sigma_m(aligned: AlignedTrack, track: Track, towards: Float, model: Uncertainty) -> Float:
    """(T, 17) standard deviation of the distance along (T, 17, 3) unit vectors in the standard's frame."""
    turn = aligned.placing.matrix
    scales, landmarks = np.square(model.noise_scale)[:, None, None], np.square(model.landmark_m)[:, None, None]
    joints = scales * track.covariance_m2 + landmarks * np.eye(3)
    hips = joints[:, _HIPS].sum(axis=1) / 4 * np.outer((1, 1, 0), (1, 1, 0))
    # The middle of the hips is above the origin: its error moves all joints, but the hips themselves by half of it less.
    covariance = turn @ (joints + hips[:, None]) @ turn.T
    along = np.einsum("tja,tjab,tjb->tj", towards, covariance, towards)
    # Where the distance is about nothing it has no direction, and the error is in all of them.
    nowhere = np.trace(covariance, axis1=2, axis2=3) / 3
    return np.asarray(np.sqrt(np.where((towards == 0).all(axis=2), nowhere, along)))
