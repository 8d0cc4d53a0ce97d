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
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import msgspec

from edge.footage.index import INDEX_NAME, Index
from edge.simulation.lesson.attempts import encode_attempts
from edge.simulation.lesson.files import ATTEMPTS_NAME, FOLDER, PLAN_NAME, RIG_NAME, SITE_NAME, TRUTH_NAME
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
_NAMES = {PLAN_NAME, RIG_NAME, SITE_NAME, ATTEMPTS_NAME, TRUTH_NAME, INDEX_NAME, JOB_NAME}
_SUFFIXES = {".avi", ".pictures", ".truth", PART_SUFFIX}


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
    folder = folder.resolve()  # `.` and `..` have no name, and a link is not what it leads to.
    wanted = _fingerprint(plan, look)
    if is_rendered(folder, wanted):
        return False
    part = folder.parent / f"{folder.name}{PART_SUFFIX}"
    with _disk_errors(part):
        _require_replaceable(folder, part)
        with alone_in(part), _nothing_empty(part):
            if is_rendered(folder, wanted):  # Somebody else was faster.
                return False
            if not is_rendered(part, wanted):  # It is if whoever rendered it was killed at the very end.
                _render(part, plan, wanted, look, folder, progress)
            (part / JOB_NAME).unlink(missing_ok=True)
            _remove(folder)
            part.rename(folder)
    return True


def _render(part: Path, plan: Plan, wanted: str, look: Look, folder: Path, progress: Progress) -> None:
    """Put everything into the folder, its index last."""
    graphics()  # Who cannot render shall hear it at once.
    job = _begin(part, plan, wanted, look, folder)
    _render_pieces(part, job, progress)
    try:
        films = [join_film(part, job, camera) for camera in job.cameras]
        truth = join_truth(part, job)
    except (msgspec.DecodeError, UserError) as error:  # The power was cut while they were written.
        raise UserError(f"{part}: what was rendered is damaged ({error}); delete that folder and begin again") from error
    names = (PLAN_NAME, RIG_NAME, SITE_NAME, ATTEMPTS_NAME)
    Index.of(wanted, [*(part / name for name in names), truth, *films]).write(part)


def is_rendered(folder: Path, wanted: str) -> bool:
    """Whether a folder holds the lesson with this fingerprint, whole and unchanged."""
    index = Index.read(folder)
    return index is not None and index.recipe == wanted and not index.damaged(folder)


def _fingerprint(plan: Plan, look: Look) -> str:
    return fingerprint(plan, f"{recipe()} {look}")


def _require_replaceable(folder: Path, part: Path) -> None:
    """Only what a rendering has put there may be removed."""
    if folder.exists():
        index = Index.read(folder)
        is_lesson = index is not None and PLAN_NAME in index.files
        if not folder.is_dir() or (not is_lesson and any(folder.iterdir())):
            raise UserError(f"{folder} is there already and is no rendered lesson; name another folder with --out, or delete it")
        if index is not None:
            _require_only(folder, lambda name: name in {INDEX_NAME, JOB_NAME, *index.files})
    if part.is_dir():
        _require_only(part, lambda name: name in _NAMES or Path(name).suffix in _SUFFIXES)


def _require_only(folder: Path, is_ours: Callable[[str], bool]) -> None:
    for path in sorted(folder.iterdir()):
        if not is_ours(path.name):
            raise UserError(f"{path} would be lost, which is of no rendering; move it away, or name another folder with --out")


def _remove(folder: Path) -> None:
    """Remove an older lesson, its index last: whoever is killed meanwhile can go on."""
    if folder.exists():
        for path in sorted(folder.iterdir(), key=lambda path: path.name == INDEX_NAME):
            path.unlink()
        folder.rmdir()


@contextmanager
def _nothing_empty(part: Path) -> Iterator[None]:
    """Whoever fails before anything is rendered leaves nothing."""
    try:
        yield
    finally:
        with contextlib.suppress(OSError):  # There is something in it, or it has its name.
            part.rmdir()


def _begin(part: Path, plan: Plan, wanted: str, look: Look, folder: Path) -> Job:
    """Make the folder ready: what another plan or recipe has left in it is removed. The stage is gone when this returns."""
    stage = set_stage(plan)
    _require_within(plan, stage.length_s)
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


def _require_within(plan: Plan, length_s: float) -> None:
    """What would happen after the lesson's end never happens, which nobody means who plans it."""
    for key in ("bumps", "lights", "exposures", "swaps", "faults"):
        for number, change in enumerate(getattr(plan, key)):
            if change.at_s >= length_s:
                raise UserError(
                    f"lesson plan {plan.name}: {key}[{number}].at_s is {change.at_s:g}, but the lesson is over after "
                    f"{length_s:.2f} s; have it happen earlier, or set length_s"
                )


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
