"""Rendered lessons as lessons with known truth: rendered if they are not there yet, and found again by their content."""

import heapq
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from edge.cameras.jpeg import JpegFrame
from edge.cameras.video import Video, load_video
from edge.footage.index import Index
from edge.simulation.lesson.attempts import read_attempts
from edge.simulation.lesson.files import ATTEMPTS_NAME, RIG_NAME, TRUTH_NAME, film_path
from edge.simulation.lesson.plan import Plan
from edge.simulation.lesson.stage import member_of
from edge.simulation.rendering.render_lesson import folder_of, render_lesson
from edge.simulation.truth import truth_file
from edge.simulation.truth.truth import Truth
from models.arrays import Float
from models.camera.rig import decode_rig
from models.errors import UserError
from models.skeleton import coco
from tests.bench.datasets.track import between_samples
from tests.bench.reconstruct.lesson import START_NS, Lesson, PictureTruth, Span

_SHOWN_EVERY_S = 5.0


def render_all(plans: Sequence[Plan], data: Path) -> None:
    """Render what is missing, telling how far it is.

    Raises:
        UserError: as `render_lesson`.
    """
    folders = {folder_of(plan, data): plan for plan in plans}
    for number, (folder, plan) in enumerate(folders.items(), 1):
        shown_s = time.monotonic()

        def tell(done: int, total: int, left_s: float | None, title: str = f"{plan.name} ({number} of {len(folders)})") -> None:
            nonlocal shown_s
            if left_s is not None and time.monotonic() - shown_s >= _SHOWN_EVERY_S:
                shown_s = time.monotonic()
                sys.stderr.write(f"rendering {title}: {100 * done / total:.0f} %, {left_s / 60:.1f} min left\n")

        render_lesson(plan, folder, tell)


def rendered_lesson(plan: Plan, data: Path) -> Lesson:
    """A lesson that was rendered.

    Raises:
        UserError: it is not there, or not whole.
    """
    folder = folder_of(plan, data)
    index = Index.read(folder)
    if index is None:
        raise UserError(f"{folder} holds no rendered lesson; render it first")
    truth = truth_file.read(folder / TRUTH_NAME)
    attempts = read_attempts(folder / ATTEMPTS_NAME)[plan.pupils[0].name]
    rig = decode_rig((folder / RIG_NAME).read_bytes(), str(folder / RIG_NAME))
    videos = {name: load_video(film_path(folder, name), name) for name in rig.names}
    times_ns = {name: _times_ns(truth.cameras[name].times_s) for name in rig.names}

    def frames(cameras: Sequence[str]) -> Iterator[JpegFrame]:
        return iter(heapq.merge(*(_frames(videos[name], times_ns[name]) for name in cameras), key=lambda frame: frame.t_mid_ns))

    return Lesson(
        name=plan.name,
        seed=plan.seed,
        pupil=f"{plan.split} {plan.seed}",
        identity=index.recipe,
        rig=rig,
        length_s=len(times_ns[rig.names[0]]) / plan.rate_hz,
        spans=tuple(Span(attempt.action, attempt.start_s, attempt.end_s) for attempt in attempts),
        frames=frames,
        truth_m=_between_pictures(list(truth.cameras.values())),
        stature_m=member_of(plan, 0).subject.body.stature_m,
        pictures={name: _pictures(truth.cameras[name]) for name in rig.names},
    )


def _between_pictures(cameras: Sequence[Truth]) -> Callable[[Float], Float]:
    """Where the pupil's points are at any instant, through where they are at the instants of all cameras' pictures.

    At an instant of a picture it is exactly that; between pictures of 30 Hz the spline keeps to the movement within a millimetre.
    """
    times_s, first = np.unique(np.concatenate([camera.times_s for camera in cameras]), return_index=True)
    points = np.concatenate([camera.coco_m[:, 0, : coco.COUNT] for camera in cameras])[first]
    return between_samples(times_s, points.astype(np.float64))


def _pictures(truth: Truth) -> PictureTruth:
    body = slice(0, coco.COUNT)
    return PictureTruth(
        truth.times_s,
        truth.coco_exposed_m[:, 0, body].astype(np.float64),
        truth.coco_px[:, 0, body].astype(np.float64),
        truth.coco_visible[:, 0, body],
    )


def _times_ns(times_s: Float) -> list[int]:
    """Rounded up, as a camera's schedule does, but for what is only the last digit of a float."""
    return [START_NS + int(t) for t in np.ceil(times_s * 1e9 - 0.01)]


def _frames(video: Video, times_ns: Sequence[int]) -> Iterator[JpegFrame]:
    return (video.frame(0, number, t_ns) for number, t_ns in enumerate(times_ns))
