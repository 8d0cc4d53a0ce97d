"""A folder as `kinebox simulate` leaves it, but with pictures that need no renderer: camera k's picture m is grey, 40 k + m."""

from fractions import Fraction
from pathlib import Path

from edge.footage.index import Index
from edge.footage.transcode import write_motion_jpeg
from edge.simulation.lesson.files import PLAN_NAME, film_path
from edge.simulation.lesson.plan import PLAN_VERSION, Plan, PupilPlan, encode_plan
from tests.small_video import SIZE_PX, plain_picture

CAMERAS = ("cam01", "cam02", "cam03")
PICTURES = 30


def plan_with(**more: object) -> Plan:
    """A plan of a lesson of one second."""
    return Plan(version=PLAN_VERSION, name="drawn", seed=5, pupils=[PupilPlan(name="pupil")], **more)  # type: ignore[arg-type]


def draw_lesson(folder: Path, plan: Plan) -> Path:
    """Put a lesson into a folder."""
    folder.mkdir(parents=True)
    (folder / PLAN_NAME).write_bytes(encode_plan(plan))
    films = []
    for number, camera in enumerate(CAMERAS):
        films.append(film_path(folder, camera))
        pictures = (plain_picture(40 * number + picture, SIZE_PX) for picture in range(PICTURES))
        write_motion_jpeg(films[-1], pictures, Fraction(plan.rate_hz))
    Index.of("drawn", [folder / PLAN_NAME, *films]).write(folder)
    return folder
