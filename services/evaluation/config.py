"""What the evaluation goes by: what is taught, how each action is done well, and how time passes."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from models.errors import UserError
from models.messages.feedback import ANY
from models.teaching.schema import Teaching, Vocabulary
from models.teaching.standard import FRAME_S, Standard
from services.evaluation.measures.catalogue import FUNCTIONS
from services.evaluation.signals.catalogue import CATALOGUE

VOCABULARY: Final = Vocabulary(CATALOGUE, FUNCTIONS)
"""Of what the measures of a teaching file may be made."""
WHICHEVER: Final = "any"
"""In the site file, in the place of an action's name."""


@dataclass(frozen=True)
class EvaluationConfig:
    """Everything that `pipeline.step` goes by.

    Attributes:
        teachings: what is looked for and said, by the action's name.
        standards: how it is done well, of the same actions.
        activity: what pupils do until a tablet says otherwise; `ANY` for whichever it is.
        frame_s: from one smooth motion to the next in the time of the pupil.
        speed: seconds of the pupil's time a second of CLOCK_MONOTONIC; 1 but for a lesson that is played slower or faster.
        slack_frames: how far a motion's time may be from what its number says. A lesson that is played is late now and then.
    """

    teachings: Mapping[str, Teaching]
    standards: Mapping[str, Standard]
    activity: str = ANY
    frame_s: float = FRAME_S
    speed: float = 1.0
    slack_frames: float = 0.25

    def __post_init__(self) -> None:
        without = sorted(self.teachings.keys() ^ self.standards.keys())
        if without:
            name = without[0]
            missing, file = ("standard", f"standards/{name}.npz") if name in self.teachings else ("text", f"actions/{name}.toml")
            raise UserError(
                f"action '{name}' has no {missing} ({file} in the folder of what is taught); add it, or remove the action"
            )
        if self.activity != ANY and self.activity not in self.standards:
            raise UserError(f"no action is called '{self.activity}' (there are: {', '.join(self.standards)}); correct its name")
