"""A number that was measured in an attempt."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from services.evaluation.attempt import FoundAttempt
from services.evaluation.signals.reading import Reading
from services.evaluation.signals.signal import Unit


@dataclass(frozen=True)
class Measured:
    """A result.

    Attributes:
        name: of the measure: the signal and how it was reduced, or the function.
        value: in `unit`; NaN if it cannot be told.
        sigma: its standard deviation; NaN if the value is.
        unit: see `Unit`.
        known: whether the joints that it is made of were seen. Only then may anybody be judged by it.
        why: of a value that cannot be told, the reason; empty otherwise.
    """

    name: str
    value: float
    sigma: float
    unit: Unit
    known: bool
    why: str = ""

    def __post_init__(self) -> None:
        if self.known and not (math.isfinite(self.value) and math.isfinite(self.sigma)):
            raise ValueError(f"{self.name} is {self.value} +- {self.sigma}, which nobody can know")


@dataclass(frozen=True)
class Estimate:
    """What a function says.

    Attributes:
        value, sigma: NaN if unknown.
        seen: whether what it is made of was seen.
        why: of an unknown value, the reason.
    """

    value: float
    sigma: float
    seen: bool = True
    why: str = ""


@dataclass(frozen=True)
class Function:
    """A measure that is no reduced signal.

    Attributes:
        name: as data has it.
        unit: of its values.
        family: heading under which it is described.
        definition: what it is, in a sentence or two.
        source: where the definition is from; empty for our own.
        call: measures an attempt.
    """

    name: str
    unit: Unit
    family: str
    definition: str
    source: str
    call: Callable[[Reading, FoundAttempt], Estimate]


def unknown(why: str) -> Estimate:
    """Nothing can be said."""
    return Estimate(math.nan, math.nan, seen=False, why=why)


HIDDEN: Final = "the joints that it needs were not seen"
OUTSIDE: Final = "the recording does not reach so far"
BACKWARDS: Final = "in this attempt the stretch ends before it begins"
