"""What an action is: its name, the faults that it knows, and how it is performed."""

from collections.abc import Callable
from dataclasses import dataclass

from models.motions.motion import Motion
from models.motions.performance import Performance
from models.motions.subject import Subject


@dataclass(frozen=True)
class Fault:
    """Something that a teacher would correct.

    Attributes:
        name: as in `Performance.faults`, such as `elbow_out`.
        what: one line, plain English, on what is done wrong at severity 1, with its size (degrees, centimetres, seconds).
    """

    name: str
    what: str


@dataclass(frozen=True)
class Action:
    """An action.

    Attributes:
        name: as in `Performance.action`, such as `basketball_shot`.
        title: for people.
        faults: at least three.
        perform: the motion of a performance by a subject; checks nothing (see `models.motions.perform.perform`).
    """

    name: str
    title: str
    faults: tuple[Fault, ...]
    perform: Callable[[Performance, Subject], Motion]
