"""How an action is to be performed: by which hand, how fast, how large, how well, and with which faults."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from models.errors import UserError
from models.motions.motion import Handed

TEMPO = (0.7, 1.4)
AMPLITUDE = (0.8, 1.2)
SEVERITY = (0.0, 2.0)
"""1 is as severe as a teacher would correct at once; half of that is where he might begin to."""


@dataclass(frozen=True)
class Performance:
    """Parameters of a performance.

    Attributes:
        action: name of the action, a key of `models.motions.actions.library.ACTIONS`.
        handed: the side that throws, hits, kicks or leads.
        tempo: 1 is the standard's; 1.2 takes a sixth less time. Within `TEMPO`. Flight and fall keep to gravity.
        amplitude: of the movement against the standard's. Within `AMPLITUDE`.
        skill: 1 performs as the standard does; below, natural variation (which is no fault) grows, to its largest at 0.
        faults: severities, within `SEVERITY`, by names of the action's faults.
        seed: of the natural variation.
    """

    action: str
    handed: Handed = "right"
    tempo: float = 1.0
    amplitude: float = 1.0
    skill: float = 1.0
    faults: Mapping[str, float] = field(default_factory=dict)
    seed: int = 0

    def __post_init__(self) -> None:
        _require(self.action, "tempo", self.tempo, TEMPO)
        _require(self.action, "amplitude", self.amplitude, AMPLITUDE)
        _require(self.action, "skill", self.skill, (0.0, 1.0))
        for fault, severity in self.faults.items():
            _require(self.action, f"severity of '{fault}'", severity, SEVERITY)
        if self.handed not in {"right", "left"}:
            raise UserError(f"{self.action}: handed is '{self.handed}'; it may be right or left")

    def severity(self, fault: str) -> float:
        """Of a fault; 0 if it is not performed."""
        return self.faults.get(fault, 0.0)


def _require(action: str, name: str, value: float, bounds: tuple[float, float]) -> None:
    if not (math.isfinite(value) and bounds[0] <= value <= bounds[1]):
        raise UserError(f"{action}: {name} is {value:g}; it may be {bounds[0]:g} to {bounds[1]:g}")
