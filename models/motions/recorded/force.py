"""The vertical force under a person, from a force plate, and what it tells of a jump."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float
from models.errors import UserError
from models.motions.ballistics import GRAVITY_M_S2
from models.motions.recorded.table import numbers, rate_hz, text_of

STANDING_N: Final = 20.0
"""More than this is somebody on the plate; less is its noise."""


@dataclass(frozen=True, eq=False)
class VerticalForce:
    """Force of the floor on a person.

    Attributes:
        rate_hz: samples a second; the first is at time zero.
        force_n: (T,).
    """

    rate_hz: float
    force_n: Float

    def flights_s(self) -> list[tuple[float, float]]:
        """Times at which the person leaves the plate and comes back to it, one pair for each flight between two landings."""
        on = np.flatnonzero(np.diff((self.force_n > STANDING_N).astype(int)))
        first = 0 if self.force_n[0] > STANDING_N else 1  # The first change is the first step or fall onto the plate.
        changes = [(float(number) + 1) / self.rate_hz for number in on[first:]]
        return list(zip(changes[::2], changes[1::2], strict=False))


def jump_height_m(flight_s: float) -> float:
    """Rise of the centre of mass in a flight that ends as it began: g t^2 / 8."""
    return GRAVITY_M_S2 * flight_s**2 / 8


def decode(data: bytes, name: str) -> VerticalForce:
    """Read a CSV file with the columns time_s and force_N.

    Raises:
        UserError: another file, a row that cannot be read, or one without its force; names the line.
    """
    lines = text_of(data, name)
    if [column.strip() for column in lines[0].split(",")] != ["time_s", "force_N"]:
        raise UserError(f"{name}, line 1: the columns must be time_s,force_N")
    table = numbers(lines[1:], ",", 2, 2, name)
    gaps = np.flatnonzero(np.isnan(table).any(axis=1))
    if len(gaps):
        raise UserError(f"{name}, line {gaps[0] + 2}: a value is missing")
    return VerticalForce(rate_hz(table[:, 0], name), table[:, 1])
