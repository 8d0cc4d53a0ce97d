"""Reads TRC, the text format of markers that OpenSim's and OpenCap's recordings come in.

Five lines of header (file, names of quantities, their values, markers, axes), then a row a frame: number, time, and x, y, z of
each marker. Its y is up; here (x, y, z) becomes (x, -z, y), so that z is.
"""

import numpy as np

from models.errors import UserError
from models.motions.recorded.markers import Markers
from models.motions.recorded.table import different, numbers, rate_hz, text_of

_METRES = {"m": 1.0, "mm": 0.001}
_HEADER = 5
_RATE_TOLERANCE = 0.01


def decode(data: bytes, name: str) -> Markers:
    """Read a TRC file.

    Args:
        data: its content.
        name: how errors call it.

    Raises:
        UserError: no TRC file, or one that contradicts itself; names the line.
    """
    lines = text_of(data, name)
    if not lines[0].startswith("PathFileType"):
        raise UserError(f"{name}: is no TRC file: its first line does not begin with PathFileType")
    if len(lines) <= _HEADER:
        raise UserError(f"{name}: ends within its header; export it again")
    header = dict(zip(lines[1].split("\t"), lines[2].split("\t"), strict=False))
    markers = _marker_names(lines[3], name)
    if _header_number(header, "NumMarkers", name) != len(markers):
        raise UserError(f"{name}: NumMarkers is {header['NumMarkers']}, but line 4 names {len(markers)} markers")
    units = header.get("Units", "").strip()
    if units not in _METRES:
        raise UserError(f"{name}: Units is '{units}', known are {' and '.join(_METRES)}")
    first = _HEADER + (not lines[_HEADER].strip())
    table = numbers(lines[first:], "\t", 2 + 3 * len(markers), first + 1, name)
    if _header_number(header, "NumFrames", name) != len(table):
        raise UserError(f"{name}: NumFrames is {header['NumFrames']}, but {len(table)} frames follow; is it cut off?")
    rate = rate_hz(table[:, 1], name)
    told = _header_number(header, "DataRate", name)
    if abs(rate - told) > _RATE_TOLERANCE * told:
        raise UserError(f"{name}: DataRate is {told:g} frames a second, but the times tell {rate:.4g}")
    x, y, z = np.moveaxis(table[:, 2:].reshape(len(table), -1, 3), -1, 0)
    return Markers(markers, told, np.stack((x, -z, y), axis=-1) * _METRES[units])


def _marker_names(line: str, name: str) -> tuple[str, ...]:
    cells = [cell.strip() for cell in line.split("\t")]
    if cells[:2] != ["Frame#", "Time"]:
        raise UserError(f"{name}, line 4: must begin with Frame# and Time")
    while cells and not cells[-1]:
        cells.pop()
    if any(cell for place, cell in enumerate(cells) if place > 1 and place % 3 != 2):
        raise UserError(f"{name}, line 4: each marker's name must be followed by two empty cells")
    return different(cells[2::3], name)


def _header_number(header: dict[str, str], key: str, name: str) -> float:
    try:
        return float(header[key])
    except KeyError:
        raise UserError(f"{name}, line 2: {key} is missing") from None
    except ValueError:
        raise UserError(f"{name}, line 3: {key} is '{header[key]}', which is no number") from None
