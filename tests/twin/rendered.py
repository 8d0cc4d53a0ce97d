"""Streams of lessons that were rendered and looked at (`tests.bench.reconstruct`): the truth beside what the network said of it."""

from collections.abc import Callable, Sequence

import numpy as np

from models.arrays import Float
from models.camera.pinhole import Camera
from models.messages.observation import Observation, Person
from models.skeleton import coco
from tests.bench.closed_loop import Event
from tests.bench.reconstruct.lesson import START_NS, Lesson
from tests.twin.truth import VELOCITY_SPAN_S, Said, Stream, Truth

_FAR = 0.3
"""Somebody whose keypoints are further than this share of the stature from the pupil's points, in the median, is somebody else."""


def streams_of(lesson: Lesson, cameras: Sequence[str], events: Sequence[Event], delay_s: float) -> list[Stream]:
    """One stream a camera that looked; those with fewer than two looks are left out.

    Args:
        lesson: with the truth in its pictures.
        cameras: that looked.
        events: what fusion consumed.
        delay_s: from exposure to arrival.
    """
    streams = []
    for camera in lesson.rig.select(cameras):
        looks = sorted(
            (event for event in events if isinstance(event, Observation) and event.camera == camera.name),
            key=lambda look: look.t_mid_ns,
        )
        if len(looks) > 1:
            truth = _truth(lesson, camera, looks)
            streams.append(Stream(lesson.name, lesson.seed, truth, _said(truth, looks, delay_s)))
    return streams


def _truth(lesson: Lesson, camera: Camera, looks: Sequence[Observation]) -> Truth:
    t_s = np.array([(look.t_mid_ns - START_NS) * 1e-9 for look in looks])
    picture = lesson.pictures.get(camera.name)
    points_m = lesson.truth_m(t_s) if picture is None else picture.points_m[[look.frame for look in looks]]
    return Truth(camera, t_s, points_m[:, None], velocity(lesson.truth_m, t_s, lesson.length_s), np.array([lesson.stature_m]))


def velocity(points_m: Callable[[Float], Float], t_s: Float, length_s: float) -> Float:
    """(n, 17, 3) as in `Truth`; at the lesson's ends over half the span."""
    before, after = np.maximum(t_s - VELOCITY_SPAN_S, 0.0), np.minimum(t_s + VELOCITY_SPAN_S, length_s)
    return np.asarray((points_m(after) - points_m(before)) / (after - before)[:, None, None])


def _said(truth: Truth, looks: Sequence[Observation], delay_s: float) -> Said:
    count = len(looks)
    points_px = truth.camera.project(truth.points_m[:, 0])
    depth_m = truth.camera.to_camera(truth.points_m[:, 0].mean(axis=1))[:, 2]
    far_px = _FAR * truth.statures_m[0] * truth.camera.matrix_px[0, 0] / np.maximum(depth_m, 0.1)
    said = Said(
        keypoints_px=np.full((count, coco.COUNT, 2), np.nan),
        sigma_px=np.full((count, coco.COUNT), np.nan),
        score=np.full((count, coco.COUNT), np.nan),
        side_px=np.full(count, np.nan),
        renewed=np.zeros(count, np.bool_),
        delay_s=np.full(count, delay_s),
    )
    track: int | None = None
    for row, look in enumerate(looks):
        person = _nearest(look.persons, points_px[row], float(far_px[row]))
        if person is None:
            continue
        said.keypoints_px[row], said.sigma_px[row], said.score[row] = person.keypoints_px, person.sigma_px, person.score
        said.side_px[row] = person.crop.side_px
        said.renewed[row] = track is not None and person.track != track
        track = person.track
    return said


def _nearest(persons: Sequence[Person], points_px: Float, far_px: float) -> Person | None:
    distances = [float(np.median(np.linalg.norm(person.keypoints_px - points_px, axis=-1))) for person in persons]
    if not distances or not min(distances) < far_px:
        return None
    return persons[int(np.argmin(distances))]
