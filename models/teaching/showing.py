"""What a performance must show to be a standard. Pure.

Whoever is compared with a limb that nobody saw, or with somebody who only stands there, is told nothing, or something wrong; so the
same is asked of every performance, whether it comes from a lesson, from another program, or in a file of another school.
"""

from itertools import pairwise
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.motions.motion import Handed
from models.skeleton import coco
from models.teaching.measure import PHASES
from models.teaching.standard import FRAME_S, Exemplar, Moments, NoStandardError, Standard, decode

LEAST_SEEN: Final = 0.5
"""Share of the frames between two keyframes in which a limb's joint must be known."""
_LIMBS: Final = tuple(range(coco.INDEX["left_shoulder"], coco.COUNT))
_FLOOR: Final = (-0.03, 0.13)
"""Where ankles are that are down, as a share of the stature above the floor."""
_LOW: Final = 0.1
"""Of an ankle's heights so many are of one that is down."""
_LEAST_MOVED: Final = 0.1
"""Of the stature, by the limb that moves most."""
_ANKLES: Final = (coco.INDEX["left_ankle"], coco.INDEX["right_ankle"])


class PerformanceError(ValueError):
    """Why a performance can be no standard, in words that go on after its name."""


def decode_own(data: bytes, name: str) -> Standard:
    """Read a standard's file that KineBox does not bring: `decode`, and its performances must show enough.

    Raises:
        NoStandardError: as `decode`, or why its performances show too little.
        UserError: as `decode`.
    """
    standard = decode(data, name)
    try:
        for one in (standard.performance, *standard.exemplars):
            require_seen(one.joints_m, one.moments_s)
            require_movement(one, standard.stature_m)
        require_floor(standard.performance, standard.stature_m)
    except PerformanceError as error:
        raise NoStandardError(f"{name}: its performance {error}; take the file of another one") from error
    return standard


def require_seen(joints_m: Float, moments_s: Moments, handed: Handed = "right") -> None:
    """A limb that is hidden in a whole phase would be grey for every pupil from now on.

    Args:
        joints_m: (T, 17, 3), its right side leading; NaN is unknown.
        moments_s: keyframes, seconds from the first frame.
        handed: the side that led when it was performed, by which joints are called.

    Raises:
        PerformanceError: names the joints, and from where to where they are unknown.
    """
    known: Bool = np.asarray(np.isfinite(joints_m).all(axis=2))
    hidden = []
    for (begins, begin_s), (ends, end_s) in pairwise(zip(PHASES, moments_s, strict=True)):
        share = known[_frames(begin_s, end_s, len(known))].mean(axis=0)
        names = [_own_name(joint, handed) for joint in _LIMBS if share[joint] < LEAST_SEEN]
        if names:
            told = " and ".join(names) if len(names) < len(_LIMBS) else "whole body"
            hidden.append(f"the {told} from {begins} to {ends}")
    if hidden:
        raise PerformanceError(f"was not seen well enough: too little of {'; of '.join(hidden)}")


def require_floor(performance: Exemplar, stature_m: float) -> None:
    """The feet are down now and then; PerformanceError. Joints must have been seen."""
    # Not the lowest of all: in a roll an ankle is sometimes taken to be below the floor for a moment.
    low_m = float(np.nanquantile(performance.joints_m[:, _ANKLES, 2], _LOW))
    if not _FLOOR[0] <= low_m / stature_m <= _FLOOR[1]:
        raise PerformanceError(
            f"does not stand on the floor at height 0: of a pupil of {stature_m:.2f} m the ankles come down to {low_m:.2f} m"
        )


def require_movement(performance: Exemplar, stature_m: float) -> None:
    """A limb moves; PerformanceError. Joints must have been seen."""
    start_s, end_s = performance.moments_s[0], performance.moments_s[-1]
    limbs = performance.joints_m[_frames(start_s, end_s, len(performance.joints_m))][:, _LIMBS]
    if np.max(np.nanmax(limbs, axis=0) - np.nanmin(limbs, axis=0)) < _LEAST_MOVED * stature_m:
        raise PerformanceError("hardly moves between its keyframes")


def _frames(begin_s: float, end_s: float, count: int) -> slice:
    """Those from one instant to another; at least one, though the last may be half a frame past all."""
    first, last = (min(round(instant_s / FRAME_S), count - 1) for instant_s in (begin_s, end_s))
    return slice(first, last + 1)


def _own_name(joint: int, handed: Handed) -> str:
    """Of a joint of the standard, what it is of the pupil."""
    return coco.NAMES[coco.MIRROR[joint] if handed == "left" else joint].replace("_", " ")
