"""Reads markers from a CSV file with a column `Time` (seconds) and three columns `NAME[0]`, `NAME[1]`, `NAME[2]` for each marker.

So writes Kinetics Toolkit. Places are in metres, z up.
"""

import re
from typing import Final

from models.errors import UserError
from models.motions.recorded.markers import Markers
from models.motions.recorded.table import different, numbers, rate_hz, text_of

_COLUMN: Final = re.compile(r"(.+)\[([012])\]")


def decode(data: bytes, name: str) -> Markers:
    """Read such a file.

    Args:
        data: its content.
        name: how errors call it.

    Raises:
        UserError: another file, or a row that cannot be read; names the line.
    """
    lines = text_of(data, name)
    columns = [column.strip() for column in lines[0].split(",")]
    if columns[0] != "Time" or len(columns) < 4 or len(columns) % 3 != 1:
        raise UserError(f"{name}, line 1: needed are Time, then three columns for each marker, such as C7[0],C7[1],C7[2]")
    markers = []
    for first in range(1, len(columns), 3):
        found = [_COLUMN.fullmatch(column) for column in columns[first : first + 3]]
        if [match and match[2] for match in found] != ["0", "1", "2"] or len({match and match[1] for match in found}) > 1:
            raise UserError(f"{name}, line 1: columns {first + 1} to {first + 3} are not NAME[0],NAME[1],NAME[2] of one marker")
        markers.append(columns[first].removesuffix("[0]"))
    table = numbers(lines[1:], ",", len(columns), 2, name)
    return Markers(different(markers, name), rate_hz(table[:, 0], name), table[:, 1:].reshape(len(table), -1, 3))
