"""The second built-in footage through real networks and fusion: the pupil is held although somebody stands before him."""

from functools import cache

import cv2
import pytest

from edge.footage.sets import TWO_PEOPLE
from models.camera.rig import decode_rig
from tests.bench.closed_loop import Event
from tests.bench.footage import two_people
from tests.bench.footage.one_person import frames_without_pose
from tests.bench.footage.run import load_videos, look, pupil_keypoints
from tests.bench.reconstruct.fused import fuse
from tests.bench.reconstruct.observed import RATE_HZ
from tests.installed import ROOT, require_footage, require_networks

pytestmark = [pytest.mark.footage, pytest.mark.networks, pytest.mark.slow, pytest.mark.timeout(240)]

RIG = decode_rig((ROOT / "deploy/sites/footage2/rig.toml").read_bytes(), "rig.toml")
PICTURES = two_people.drawn(ROOT / "tests/data/footage2_people.toml")
FRAMES = 100


@cache
def events() -> list[Event]:
    """Ten looks a second of each camera, in turns, as a box of two cores has them."""
    cv2.setNumThreads(1)
    data = require_footage(TWO_PEOPLE)
    return look(RIG, load_videos(RIG, data, TWO_PEOPLE), require_networks(), 10.0)


def test_every_tenth_picture_is_drawn_and_nobodys_box_is_another_ones() -> None:
    assert {(picture["camera"], picture["frame"]) for picture in PICTURES} == {
        (name, frame) for name in RIG.names for frame in range(0, FRAMES, 10)
    }
    for picture in PICTURES:
        boxes = [picture["pupil"], picture["second"], *picture["bystanders"]]
        assert all(0 <= x0 < x1 <= 720 and 0 <= y0 < y1 <= 1270 for x0, y0, x1, y1 in boxes)
        assert len({tuple(box) for box in boxes}) == len(boxes)


def test_the_chosen_one_is_the_pupil_and_is_held() -> None:
    found = fuse(RIG, events(), FRAMES / RATE_HZ)
    assert frames_without_pose(found) == 0
    assert two_people.identity_switches(RIG, found, PICTURES) == 0
    for picture in PICTURES:
        if picture["frame"] >= 10:
            assert two_people.on_pupil(RIG, found.smooth_m, picture) > 0.5, f"{picture['camera']}, picture {picture['frame']}"


def test_the_second_person_is_never_fused() -> None:
    found = fuse(RIG, events(), FRAMES / RATE_HZ)
    points, _ = pupil_keypoints(RIG, events(), found.smooth_m)
    assert two_people.wrong_person_inliers(RIG, found, points, PICTURES) == 0


def test_a_fused_keypoint_on_somebody_else_would_be_counted() -> None:
    found = fuse(RIG, events(), FRAMES / RATE_HZ)
    points, _ = pupil_keypoints(RIG, events(), found.smooth_m)
    moved = [{**picture, "pupil": [0, 0, 1, 1], "second": picture["pupil"]} for picture in PICTURES]
    assert two_people.wrong_person_inliers(RIG, found, points, moved) > 100
    assert all(two_people.on_pupil(RIG, found.smooth_m, picture) < 0.5 for picture in moved if picture["frame"] >= 10)
