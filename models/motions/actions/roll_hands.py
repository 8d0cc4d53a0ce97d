"""The hands of a forward roll: flat on the mat before it, and with a fault beside the hips after it."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.body.limits import excess_rad, limits_rad
from models.motions import flesh, mat, palms, posing, rotations, splines
from models.motions.figure import Figure
from models.skeleton import smpl

_SIDES: Final = ("left", "right")
_FINGERS_IN_RAD: Final = np.radians(32.0)
_EASE_S: Final = 0.2
_LIES_M: Final = 0.004
"""A palm that bears is not further than this from where it was put; in the end the wrist bends no further, and it leaves."""
_ELBOW_SINKS_M: Final = 0.018
_BEYOND_DEG: Final = 2.5
"""What is let pass of an elbow in the mat and of a shoulder beyond its range."""
_AFTER_S: Final = 0.1
"""So long after a hand has left the elbow must keep out of the mat, too."""


@dataclass(frozen=True)
class Support:
    """Both hands bear.

    Attributes:
        from_s, to_s: when.
        share: how far they go there, 0 to 1.
        wide: shoulder widths that they are apart.
        out: (front, out, up) where the elbows point.
        nearer: how much nearer to the feet than under the shoulders they are put, arms: the first of these that the arms allow.
    """

    from_s: float
    to_s: float
    share: float
    wide: float
    out: tuple[float, float, float]
    nearer: tuple[float, ...] = (0.0,)


def bear(figure: Figure, times_s: Float, supports: list[Support], pelvis_m: Float, local: Float) -> Bool:
    """Put the hands on the mat, support by support, in place in (T, 24, 3, 3) `local`.

    Returns:
        (T, 2) whether the left and the right one bear.
    """
    bearing = np.zeros((len(times_s), len(_SIDES)), bool)
    for support in supports:
        concerned = (times_s >= support.from_s) & (times_s <= support.to_s + _AFTER_S)
        for nearer in support.nearer:
            tried = local.copy()
            borne = _put(figure, times_s, support, nearer, bearing, pelvis_m, tried)
            if _arms_can(figure, pelvis_m[concerned], tried[concerned]):
                break
        local[:], bearing = tried, borne
    return bearing


def _put(figure: Figure, times_s: Float, support: Support, nearer: float, bore: Bool, pelvis_m: Float, local: Float) -> Bool:
    """One support, so many arms nearer to the feet. Takes and returns what `bear` does; `bore` is when hands bear already."""
    during = (times_s >= support.from_s) & (times_s <= support.to_s)
    whole = during & (support.share >= 1)
    bearing = bore.copy()
    for number, (side, mirror) in enumerate(zip(_SIDES, (1.0, -1.0), strict=True)):
        shoulder = figure.place_local(pelvis_m, local).joints_m[:, smpl.INDEX[f"{side}_shoulder"]]
        arm_m = sum(float(np.linalg.norm(figure.bones_m[smpl.INDEX[f"{side}_{name}"]])) for name in ("elbow", "wrist"))
        # Half way between where the shoulders are at first and at last, within reach of both.
        x_m = float(shoulder[during, 0].mean()) - nearer * arm_m
        y_m = mirror * support.wide * abs(float(shoulder[0, 1]))
        place = np.array((x_m, y_m, mat.HEIGHT_M + palms.wrist_height_m(figure, side)))
        palm = palms.Palm(
            side,
            np.tile(place, (len(times_s), 1)),
            np.full(len(times_s), -mirror * _FINGERS_IN_RAD),
            support.share * splines.lasting(times_s, support.from_s, support.to_s, _EASE_S),
            np.tile(np.array(support.out) * posing.OUT[side], (len(times_s), 1)),
            points=False,
        )
        palms.bear(figure, palm, pelvis_m, local)
        palms.settle(figure, side, mat.HEIGHT_M, bore[:, number] | whole, pelvis_m, local)
        placed = figure.place_local(pelvis_m, local)
        moved = np.linalg.norm((placed.joints_m[:, smpl.INDEX[f"{side}_wrist"]] - place)[:, :2], axis=1)
        bearing[:, number] |= during & (moved < _LIES_M) & (palms.lowest_m(figure, side, placed) - mat.HEIGHT_M < _LIES_M)
    return bearing


def _arms_can(figure: Figure, pelvis_m: Float, local: Float) -> bool:
    """Whether no elbow is in the mat, and no shoulder turns further than it can."""
    shoulders = [smpl.INDEX[f"{side}_shoulder"] for side in _SIDES]
    over = excess_rad(rotations.vectors(local), limits_rad(figure.subject.age_years))[:, shoulders]
    elbows = flesh.carried_by(figure, ("left_elbow", "right_elbow"))
    lowest_m = flesh.places_m(figure, elbows, figure.place_local(pelvis_m, local))[..., 2].min()
    return bool(np.abs(over).max() < np.radians(_BEYOND_DEG) and lowest_m > mat.HEIGHT_M - _ELBOW_SINKS_M)
