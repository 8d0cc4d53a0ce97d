"""The Shelf's frames through the box's own fusion of several people, and what the edge would have done before it.

OpenPose has neither tracks nor sigmas: a picture's persons are carried on from the last pictures' by their nearest keypoints, and a
keypoint's sigma is a share of the person's size. From there on it is `persons`, `person_estimates` and `triangulation` of
`services.fusion`, at 25 frames a second; a frame is read out five frames later, from nothing newer.
"""

import time
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy.optimize import linear_sum_assignment

from models.arrays import Float
from models.messages.motion import JointState
from services.fusion.config import PRESETS
from services.fusion.person_estimates import PersonEstimates
from services.fusion.persons import Persons
from services.fusion.verdict import Pose
from services.fusion.views import Sighting, Views
from tests.bench.shelf.data import RATE_HZ
from tests.bench.shelf.openpose import Grouped

LAG_FRAMES: Final = 5
SIGMA_OF_SIZE: Final = 0.02
"""Sigma of a keypoint over the diagonal of its person's box; from 0.01 to 0.03 PCP on frames 300-374 is the same within 0.1."""
CONFIG: Final = replace(PRESETS["default"], preset="shelf", frame_s=1 / RATE_HZ, smooth_lag_frames=LAG_FRAMES)
_START_S: Final = 100.0
_SAME_PERSON: Final = 0.2
"""Median distance of the keypoints of two looks at one person, over the person's size."""
_MIN_COMMON: Final = 4
_FORGET_FRAMES: Final = 5


class PictureTracks:
    """Gives the persons of one camera's pictures track numbers, as the edge does."""

    def __init__(self) -> None:
        self._last: dict[int, tuple[int, Grouped]] = {}
        self._next = 0

    def numbers(self, persons: list[Grouped], frame: int) -> list[int]:
        """The track of each person of the next picture."""
        known = {track: seen for track, (since, seen) in self._last.items() if frame - since <= _FORGET_FRAMES}
        distances = np.array([[_apart(person, seen) for seen in known.values()] for person in persons])
        numbers = [-1] * len(persons)
        if distances.size:
            cost = np.minimum(distances, 1e3)
            for person, place in zip(*linear_sum_assignment(cost), strict=True):
                if distances[person, place] < _SAME_PERSON:
                    numbers[person] = list(known)[place]
        for index, person in enumerate(persons):
            if numbers[index] < 0:
                numbers[index] = self._next
                self._next += 1
            self._last[numbers[index]] = (frame, person)
        return numbers


@dataclass(frozen=True)
class Followed:
    """What came out.

    Attributes:
        smooth, live: of each frame, person number -> (17, 3); NaN what is unknown.
        cpu_s: of fusion, from grouped persons to smooth joints.
    """

    smooth: list[dict[int, Float]]
    live: list[dict[int, Float]]
    cpu_s: float


def follow(views: Views, frames: list[list[list[Grouped]]]) -> Followed:
    """Everyone in all frames, given the persons of each frame's pictures, camera by camera."""
    persons, tracks = Persons(views), [PictureTracks() for _ in range(len(views))]
    followed = Followed([{} for _ in frames], [{} for _ in frames], 0.0)
    cpu_s = 0.0
    for frame in range(len(frames) + LAG_FRAMES):
        t_s = _START_S + frame / RATE_HZ
        seen: list[tuple[Sighting, ...]] = []
        if frame < len(frames):
            seen = [
                tuple(
                    _sighting(camera, track, t_s, person)
                    for track, person in zip(tracks[camera].numbers(pictures, frame), pictures, strict=True)
                )
                for camera, pictures in enumerate(frames[frame])
            ]
        began_s = time.thread_time()
        for camera, sightings in enumerate(seen):
            persons.observe(camera, t_s, sightings, CONFIG)
        persons.tick(t_s, CONFIG)
        poses = {known.number: _poses(known.estimates, t_s) for known in persons.people}
        cpu_s += time.thread_time() - began_s
        for number, (live, smooth) in poses.items():
            if frame < len(frames):
                followed.live[frame][number] = _known(live)
            if frame >= LAG_FRAMES:
                followed.smooth[frame - LAG_FRAMES][number] = _known(smooth)
    return replace(followed, cpu_s=cpu_s)


def _poses(estimates: PersonEstimates, t_s: float) -> tuple[Pose, Pose]:
    """Now, without any delay, and `LAG_FRAMES` ago."""
    due = round(t_s * RATE_HZ) - LAG_FRAMES
    live, (smooth,) = estimates.poses(t_s, t_s, range(due, due + 1), CONFIG)
    return live, smooth


def _known(pose: Pose) -> Float:
    return np.where((pose.states != JointState.UNKNOWN)[:, None], pose.joints_m, np.nan)


def _sighting(camera: int, track: int, t_s: float, person: Grouped) -> Sighting:
    config = CONFIG.sighting
    usable = person.score >= config.min_score
    sigma = np.hypot(1.0, SIGMA_OF_SIZE * _size(person)) * np.maximum(1.0, config.full_score / np.maximum(person.score, 1e-3))
    return Sighting(camera, track, t_s, person.points_px, sigma, usable)


def _size(person: Grouped) -> float:
    return float(np.linalg.norm(np.ptp(person.points_px[person.score > 0], axis=0)))


def _apart(person: Grouped, seen: Grouped) -> float:
    common = (person.score > 0) & (seen.score > 0)
    if common.sum() < _MIN_COMMON:
        return np.inf
    return float(np.median(np.linalg.norm(person.points_px[common] - seen.points_px[common], axis=1))) / max(_size(person), 1.0)
