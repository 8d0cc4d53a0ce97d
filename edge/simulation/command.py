"""What `kinebox simulate` asks of the edge; the command line finds it by the entry point group `kinebox.commands`."""

from pathlib import Path

from edge.simulation.lesson.files import SITE_NAME
from edge.simulation.lesson.plan import Plan, decode_plan
from edge.simulation.lesson.plan_check import require_sound
from edge.simulation.lesson.presets import PRESETS
from edge.simulation.rendering.render_lesson import folder_of, render_lesson
from models.commands import LessonPlan, Progress, RenderedLesson
from models.errors import UserError


class Simulation:
    """See `models.commands.Simulation`."""

    def plans(self) -> list[LessonPlan]:
        """See `models.commands.Simulation.plans`."""
        return [LessonPlan(name, preset.what) for name, preset in PRESETS.items()]

    def simulate(self, plan: str, data: Path, out: Path | None, progress: Progress) -> RenderedLesson:
        """See `models.commands.Simulation.simulate`."""
        wanted = find_plan(plan)
        folder = folder_of(wanted, data) if out is None else out
        is_new = render_lesson(wanted, folder, progress)
        return RenderedLesson(folder, folder / SITE_NAME, not is_new)


def find_plan(name: str) -> Plan:
    """The plan of a file, or of a preset's name.

    Raises:
        UserError: there is none, it cannot be read, or it is not sound.
    """
    path = Path(name)
    if name in PRESETS and not path.is_file():
        return PRESETS[name].make()
    try:
        plan = decode_plan(path.read_bytes(), path)
    except FileNotFoundError as error:
        raise UserError(
            f"there is no lesson plan '{name}': no file of that name, and those that come with KineBox are {', '.join(PRESETS)}"
        ) from error
    except OSError as error:
        raise UserError(f"lesson plan {path} cannot be read ({error.strerror}); correct its path or its rights") from error
    require_sound(plan, name)
    return plan


simulation = Simulation()
"""The entry point."""
