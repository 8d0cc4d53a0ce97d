"""Steps from where one stands on a mat to the floor behind it."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.motions import splines
from models.motions.figure import Figure
from models.motions.motion import RATE_HZ

_STRIDE_LEGS: Final = 0.6
"""Longest step, in legs."""
_STEP_S: Final = 0.5
_CLEAR_LEGS: Final = 0.10
_BEFORE_LEGS, _BEHIND_LEGS = 0.14, 0.36
"""No foot is put down nearer to the edge than this: the toes before it, the heel behind it."""
_YIELD_LEGS: Final = 0.06
"""How much lower the pelvis goes than it stands."""


@dataclass(frozen=True, eq=False)
class Walk:
    """What to add to T poses that stand still.

    Attributes:
        shift_m: (T, 3) of the pelvis.
        steps_m: (T, 3) of each foot's print, by side; z is how far the sole is over where it stood.
        pitch_deg: (T,) of each foot.
        stands: (T,) whether each foot is on the ground.
        end_s: when it is over.
    """

    shift_m: Float
    steps_m: dict[str, Float]
    pitch_deg: dict[str, Float]
    stands: dict[str, Bool]
    end_s: float


def walk_off(figure: Figure, from_s: float, at_m: float, edge_m: float, count: int, height_m: float) -> Walk:
    """Walk along x over the edge of a mat, the feet ending side by side on the floor.

    Args:
        figure: of the subject.
        from_s: when the first foot lifts.
        at_m: x of the feet.
        edge_m: x of the mat's end.
        count: T, at `RATE_HZ`.
        height_m: of where he stands over the floor; who stands on the floor stays.
    """
    leg = figure.leg_m
    before, behind = edge_m - _BEFORE_LEGS * leg - at_m, edge_m + _BEHIND_LEGS * leg - at_m
    strides = max(0, int(np.ceil(before / (_STRIDE_LEGS * leg) - 0.2)))
    marks = [*(before * (number + 1) / strides for number in range(strides)), behind, behind] if height_m > 0 else []
    times = np.arange(count) / RATE_HZ
    steps = {side: np.zeros((count, 3)) for side in ("left", "right")}
    pitch = {side: np.zeros(count) for side in ("left", "right")}
    stands = {side: np.ones(count, bool) for side in ("left", "right")}
    for number, mark in enumerate(marks):
        side = ("right", "left")[number % 2]
        lift, land = from_s + number * _STEP_S, from_s + (number + 0.82) * _STEP_S
        share = np.clip((times - lift) / (land - lift), 0.0, 1.0)
        gone = splines.minimum_jerk(share)
        foot = steps[side]
        foot[:, 0] += gone * (mark - foot[-1, 0])
        down = -height_m if mark >= behind else 0.0
        foot[:, 2] += splines.minimum_jerk(2 * share - 1) * (down - foot[-1, 2]) + _CLEAR_LEGS * leg * np.sin(np.pi * share) ** 2
        pitch[side] += 24 * np.sin(np.pi * share) ** 2
        stands[side] &= (times <= lift) | (times >= land)
    end = from_s + len(marks) * _STEP_S + 0.2
    shift = splines.softened((steps["left"] + steps["right"]) / 2, 0.16 * RATE_HZ)
    lower = np.minimum(np.minimum(steps["left"][:, 2], steps["right"][:, 2]), 0.0)
    yields = splines.minimum_jerk((times - from_s + 0.15) / 0.35) - splines.minimum_jerk((times - end + 0.35) / 0.35)
    shift[:, 2] = splines.softened(lower, 0.1 * RATE_HZ) - _YIELD_LEGS * leg * yields
    return Walk(shift, steps, pitch, stands, end)
