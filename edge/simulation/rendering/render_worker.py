"""A process that renders pieces of a lesson: started by `render_lesson`."""

import sys
from collections.abc import Callable
from pathlib import Path

import cv2
import msgspec

from edge.footage.transcode import encode_jpeg
from edge.simulation.lesson.files import PLAN_NAME
from edge.simulation.lesson.plan import decode_plan
from edge.simulation.lesson.stage import set_stage
from edge.simulation.rendering.film import Film
from edge.simulation.rendering.pieces import JOB_NAME, Job, keep_pictures, keep_truth
from edge.simulation.rendering.render_lesson import disk_problem
from edge.simulation.rendering.workers import serve_pieces
from edge.simulation.truth.truth import Truth
from models.errors import UserError


def main() -> int:
    """Render what is asked for on standard input; returns the exit code."""
    cv2.setNumThreads(1)
    folder = Path(sys.argv[1])
    film: Film | None = None
    job = msgspec.json.decode((folder / JOB_NAME).read_bytes(), type=Job)

    def do(piece: int, step_done: Callable[[], None]) -> None:
        nonlocal film
        if film is None:
            plan = decode_plan((folder / PLAN_NAME).read_bytes(), PLAN_NAME)
            film = Film(plan, set_stage(plan), noisy=job.noisy)
        try:
            _render(folder, job, piece, film, step_done)
        except BrokenPipeError:
            raise
        except OSError as error:
            raise UserError(disk_problem(folder, error)) from error

    return serve_pieces(do)


def _render(folder: Path, job: Job, piece: int, film: Film, step_done: Callable[[], None]) -> None:
    pictures: dict[str, list[bytes]] = {camera: [] for camera in job.cameras}
    truths: dict[str, list[Truth]] = {camera: [] for camera in job.cameras}
    for number in job.numbers(piece):
        for camera in job.cameras:
            picture, truth = film.take(camera, number)
            pictures[camera].append(encode_jpeg(picture, job.quality))
            truths[camera].append(truth)
        step_done()
    for camera in job.cameras:
        keep_pictures(folder, camera, piece, pictures[camera])
    keep_truth(folder, piece, film.truth_of(truths, job.fingerprint))


if __name__ == "__main__":
    sys.exit(main())
