"""All functions by name; with the signals and how they are reduced, all that can be measured."""

from typing import Final

from services.evaluation.measures import balance, jumps, landing, smoothness, striking, symmetry, timing, together, travel
from services.evaluation.measures.measured import Function

_FAMILIES: Final = (timing, jumps, travel, landing, striking, together, symmetry, balance, smoothness)
FUNCTIONS: Final[dict[str, Function]] = {function.name: function for family in _FAMILIES for function in family.FUNCTIONS}
