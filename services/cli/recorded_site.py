"""Whether the box that records is the one that is meant.

Nobody says on the bus which site a box runs, and boxes of two sites may have the same endpoint. The lesson's file does.
"""

import sys
import tomllib
from pathlib import Path

from models.config.site import Site
from models.errors import UserError
from services.lesson.layout import PART_SUFFIX, SUFFIX
from services.lesson.lesson_reader import read_header
from services.logs.printable import printable


def note_of_another(site: Site, lesson: str, data: Path) -> None:
    """Say on stderr if a lesson that was begun is of another site, or not where this site and data folder have theirs."""
    folder = (data / site.lessons.folder).resolve()
    name = _site_of(folder, lesson)
    if name == site.name:
        return
    told = (
        f"the box at {site.bus.endpoint} keeps its lessons elsewhere than in {folder}; name its site file and its data folder"
        if name is None
        else f"the box at {site.bus.endpoint} runs the site '{name}', and not '{site.name}', which --site names: "
        f"it is '{name}' that is recorded"
    )
    sys.stderr.write(f"note: {printable(told)}\n")
    sys.stderr.flush()


def _site_of(folder: Path, lesson: str) -> str | None:
    """The name of the site of which a lesson is, finished or not; None if it cannot be read there."""
    for suffix in (PART_SUFFIX, SUFFIX):
        path = folder / f"{lesson}{suffix}"
        try:
            with path.open("rb") as file:
                return str(tomllib.loads(read_header(path, file).site_toml).get("name"))
        except (OSError, UserError, tomllib.TOMLDecodeError):
            continue
    return None
