"""From where the figures of an attempt are drawn: from the side; from the front where the movement or what was wrong goes aside.

One view for all figures of an attempt, fixed in the room, so that turning is seen as turning.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float
from models.motions.motion import Handed
from services.evaluation.normalise import facing, root_m
from services.evaluation.report.words import Seen

_UP: Final = np.array((0.0, 0.0, 1.0))
_ASIDE: Final = 3.0
"""Seen from the front is what gets so many times more aside than ahead from start to peak, as the joints' sum of squares. Stars and
wheels do by 80 and more; who turns sideways to hit does by 2, and is seen from the side."""


@dataclass(frozen=True, eq=False)
class View:
    """A direction of view along the floor.

    Attributes:
        across: (3,) unit vector to the right on the paper.
        towards: (3,) unit vector to whoever looks.
        seen: from where that is, of the pupil as he begins.
    """

    across: Float
    towards: Float
    seen: Seen

    def on_paper(self, places_m: Float) -> Float:
        """(..., 2) metres to the right and up, of (..., 3) places."""
        return np.stack((places_m @ self.across, places_m[..., 2]), axis=-1)

    def nearness_m(self, places_m: Float) -> Float:
        """(...) metres towards whoever looks."""
        return np.asarray(places_m @ self.towards)


def view_of(keyframes_m: Float, handed: Handed, apart_m: Float | None = None) -> View:
    """The view of an attempt.

    Args:
        keyframes_m: (4, 17, 3) how it should look at start, exertion, peak and end, in the world; NaN where unknown.
        handed: the side that leads, which is turned to whoever looks from the side.
        apart_m: (..., 17, 3) how far from there the pupil was, if that is what shall be seen; NaN where unknown.
    """
    ahead = _ahead(keyframes_m)
    left = np.cross(_UP, ahead)
    start, _, peak, _ = keyframes_m - root_m(keyframes_m)[:, None]
    moves_aside = _size((peak - start) @ left) > _ASIDE * _size((peak - start) @ ahead)
    if moves_aside or (apart_m is not None and _size(apart_m @ left) > _size(apart_m @ ahead)):
        return View(np.cross(_UP, ahead), ahead, "front")
    towards = -left if handed == "right" else left
    return View(np.cross(_UP, towards), towards, "side")


def _ahead(keyframes_m: Float) -> Float:
    """(3,) where he faces at the first keyframe at which that is known; along x if it is at none."""
    faced = facing(keyframes_m)
    known = faced[np.isfinite(faced).all(axis=1)]
    x, y = known[0] if len(known) else (1.0, 0.0)
    return np.array((x, y, 0.0))


def _size(along: Float) -> float:
    """Sum of squares of all that are known."""
    return float((along[np.isfinite(along)] ** 2).sum())
