"""Whether a lesson is played with a calibration of the cameras that filmed it.

A site may have its lesson calibrated anew, in a world of its own, by people who walk: that is centimetres and tenths of a degree
away. Another rig is metres away, but its pictures have the same size, and nothing else would tell before the figure is wrong.
"""

from collections.abc import Iterator
from itertools import combinations
from pathlib import Path
from typing import Final

import numpy as np

from edge.simulation.lesson.cameras import rig_of
from edge.simulation.lesson.files import RIG_NAME
from edge.simulation.lesson.plan import Plan
from models.arrays import Float
from models.camera.pinhole import Camera
from models.camera.rig import Rig
from models.errors import UserError

_APART_M: Final = 0.3
_TURNED_DEG: Final = 6.0
_VIEW_SHARE: Final = 0.1
"""A calibration of the same rig is nearer than this: distances and turns between cameras, widths of view."""


def require_rig_of_lesson(folder: Path, plan: Plan, rig: Rig) -> None:
    """Compare what does not depend on the choice of the world: how the cameras stand to one another, and how wide each sees.

    Args:
        folder: the lesson's, for the message.
        plan: its plan.
        rig: the calibration of those of its cameras that are played; other cameras have no place here.

    Raises:
        UserError: it is of another rig.
    """
    bumped = {bump.camera for bump in plan.bumps}  # It may well have been calibrated where it was afterwards.
    names = [name for name in rig.names if name not in bumped]
    for wrong in _differences(rig.select(names), rig_of(plan).select(names)):
        raise UserError(
            f"{wrong}: the site's calibration is of other cameras than those of lesson {folder}; set `calibration` in the site "
            f"file to the lesson's own ({RIG_NAME} beside its films), or calibrate these cameras"
        )


def _differences(rig: Rig, filmed: Rig) -> Iterator[str]:
    for camera, true in zip(rig, filmed, strict=True):
        view, wanted = (2 * one.size_px[0] / one.matrix_px[0, 0] for one in (camera, true))
        if abs(view / wanted - 1) > _VIEW_SHARE:
            yield f"camera '{camera.name}' would see {view / wanted:.2f} times as wide as it filmed"
    for (one, other), (first, second) in zip(combinations(rig, 2), combinations(filmed, 2), strict=True):
        far, wanted = _apart_m(one, other), _apart_m(first, second)
        if abs(far - wanted) > _APART_M:
            yield f"cameras '{one.name}' and '{other.name}' would be {far:.1f} m apart, but filmed from {wanted:.1f} m apart"
        turned = _turned_deg(_between(one, other).T @ _between(first, second))
        if turned > _TURNED_DEG:
            yield f"camera '{other.name}' would be turned by {turned:.0f} degrees more against '{one.name}' than it filmed"


def _apart_m(one: Camera, other: Camera) -> float:
    return float(np.linalg.norm(one.centre_m - other.centre_m))


def _between(one: Camera, other: Camera) -> Float:
    return one.rotation @ other.rotation.T


def _turned_deg(turn: Float) -> float:
    return float(np.degrees(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1.0, 1.0))))
