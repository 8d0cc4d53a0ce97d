"""Which simulated lessons the benches take by default."""

from typing import Final

from edge.simulation.split import Split

COUNT: Final = 5
_FIRST: Final = {"development": 0, "test": 100}
"""Test pupils below 100 were looked at while the simulated gym and its measures were made."""


def seeds_of(split: Split, count: int = COUNT) -> tuple[int, ...]:
    """The first seeds of a split's lessons."""
    return tuple(range(_FIRST[split], _FIRST[split] + count))
