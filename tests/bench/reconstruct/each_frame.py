"""What triangulation would make of each frame alone: of the very person whom fusion is judged by."""

from collections.abc import Iterable, Sequence

import msgspec
import numpy as np

from models.arrays import Float
from models.camera.rig import Rig
from models.messages.observation import Observation, Person
from models.skeleton import coco
from services.fusion.triangulation import triangulate
from services.fusion.views import Views, sightings
from tests.bench.closed_loop import Event
from tests.bench.reconstruct.observed import CONFIG


def looks_at_pupil(rig: Rig, events: Iterable[Event], near_m: Float) -> list[Observation]:
    """Observations in which somebody was seen, with nobody in them but who is nearest to a pose.

    Args:
        rig: calibration.
        events: recorded.
        near_m: (frames, 17, 3) poses that tell the pupil from others; where they don't, whom the network is surest of is taken.
    """
    found = []
    for event in events:
        if isinstance(event, Observation) and event.persons and event.frame < len(near_m):
            projected = rig.cameras[rig.index(event.camera)].project(near_m[event.frame])
            distances = [_distance_px(person, projected) for person in event.persons]
            nearest = event.persons[distances.index(min(distances))]
            found.append(msgspec.structs.replace(event, persons=(nearest,)))
    return found


def frame_by_frame(rig: Rig, looks: Sequence[Observation], frames: int) -> Float:
    """(frames, 17, 3) robust triangulation of each frame alone, without any smoothing; NaN where two views don't agree.

    For runs in which every camera looks at every frame; `looks` as `looks_at_pupil` gives them.
    """
    views = Views.of(rig)
    points = np.zeros((frames, len(rig), coco.COUNT, 2))
    sigma = np.ones((frames, len(rig), coco.COUNT))
    usable = np.zeros((frames, len(rig), coco.COUNT), bool)
    for look in looks:
        (pupil,) = sightings(look, views, CONFIG.sighting)
        place = look.frame, pupil.camera
        points[place], sigma[place], usable[place] = pupil.points_px, pupil.sigma_px, pupil.usable
    joints = np.full((frames, coco.COUNT, 3), np.nan)
    for number in range(frames):
        found = triangulate(views, points[number], sigma[number], usable[number], CONFIG.triangulation)
        agreed = found.count >= 2
        joints[number, agreed] = found.points_m[agreed]
    return joints


def _distance_px(person: Person, projected: Float) -> float:
    distance = np.linalg.norm(person.keypoints_px - projected, axis=-1)
    finite = distance[np.isfinite(distance)]
    return float(np.median(finite)) if len(finite) else float(-person.score.mean())
