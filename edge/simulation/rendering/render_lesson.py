"""A lesson plan becomes a folder that can be played: a film a camera, the truth, the calibration, a site file and the plan.

The pictures are made by two processes in pieces (`edge.simulation.rendering.pieces`), in a folder beside the one that is wanted
(`NAME.part`). Whoever is interrupted, in whatever way, goes on from there the next time. The folder gets its name when everything
is in it, its index last (`edge.footage.index`). By itself that name ends with the fingerprint of plan and recipe, so that what was
rendered is found again for as long as it would come out the same.
"""

import contextlib
import errno
import shutil
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import msgspec

from edge.footage.index import Index
from edge.simulation.lesson.attempts import encode_attempts
from edge.simulation.lesson.files import ATTEMPTS_NAME, FOLDER, PLAN_NAME, RIG_NAME, SITE_NAME
from edge.simulation.lesson.plan import Plan, encode_plan, fingerprint
from edge.simulation.lesson.site_of_lesson import site_of
from edge.simulation.lesson.stage import set_stage
from edge.simulation.lesson.world_faults import picture_count
from edge.simulation.picture.graphics import graphics
from edge.simulation.rendering.pieces import JOB_NAME, PART_SUFFIX, Job, alone_in, join_film, join_truth, missing, write_whole
from edge.simulation.rendering.recipe import recipe
from edge.simulation.rendering.workers import do_pieces
from models.camera.rig import encode_rig
from models.commands import Progress
from models.errors import UserError

PROCESSES = 2
PIECE_S = 0.5
JPEG_QUALITY = 80
_SPARE_BYTES = 20_000_000
_DIGITS = 12


class Look(NamedTuple):
    """How pictures are kept: with the sensors' noise, and in which quality (1 to 100) of JPEG."""

    noisy: bool = True
    quality: int = JPEG_QUALITY


AS_PLAYED = Look()


def folder_of(plan: Plan, data: Path) -> Path:
    """Where the lesson of a plan is rendered by itself."""
    return data / FOLDER / f"{plan.name}-{_fingerprint(plan, AS_PLAYED)[:_DIGITS]}"


def render_lesson(plan: Plan, folder: Path, progress: Progress, look: Look = AS_PLAYED) -> bool:
    """Render a lesson, unless it is there already.

    Args:
        plan: the plan.
        folder: where it shall be; there may be an older lesson there, which is replaced, but nothing else.
        progress: see `models.commands.Progress`.
        look: see `Look`.

    Returns:
        Whether there was anything to do.

    Raises:
        UserError: the folder cannot be written, its disk is full, or this machine cannot render.
    """
    wanted = _fingerprint(plan, look)
    if is_rendered(folder, wanted):
        return False
    _require_replaceable(folder)
    part = folder.with_name(f"{folder.name}{PART_SUFFIX}")
    with _disk_errors(part), alone_in(part):
        if is_rendered(folder, wanted):  # Somebody else was faster.
            return False
        graphics()  # Who cannot render shall hear it at once.
        job = _begin(part, plan, wanted, look, folder)
        _render_pieces(part, job, progress)
        films = [join_film(part, job, camera) for camera in job.cameras]
        truth = join_truth(part, job)
        (part / JOB_NAME).unlink()
        names = (PLAN_NAME, RIG_NAME, SITE_NAME, ATTEMPTS_NAME)
        Index.of(wanted, [*(part / name for name in names), truth, *films]).write(part)
        if folder.exists():
            shutil.rmtree(folder)
        part.rename(folder)
    return True


def is_rendered(folder: Path, wanted: str) -> bool:
    """Whether a folder holds the lesson with this fingerprint, whole and unchanged."""
    index = Index.read(folder)
    return index is not None and index.recipe == wanted and not index.damaged(folder)


def _fingerprint(plan: Plan, look: Look) -> str:
    return fingerprint(plan, f"{recipe()} {look}")


def _require_replaceable(folder: Path) -> None:
    if folder.exists() and not (folder / PLAN_NAME).is_file() and (not folder.is_dir() or any(folder.iterdir())):
        raise UserError(f"{folder} is there already and is no rendered lesson; name another folder with --out")


def _begin(part: Path, plan: Plan, wanted: str, look: Look, folder: Path) -> Job:
    """Make the folder ready: what another plan or recipe has left in it is removed. The stage is gone when this returns."""
    stage = set_stage(plan)
    job = Job(
        fingerprint=wanted,
        noisy=look.noisy,
        quality=look.quality,
        cameras=stage.rig.names,
        size_px=tuple(camera.size_px for camera in stage.rig),
        pictures=picture_count(plan, stage.length_s),
        per_piece=max(1, round(PIECE_S * plan.rate_hz)),
        rate_hz=plan.rate_hz,
    )
    before = None
    with contextlib.suppress(FileNotFoundError, msgspec.DecodeError):
        before = msgspec.json.decode((part / JOB_NAME).read_bytes(), type=Job)
    for path in part.iterdir():
        if before != job or path.name.endswith(PART_SUFFIX):
            path.unlink()
    _require_room(part, job)
    rig = encode_rig(stage.rig, f"lesson plan {plan.name}, rig {plan.rig}: where the cameras were said to be")
    write_whole(part / PLAN_NAME, encode_plan(plan))
    write_whole(part / RIG_NAME, rig)
    write_whole(part / ATTEMPTS_NAME, encode_attempts(stage.attempts))
    write_whole(part / SITE_NAME, site_of(f"Simulated lesson {plan.name}", job.cameras, folder.resolve(), RIG_NAME))
    write_whole(part / JOB_NAME, msgspec.json.encode(job))
    return job


def _require_room(part: Path, job: Job) -> None:
    left = len(missing(part, job)) / len(job.pieces)
    pixels = job.pictures * sum(width * height for width, height in job.size_px)
    # A quarter of a byte a pixel, and one camera's pieces and film at a time.
    needed = int(left * pixels * 0.25 * (1 + 1 / len(job.cameras))) + _SPARE_BYTES
    free = shutil.disk_usage(part).free
    if free < needed:
        raise UserError(f"{part}: only {free / 1e6:.0f} MB are free, and this lesson may need {needed / 1e6:.0f} MB; {_MAKE_ROOM}")


def _render_pieces(part: Path, job: Job, progress: Progress) -> None:
    left = missing(part, job)
    steps = sum(len(job.numbers(piece)) for piece in left)
    before = job.pictures - steps
    started_s, done = 0.0, 0
    each, total = len(job.cameras), job.pictures * len(job.cameras)
    progress(before * each, total, None)

    def step_done() -> None:
        nonlocal started_s, done
        if not done:  # Before that, the processes got ready.
            started_s = time.monotonic()
        done += 1
        remaining_s = (time.monotonic() - started_s) / (done - 1) * (steps - done) if done > PROCESSES else None
        progress((before + done) * each, total, remaining_s)

    command = [sys.executable, "-m", "edge.simulation.rendering.render_worker", str(part)]
    do_pieces(command, left, PROCESSES, step_done)


_MAKE_ROOM = "make room or name a folder on another disk with --out. What is done is kept: the same command goes on from there"


@contextmanager
def _disk_errors(part: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise UserError(disk_problem(part, error)) from error


def disk_problem(part: Path, error: OSError) -> str:
    """What a person is told of a folder that cannot be written."""
    if error.errno in {errno.ENOSPC, errno.EDQUOT}:
        return f"{part}: its disk is full; {_MAKE_ROOM}"
    return f"{part} cannot be written ({error.strerror or error}); correct its rights, or name another folder with --out"
