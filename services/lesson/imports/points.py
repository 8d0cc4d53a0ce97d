"""From named points of another program to a track."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float
from models.errors import UserError
from models.skeleton import coco
from services.evaluation.track import Track, known_track
from services.lesson.export.axes import World
from services.lesson.imports.names import NamesError, points_of

MOST_FRAMES: Final = 200_000
"""More than half an hour at 100 Hz: no standard is so long, and a broken number is refused before memory is asked for."""
MOST_POINTS: Final = 10_000
_RATES_HZ: Final = (5.0, 1000.0)
_FARTHEST_M: Final = 1000.0
_UPRIGHT: Final = 0.87
"""Cosine of 30 degrees."""
_MOSTLY: Final = 0.8
_HARDLY: Final = 0.05


@dataclass(frozen=True, eq=False)
class NamedPoints:
    """What a file says.

    Attributes:
        source: the file's name, for errors.
        names: of N points.
        positions: (T, N, 3) in the file's world, NaN where unknown.
        unit_m: length of the file's unit.
        rate_hz: frames a second.
    """

    source: str
    names: Sequence[str]
    positions: Float
    unit_m: float
    rate_hz: float


def require_size(source: str, frames: int, rate_hz: float) -> None:
    """Raise UserError unless so many frames at such a rate can be a motion."""
    if not 2 <= frames <= MOST_FRAMES:
        raise UserError(f"{source} has {frames} frames; a motion has 2 to {MOST_FRAMES}; export the attempt alone")
    if not _RATES_HZ[0] <= rate_hz <= _RATES_HZ[1]:
        told = f"{_RATES_HZ[0]:g} to {_RATES_HZ[1]:g}"
        raise UserError(f"{source} says that it has {rate_hz:g} frames a second; {told} can be; export it again with the true rate")


def track_of_points(points: NamedPoints, world: World) -> Track:
    """The 17 points among those of a file; their covariance is zero, since files do not say it.

    Args:
        points: what the file says.
        world: its axes.

    Raises:
        UserError: names of a person are missing or double, something is no finite number or nowhere near, nothing is known, or the
            person lies all the time and would stand if another axis were up.
    """
    require_size(points.source, len(points.positions), points.rate_hz)
    try:
        places = points_of(points.names)
    except NamesError as error:
        raise UserError(f"{points.source} {error}") from error
    joints = np.full((len(points.positions), coco.COUNT, 3), np.nan)
    joints[:, list(places)] = points.positions[:, list(places.values())] * points.unit_m
    if np.isinf(joints).any() or np.nanmax(np.abs(joints), initial=0.0) > _FARTHEST_M:
        raise UserError(f"{points.source} has points that are nowhere in a gym; export it again, with the unit that it says")
    joints = np.where(np.isfinite(joints).all(axis=2, keepdims=True), joints, np.nan)
    if not np.isfinite(joints).any():
        raise UserError(f"{points.source} has no frame in which a joint is known; export it again, with the points filled in")
    _require_upright(points.source, joints, world)
    return known_track(world.back(joints), 1 / points.rate_hz)


def _require_upright(source: str, joints: Float, world: World) -> None:
    """Whoever lies in nearly all frames in the same direction has most likely another axis up than the file should have."""
    shoulders, ankles = (
        joints[:, [coco.INDEX[f"{side}_{part}"] for side in ("left", "right")]].mean(axis=1) for part in ("shoulder", "ankle")
    )
    along = shoulders - ankles
    with np.errstate(invalid="ignore", divide="ignore"):
        along = along / np.linalg.norm(along, axis=1, keepdims=True)
    along = along[np.isfinite(along).all(axis=1)]
    if not len(along):
        return
    standing = (along > _UPRIGHT).mean(axis=0)
    up = int(np.argmax(world.turn[:, 2]))
    best = int(np.argmax(standing))
    if standing[best] > _MOSTLY and standing[up] < _HARDLY:
        raise UserError(
            f"in {source} the pupil lies, as if '{'xyz'[best]}' were up and not '{'xyz'[up]}'; export it again with {'xyz'[up]} up"
        )
