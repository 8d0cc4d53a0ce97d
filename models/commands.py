"""What the command line finds in the parts by the entry points `kinebox.commands`: work that a part does when a person asks for it.

`services` and `edge` never import one another, so what goes between them is said here.
"""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple, Protocol

Progress = Callable[[int, int, float | None], None]
"""Is told pictures done, pictures in all, and the seconds that are left, if they can be known."""


class LessonPlan(NamedTuple):
    """A lesson plan that comes with KineBox."""

    name: str
    what: str


class RenderedLesson(NamedTuple):
    """A lesson that can be played.

    Attributes:
        folder: where it is.
        site: the site file with which it is played.
        was_there: it had been rendered before.
    """

    folder: Path
    site: Path
    was_there: bool


class Simulation(Protocol):
    """The entry point `simulate`: renders simulated lessons."""

    def plans(self) -> list[LessonPlan]:
        """The lesson plans that come with KineBox."""

    def simulate(self, plan: str, data: Path, out: Path | None, progress: Progress) -> RenderedLesson:
        """Render a lesson unless it is there already.

        Args:
            plan: a plan's file, or the name of one that comes with KineBox.
            data: the data folder.
            out: where the lesson shall be; None finds a place in the data folder.
            progress: is called often.

        Raises:
            UserError: the plan is wrong, this machine cannot render, or the folder cannot be written.
        """
