"""The pupil's keypoints among what the cameras saw, beside where the points truly are in those pictures."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from models.arrays import Bool, Float, Float32
from models.messages.observation import Observation
from models.skeleton import coco
from tests.bench.closed_loop import Event
from tests.bench.reconstruct.lesson import START_NS, Lesson
from tests.bench.reconstruct.observed import CONFIG, RATE_HZ


@dataclass(frozen=True, eq=False)
class Seen:
    """One camera's looks at the pupil; n pictures in the order of time, NaN where the pupil was not found.

    Attributes:
        camera: index in the rig of the cameras that looked.
        numbers: (n,) of the pictures.
        times_s: (n,) mid-exposures, from the lesson's beginning.
        points_px: (n, 17, 2) as observed.
        scores: (n, 17).
        truth_px, truth_m: (n, 17, 2) and (n, 17, 3) where the points are; as exposed, if the lesson knows.
        visible: (n, 17); true throughout if the lesson does not know.
    """

    camera: int
    numbers: Float
    times_s: Float
    points_px: Float
    scores: Float
    truth_px: Float
    truth_m: Float
    visible: Bool

    @property
    def used(self) -> Bool:
        """(n, 17) which keypoints fusion would use."""
        return np.asarray(self.scores >= CONFIG.sighting.min_score)


def pupil_seen(lesson: Lesson, cameras: Sequence[str], events: Sequence[Event]) -> list[Seen]:
    """By camera, the person of each observation who is nearest to where the pupil truly is."""
    rig = lesson.rig.select(cameras)
    found = []
    for index, camera in enumerate(rig):
        looks = [event for event in events if isinstance(event, Observation) and event.camera == camera.name]
        looks.sort(key=lambda look: look.t_mid_ns)
        numbers = np.array([look.frame for look in looks], np.int64)
        times_s = np.array([(look.t_mid_ns - START_NS) * 1e-9 for look in looks])
        picture = lesson.pictures.get(camera.name)
        truth_m = lesson.truth_m(times_s) if picture is None else picture.points_m[numbers]
        truth_px = camera.project(truth_m) if picture is None else picture.points_px[numbers]
        visible = np.ones(truth_px.shape[:2], np.bool_) if picture is None else picture.visible[numbers]
        points = np.full((len(looks), coco.COUNT, 2), np.nan)
        scores = np.full((len(looks), coco.COUNT), np.nan)
        for row, look in enumerate(looks):
            distances = [_apart(person.keypoints_px, truth_px[row]) for person in look.persons]
            if distances:
                nearest = look.persons[int(np.argmin(distances))]
                points[row], scores[row] = nearest.keypoints_px, nearest.score
        found.append(Seen(index, numbers.astype(np.float64), times_s, points, scores, truth_px, truth_m, visible))
    return found


def by_frame(seen: Sequence[Seen], frames: int) -> tuple[Float, Float]:
    """Keypoints (frames, cameras, 17, 2) and scores (frames, cameras, 17) of cameras that looked at every frame."""
    points = np.full((frames, len(seen), coco.COUNT, 2), np.nan)
    scores = np.full((frames, len(seen), coco.COUNT), np.nan)
    for camera in seen:
        rows = camera.numbers.astype(np.int64)
        inside = rows < frames
        points[rows[inside], camera.camera], scores[rows[inside], camera.camera] = camera.points_px[inside], camera.scores[inside]
    return points, scores


def interpolated(seen: Sequence[Seen], frames: int, longest_gap_s: float = 0.2) -> tuple[Float, Float]:
    """As `by_frame` for cameras that took turns: each camera's own track, linear between its looks, at the output's instants.

    What somebody would do who has such a recording and a method that wants whole frames.
    """
    instants = np.arange(frames) / RATE_HZ
    points = np.full((frames, len(seen), coco.COUNT, 2), np.nan)
    scores = np.full((frames, len(seen), coco.COUNT), np.nan)
    for camera in seen:
        found = np.isfinite(camera.scores).all(axis=1)
        times = camera.times_s[found]
        if len(times) < 2:
            continue
        after = np.clip(np.searchsorted(times, instants), 1, len(times) - 1)
        gap = times[after] - times[after - 1]
        share = (instants - times[after - 1]) / gap
        known = (gap <= longest_gap_s) & (share >= -0.5) & (share <= 1.5)
        weight = np.clip(share, 0, 1)[:, None]
        values, trust = camera.points_px[found], camera.scores[found]
        between = (1 - weight[..., None]) * values[after - 1] + weight[..., None] * values[after]
        points[known, camera.camera] = between[known]
        scores[known, camera.camera] = ((1 - weight) * trust[after - 1] + weight * trust[after])[known]
    return points, scores


def _apart(points_px: Float | Float32, truth_px: Float) -> float:
    distance = np.linalg.norm(points_px - truth_px, axis=-1)
    finite = distance[np.isfinite(distance)]
    return float(np.median(finite)) if len(finite) else np.inf
