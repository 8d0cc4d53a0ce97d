"""What a signal is: a formula over postures, with its unit, definition and source."""

from dataclasses import dataclass
from typing import Final, Literal

from services.evaluation.signals.posture import Formula

Unit = Literal["deg", "pct", "cm", "m_s", "m_s2", "s", "deg_s", "1"]
"""As `models.teaching.schema` has them; 1 is a plain number, pct is of the pupil's stature where nothing else is said."""
NO_SOURCE: Final = ""


@dataclass(frozen=True)
class Signal:
    """A quantity that every frame has.

    Attributes:
        name: as it is called in data.
        unit: of its values.
        definition: what it is, in a sentence that a teacher understands; which sign is what.
        formula: over the joints' places, or over their velocities (`order` 1) or accelerations (2).
        source: where the definition is from; empty for our own.
        order: which time derivative of the joints the formula is of.
        sided: whether left and right have one each. Of the others the side says only which direction is positive.
        rate_of: name of the signal whose rate of change it is; then it has that one's formula.
        from_start: whether it is an angle against that at the start of the attempt, and whole turns since then count.
    """

    name: str
    unit: Unit
    definition: str
    formula: Formula
    source: str = NO_SOURCE
    order: Literal[0, 1, 2] = 0
    sided: bool = False
    rate_of: str = ""
    from_start: bool = False

    @property
    def turns(self) -> bool:
        """Whether its values are angles, of which 180 and -180 degrees are the same."""
        return self.unit == "deg"
