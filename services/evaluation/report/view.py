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
_ASIDE: Final = 1.5
"""Seen from the front is what goes so many times more aside than ahead, as the sum of squares over joints and frames."""


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


def view_of(joints_m: Float, handed: Handed, apart_m: Float | None = None) -> View:
    """The view of an attempt.

    Args:
        joints_m: (T, 17, 3) how it should look, in the world, from start to end; NaN where unknown.
        handed: the side that leads, which is turned to whoever looks from the side.
        apart_m: (..., 17, 3) how far from there the pupil was, if that is what shall be seen; NaN where unknown.
    """
    ahead = _ahead(joints_m)
    left = np.cross(_UP, ahead)
    about_hips = joints_m - root_m(joints_m)[:, None]
    moved = about_hips - _mean(about_hips)
    moves_aside = _size(moved @ left) > _ASIDE * _size(moved @ ahead)
    if moves_aside or (apart_m is not None and _size(apart_m @ left) > _size(apart_m @ ahead)):
        return View(np.cross(_UP, ahead), ahead, "front")
    towards = -left if handed == "right" else left
    return View(np.cross(_UP, towards), towards, "side")


def _ahead(joints_m: Float) -> Float:
    """(3,) where the pupil faces as he begins, as far as it is known."""
    faced = facing(joints_m)
    known = faced[np.isfinite(faced).all(axis=1)]
    x, y = known[: max(1, len(known) // 5)].sum(axis=0) if len(known) else (1.0, 0.0)
    size = float(np.hypot(x, y))
    return np.array((x / size, y / size, 0.0)) if size > 0 else np.array((1.0, 0.0, 0.0))


def _mean(places: Float) -> Float:
    """(17, 3) over the frames where they are known."""
    known = np.isfinite(places)
    return np.asarray(np.where(known, places, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1))


def _size(along: Float) -> float:
    """Sum of squares of all that are known."""
    return float((along[np.isfinite(along)] ** 2).sum())
