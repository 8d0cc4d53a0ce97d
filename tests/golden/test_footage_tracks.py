"""Against boxes drawn by hand: in every view the pupil is one track, the bystander another, and no pose drifts between them."""

import tomllib
from functools import cache

import cv2
import msgspec
import numpy as np
import pytest

from edge.cameras.video import Video, load_video
from edge.observe import Networks
from edge.offline import observe_video
from edge.perception.detection import load_person_detector
from edge.perception.pose import load_pose_network
from edge.process import DETECTION_SCORE_MIN
from models.messages.observation import Observation, Person
from tests.installed import ROOT, require_footage, require_networks

pytestmark = [pytest.mark.footage, pytest.mark.networks, pytest.mark.slow]

CAMERAS = ("cam01", "cam02", "cam03", "cam04")
STEP = 2
ROOM_PX = 10.0


class Picture(msgspec.Struct, forbid_unknown_fields=True):
    camera: str
    frame: int
    pupil: tuple[float, float, float, float]
    bystanders: list[tuple[float, float, float, float]]
    mannequins: list[tuple[float, float, float, float]]


@cache
def drawn(camera: str) -> list[Picture]:
    table = tomllib.loads((ROOT / "tests/data/footage_people.toml").read_text())["picture"]
    return [picture for picture in msgspec.convert(table, list[Picture]) if picture.camera == camera]


@cache
def observed(camera: str) -> dict[int, Observation]:
    """Every second picture, as at half the rate: harder than live, and half as long."""
    data = require_footage()
    cv2.setNumThreads(1)
    pose, detector = load_pose_network("thunder", require_networks()), load_person_detector(data, score_min=DETECTION_SCORE_MIN)
    whole = load_video(data / f"footage/{camera}.avi", camera)
    half = Video(camera, whole.size_px, tuple(whole.pictures[number] for number in range(0, len(whole.pictures), STEP)))
    return {STEP * o.frame: o for o in observe_video(half, Networks(pose, lambda: detector), 30.0)}


def inside(person: Person, box: tuple[float, float, float, float]) -> float:
    """Share of the confident keypoints within a box and a little room."""
    points = person.keypoints_px[person.score >= 0.3]
    low, high = np.array(box[:2]) - ROOM_PX, np.array(box[2:]) + ROOM_PX
    return float(((points >= low) & (points <= high)).all(axis=1).mean())


@pytest.mark.parametrize("camera", CAMERAS)
def test_every_tenth_picture_is_drawn_and_lies_within_the_picture(camera: str) -> None:
    assert [picture.frame for picture in drawn(camera)] == list(range(0, 100, 10))
    for picture in drawn(camera):
        for x0, y0, x1, y1 in (picture.pupil, *picture.bystanders, *picture.mannequins):
            assert 0 <= x0 < x1 <= 720
            assert 0 <= y0 < y1 <= 1270


@pytest.mark.parametrize("camera", CAMERAS)
def test_the_pupil_is_one_track_and_its_keypoints_lie_on_the_pupil(camera: str) -> None:
    tracks: set[int] = set()
    for picture in drawn(camera):
        persons = observed(camera)[picture.frame].persons
        pupil = max(persons, key=lambda person: inside(person, picture.pupil) * person.crop.side_px)
        assert inside(pupil, picture.pupil) >= 0.94, f"picture {picture.frame}"
        assert (pupil.score >= 0.3).sum() >= 14, f"picture {picture.frame}"
        tracks.add(pupil.track)
    assert len(tracks) == 1


@pytest.mark.parametrize("camera", ["cam01", "cam02"])
def test_the_bystander_is_another_track_and_never_the_pupils(camera: str) -> None:
    tracks: set[int] = set()
    pupils: set[int] = set()
    for picture in drawn(camera):
        for person in observed(camera)[picture.frame].persons:
            on_bystander = inside(person, picture.bystanders[0]) > 0.9
            (tracks if on_bystander else pupils).add(person.track)
    assert tracks
    assert not tracks & pupils


@pytest.mark.parametrize("camera", CAMERAS)
def test_no_picture_is_without_the_pupil(camera: str) -> None:
    assert all(observation.persons for observation in observed(camera).values())
