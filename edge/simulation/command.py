"""What `kinebox simulate` asks of the edge; the command line finds it by the entry point group `kinebox.commands`."""

import codecs
from collections.abc import Iterator
from pathlib import Path

from msgspec import UNSET

from edge.simulation.lesson.cameras import rig_of
from edge.simulation.lesson.files import SITE_NAME
from edge.simulation.lesson.plan import Plan, decode_plan, plan_text
from edge.simulation.lesson.plan_check import require_sound
from edge.simulation.lesson.presets import PRESETS
from edge.simulation.rendering.render_lesson import folder_of, render_lesson
from models.commands import LessonPlan, Progress, RenderedLesson
from models.errors import UserError

_LEAST_CAMERAS = 2
"""As in `models.config.site.Site`."""


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
        text = plan_text(path)
    except FileNotFoundError as error:
        raise UserError(
            f"there is no lesson plan '{name}': no file of that name, and those that come with KineBox are {', '.join(PRESETS)}"
        ) from error
    except OSError as error:
        raise UserError(f"lesson plan {path} cannot be read ({error.strerror}); correct its path or its rights") from error
    try:
        text.decode()
    except UnicodeDecodeError as error:
        raise UserError(
            f"lesson plan {path} is not in UTF-8 (its byte {error.start + 1} is not); save it in that encoding"
        ) from error
    plan = decode_plan(text.removeprefix(codecs.BOM_UTF8), path)  # Some editors begin with the mark.
    for problem in _impossible(plan):
        raise UserError(f"lesson plan {name}: {problem}")
    require_sound(plan, name)
    sizes_px = {camera.name: camera.size_px for camera in rig_of(plan)}
    for number, swap in enumerate(plan.swaps):
        if len({sizes_px[camera] for camera in swap.cameras}) > 1:
            raise UserError(
                f"lesson plan {name}: swaps[{number}].cameras: the pictures of {' and '.join(swap.cameras)} are not of one size, "
                "so that no box would play them; give size_px"
            )
    return plan


def _impossible(plan: Plan) -> Iterator[str]:
    """What could be rendered, but no camera could film, or no box play."""
    if plan.cameras is not UNSET and plan.cameras < _LEAST_CAMERAS:
        yield f"cameras is {plan.cameras}; a lesson is played with {_LEAST_CAMERAS} or more"
    period_ms = 1e3 / plan.rate_hz
    for key in ("exposure_ms", "readout_ms"):
        if getattr(plan.shutter, key) > period_ms:
            yield (
                f"shutter.{key} is {getattr(plan.shutter, key):g}, but at {plan.rate_hz:g} Hz the next picture begins after "
                f"{period_ms:.2f} ms; set it to less"
            )


simulation = Simulation()
"""The entry point."""
