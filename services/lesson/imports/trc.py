"""Reading TRC: version 4, of any program that keeps to it, with y up."""

from typing import Final

import numpy as np

from models.arrays import Float
from models.errors import UserError
from services.evaluation.track import Track
from services.lesson.export.axes import OPENSIM
from services.lesson.imports.points import MOST_FRAMES, MOST_POINTS, NamedPoints, require_size, track_of_points
from services.lesson.imports.text import lines_of

_UNITS_M: Final = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "meters": 1.0}
_HEAD = 5
_ONE_LESS = 1
"""Pose2Sim 0.10 says one frame more than there is in what it has filtered."""
_OFF_TIME = 0.01
"""Of a step, that times may be beside the rate: as much as a track allows."""


def decode(data: bytes, source: str) -> Track:
    """The track of a file.

    Args:
        data: its content.
        source: its name, for errors.

    Raises:
        UserError: it is no TRC, of another version, cut off, holds what is no number, or see `track_of_points`.
    """
    lines = lines_of(data, source, "TRC")
    head = lines[0].split("\t") if lines else [""]
    if head[0].strip() != "PathFileType":
        raise UserError(f"{source} is no TRC file: it does not begin with PathFileType; name one, or export it again")
    if len(head) < 2 or head[1].strip() != "4":
        raise UserError(f"{source} is TRC of another version than 4, which is all that KineBox reads; export it as version 4")
    if len(lines) < _HEAD:
        raise UserError(f"{source} is cut off in its head; copy or export it again")
    said = dict(zip((word.strip() for word in lines[1].split("\t")), (word.strip() for word in lines[2].split("\t")), strict=False))
    rate_hz, unit_m = _number(said, "DataRate", source), _UNITS_M.get(said.get("Units", "").lower())
    frames, markers = int(_number(said, "NumFrames", source)), int(_number(said, "NumMarkers", source))
    if unit_m is None:
        raise UserError(f"{source} says its unit is '{said.get('Units', '')}'; {', '.join(_UNITS_M)} can be read; export it in mm")
    require_size(source, frames, rate_hz)
    if not 1 <= markers <= MOST_POINTS:
        raise UserError(f"{source} says that it has {markers} markers; export it again")
    names = [name.strip() for name in lines[3].rstrip().split("\t")[2::3]]
    if len(names) != markers:
        raise UserError(f"{source} names {len(names)} markers and says that it has {markers}; export it again")
    rows = [(number, line) for number, line in enumerate(lines[_HEAD:], start=_HEAD + 1) if line.strip()]
    if not frames - _ONE_LESS <= len(rows) <= frames:
        raise UserError(f"{source} has {len(rows)} frames and says that it has {frames}; it is cut off; copy or export it again")
    values = np.array([_row(line, markers, number, source) for number, line in rows])
    _require_even(values[:, 1], rate_hz, source)
    return track_of_points(NamedPoints(source, names, values[:, 2:].reshape(len(rows), markers, 3), unit_m, rate_hz), OPENSIM)


def _number(said: dict[str, str], key: str, source: str) -> float:
    try:
        value = float(said[key])
    except (KeyError, ValueError):
        value = np.nan
    if not 0 < value <= max(MOST_FRAMES, MOST_POINTS) * 10:
        raise UserError(f"{source} says no {key} that can be; export it again")
    return value


def _row(line: str, markers: int, number: int, source: str) -> list[float]:
    """Frame, time and coordinates; what is empty or left out at the end is unknown."""
    texts = line.split("\t")
    while len(texts) > 2 + 3 * markers and not texts[-1].strip():
        texts.pop()
    if len(texts) > 2 + 3 * markers:
        raise UserError(f"{source}, line {number}: there are more values than markers; export it again")
    try:
        values = [float(text) if text.strip() else np.nan for text in texts]
    except ValueError as error:
        raise UserError(
            f"{source}, line {number}: {str(error).partition(': ')[2]} is no number; correct it or export it again"
        ) from error
    return values + [np.nan] * (2 + 3 * markers - len(values))


def _require_even(times_s: Float, rate_hz: float, source: str) -> None:
    steps = np.diff(times_s)
    bad = np.flatnonzero(~(np.abs(steps * rate_hz - 1) <= _OFF_TIME + 2e-6 * rate_hz))
    if len(bad):
        raise UserError(
            f"{source}: frame {bad[0] + 2} does not follow at {rate_hz:g} frames a second; export it again, evenly spaced"
        )
