"""All functions by name; with the signals and how they are reduced, all that can be measured."""

from typing import Final

from services.evaluation.measures import landing, striking, timing, together
from services.evaluation.measures.measured import Function

FUNCTIONS: Final[dict[str, Function]] = {
    function.name: function for function in (*timing.FUNCTIONS, *landing.FUNCTIONS, *together.FUNCTIONS, *striking.FUNCTIONS)
}
