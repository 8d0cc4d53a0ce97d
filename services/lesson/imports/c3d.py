"""Reading C3D: points of any program that keeps to it, with z up, or y if the file says so."""

import warnings
from io import BytesIO
from typing import Final

import c3d
import numpy as np

from models.arrays import Float
from models.errors import UserError
from models.messages.motion import JointState
from services.evaluation.track import Track
from services.lesson.export.axes import OPENSIM, OURS
from services.lesson.export.c3d import COMPANY
from services.lesson.imports.names import points_of
from services.lesson.imports.points import MOST_POINTS, NamedPoints, require_size, track_of_points

_UNITS_M: Final = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}
_MAGIC = 0x50
_LEAST_BYTES = 1024


def decode(data: bytes, source: str) -> Track:
    """The track of a file.

    In a file of KineBox a residual is a standard deviation, and 0 says that a point was guessed; others mean many things by it.

    Args:
        data: its content.
        source: its name, for errors.

    Raises:
        UserError: it is no C3D, cut off, broken, or see `track_of_points`.
    """
    if len(data) < 2 or data[1] != _MAGIC:
        raise UserError(f"{source} is no C3D file; name one, or export it again")
    if len(data) < _LEAST_BYTES:
        raise UserError(f"{source} is cut off in its head; copy or export it again")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # that something is missing: what matters is asked for below
            reader = c3d.Reader(BytesIO(data))
            frames, rate_hz = int(reader.frame_count), float(reader.point_rate)
            count = int(reader.point_used)
            names = [str(name).strip() for name in reader.point_labels][:count]
            unit = reader.get("POINT:UNITS")
            unit = "mm" if unit is None else str(unit.string_value).strip("\0 ").lower()
            company = reader.get("MANUFACTURER:COMPANY")
            ours = company is not None and str(company.string_value).strip() == COMPANY
            upwards = reader.get("POINT:Y_SCREEN")
            y_is_up = upwards is not None and str(upwards.string_value).strip().upper() == "+Y"
            require_size(source, frames, rate_hz)
            if not 1 <= count <= MOST_POINTS or len(names) != count:
                raise UserError(f"{source} has {count} points and names {len(names)}; export it again")
            values = np.array([points[:, :4].astype(np.float64) for _, points, _ in reader.read_frames()])
    except UserError:
        raise
    except Exception as error:  # behind the first bytes the library raises whatever happens to it
        raise UserError(f"{source} is broken or cut off; copy or export it again") from error
    if len(values) != frames:
        raise UserError(f"{source} has {len(values)} frames and says that it has {frames}; it is cut off; copy or export it again")
    if unit not in _UNITS_M:
        raise UserError(f"{source} says its unit is '{unit}'; {', '.join(_UNITS_M)} can be read; export it in mm")
    positions = np.where(values[..., 3:] < 0, np.nan, values[..., :3])
    track = track_of_points(NamedPoints(source, names, positions, _UNITS_M[unit], rate_hz), OPENSIM if y_is_up else OURS)
    return _with_sigma(track, values[..., 3] * _UNITS_M[unit], points_of(names)) if ours else track


def _with_sigma(track: Track, residuals_m: Float, places: dict[int, int]) -> Track:
    """The track as it was before the export, as far as residuals (T, N) tell."""
    states, covariance = track.states.copy(), track.covariance_m2.copy()
    for joint, place in places.items():
        sigma = residuals_m[:, place]
        states[(states[:, joint] != JointState.UNKNOWN) & (sigma == 0), joint] = JointState.GUESSED
        covariance[:, joint] += sigma[:, None, None] ** 2 * np.eye(3)
    return Track(track.t_s, track.joints_m, covariance, states)
