"""Numbers in lines of text, as recording systems write them; every refusal names the file and the line."""

import math

import numpy as np

from models.arrays import Float
from models.errors import UserError

_GAP = {"", "nan", "NaN"}
_REGULAR_SHARE = 0.01


def text_of(data: bytes, name: str) -> list[str]:
    """Lines of a text file, without the empty ones at its end.

    Raises:
        UserError: not text, or nothing in it.
    """
    try:
        lines = data.decode().splitlines()
    except UnicodeDecodeError as error:
        raise UserError(f"{name}: is not a text file; export it again from the recording system") from error
    while lines and not lines[-1].strip():
        lines.pop()
    if not lines:
        raise UserError(f"{name}: is empty")
    return lines


def numbers(lines: list[str], separator: str, columns: int, first_line: int, name: str) -> Float:
    """(rows, columns) of the lines; NaN where a cell is empty.

    Args:
        lines: the rows.
        separator: between cells.
        columns: how many cells each must have; beyond them only empty ones may follow.
        first_line: number of the first of the lines in its file, from 1.
        name: of the file.

    Raises:
        UserError: a row of another length, or a cell that holds no finite number.
    """
    out = np.empty((len(lines), columns))
    for row, line in enumerate(lines):
        cells = [cell.strip() for cell in line.split(separator)]
        if len(cells) < columns or any(cells[columns:]):
            raise UserError(f"{name}, line {first_line + row}: has {len(cells)} values, needed {columns}")
        for column, cell in enumerate(cells[:columns]):
            out[row, column] = _number(cell, f"{name}, line {first_line + row}, value {column + 1}")
    return out


def rate_hz(times_s: Float, name: str) -> float:
    """Rows a second of regular times.

    Raises:
        UserError: fewer than two times, or times that do not follow one another at equal steps.
    """
    if len(times_s) < 2:
        raise UserError(f"{name}: holds {len(times_s)} rows of numbers, needed two or more")
    steps = np.diff(times_s)
    step = float(np.median(steps))
    irregular = ~(np.abs(steps - step) <= _REGULAR_SHARE * step)
    if not step > 0 or irregular.any():
        raise UserError(
            f"{name}: times must follow one another at equal steps; row {int(np.argmax(irregular)) + 2} of numbers does not"
        )
    return float((len(times_s) - 1) / (times_s[-1] - times_s[0]))


def different(names: list[str], name: str) -> tuple[str, ...]:
    """The markers' names.

    Raises:
        UserError: one has no name, or two have the same.
    """
    for place, marker in enumerate(names):
        if not marker:
            raise UserError(f"{name}: marker {place + 1} has no name")
        if marker in names[:place]:
            raise UserError(f"{name}: two markers are named '{marker}'")
    return tuple(names)


def _number(cell: str, where: str) -> float:
    if cell in _GAP:
        return math.nan
    try:
        value = float(cell)
    except ValueError:
        raise UserError(f"{where}: '{cell}' is no number") from None
    if not math.isfinite(value):
        raise UserError(f"{where}: '{cell}' is not finite")
    return value
