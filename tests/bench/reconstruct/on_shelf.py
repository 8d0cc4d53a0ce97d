"""The Shelf that a user holds: everyone in its pictures by the real networks, or, from our own files, by OpenPose's candidates."""

import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Final

import cv2
import numpy as np

from edge.observe import EdgeConfig, EdgeState, Networks, Stages, observe
from edge.perception.detection import load_person_detector
from edge.perception.pose import load_pose_network
from edge.process import DETECTION_SCORE_MIN
from edge.turns import default_control
from models.messages.observation import Person
from services.fusion.warm_up import warm_up
from tests.bench.datasets import shelf
from tests.bench.datasets.film import DecodedFrame
from tests.bench.datasets.shelf import ShelfFilm
from tests.bench.report import Report
from tests.bench.shelf import measure as candidates
from tests.bench.shelf.data import RATE_HZ, Shelf, load_shelf
from tests.bench.shelf.openpose import Grouped

PEOPLE_MAX: Final = 5
"""Four people are around the shelf; the box itself looks at no more than three in a search."""
_SHOWN_EVERY: Final = 50


def run(folder: Path, data: Path) -> int:
    """Measure, print, write; returns the exit code.

    Raises:
        UserError: a file is missing or foreign, or the networks are not installed.
    """
    if (folder / "ground_truth.json").is_file():
        return candidates.run(load_shelf(folder), data)
    film = shelf.load(folder)
    warm_up()
    cv2.setNumThreads(1)
    pose, detector = load_pose_network("thunder", data), load_person_detector(data, "cpu", DETECTION_SCORE_MIN)
    grouped = everyone(film, Networks(pose, lambda: detector))
    known = Shelf(film.rig, [], film.truth)
    report = Report("bench-reconstruct-shelf")
    report.add(candidates.measure(known, grouped, tuple(range(len(film.rig))), ""))
    return report.conclude({}, data)


def everyone(film: ShelfFilm, networks: Networks) -> list[list[list[Grouped]]]:
    """The persons in each frame's pictures, camera by camera."""
    config = EdgeConfig()
    config = replace(config, tracking=replace(config.tracking, people_max=PEOPLE_MAX, looks_max=PEOPLE_MAX))
    stages = Stages(time.process_time_ns)
    views = []
    for camera in film.rig:
        control = default_control(camera.name, 0, 1, 0, RATE_HZ)
        state, view = EdgeState(), list[list[Grouped]]()
        for number, path in enumerate(film.paths[camera.name]):
            frame = DecodedFrame(camera.name, number, round(number * 1e9 / RATE_HZ), camera.size_px, shelf.picture(path))
            state, observation = observe(state, frame, networks, control, config, stages)
            view.append([_grouped(person) for person in observation.persons])
            if number % _SHOWN_EVERY == 0:
                sys.stderr.write(f"camera {camera.name}: picture {number} of {len(film.paths[camera.name])}\n")
        views.append(view)
    return [list(pictures) for pictures in zip(*views, strict=True)]


def _grouped(person: Person) -> Grouped:
    return Grouped(person.keypoints_px.astype(np.float64), person.score.astype(np.float64))
