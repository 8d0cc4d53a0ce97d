"""One try at an action, as it was found in the motion."""

from dataclasses import dataclass
from typing import Final

from models.motions.motion import Handed
from models.teaching.measure import PHASES, Phase

__all__ = ["AROUND_S", "PHASES", "FoundAttempt", "Phase"]

AROUND_S: Final = 1.2
"""So much of the motion before and after an attempt is looked at with it, as far as it is there."""


@dataclass(frozen=True)
class FoundAttempt:
    """An attempt.

    Attributes:
        action: name of the action, as in `models.motions.actions.library.ACTIONS`.
        handed: the side that leads.
        moments_s: instants of `PHASES`, in their order, on the clock of the track that it was found in.
        timed: they were seen. If not, they are only where the standard has them, and nothing can be measured by them.
    """

    action: str
    handed: Handed
    moments_s: tuple[float, float, float, float]
    timed: bool = True

    def __post_init__(self) -> None:
        if not all(before < after for before, after in zip(self.moments_s, self.moments_s[1:], strict=False)):
            raise ValueError(f"the keyframes of an attempt follow one another: {self.action} has {self.moments_s}")

    def moment_s(self, phase: Phase) -> float:
        """Of one keyframe."""
        return self.moments_s[PHASES.index(phase)]
