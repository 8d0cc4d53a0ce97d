"""Who is looked at: everyone in a search, the pupil once fusion points at it, the detector when nobody is there."""

from dataclasses import replace

import numpy as np
import pytest

from edge.perception.tracking import Look, TrackingConfig, Tracks, choose_looks, wants_detection, with_detections, with_poses
from models.arrays import Float
from models.messages.control import CARRIED_S, CropPrediction, ViewControl
from models.messages.observation import Crop, Person

CONFIG = TrackingConfig()
SEARCH = ViewControl("cam01", 1, 0, 10.0, 0, "thunder", True, None)
FOLLOW = ViewControl("cam01", 2, 0, 10.0, 0, "thunder", False, None)
MS = 1_000_000
TWO_BOXES = np.array(((100.0, 100.0, 300.0, 600.0), (500.0, 300.0, 560.0, 600.0)))


def predicting(x: float, y: float, side: float, t_ns: int, velocity: tuple[float, float] = (0.0, 0.0)) -> ViewControl:
    prediction = CropPrediction(Crop(x, y, side, 0.1), t_ns, *velocity)
    return ViewControl("cam01", 3, t_ns, 10.0, 0, "thunder", False, prediction)


HEAD = ((0, -45), (2, -47), (-2, -47), (5, -46), (-5, -46))
ARMS = ((12, -30), (-12, -30), (16, -10), (-16, -10), (18, 8), (-18, 8))
LEGS = ((8, 5), (-8, 5), (9, 28), (-9, 28), (9, 50), (-9, 50))
BODY = np.array((*HEAD, *ARMS, *LEGS), np.float64)
"""A person of height 97 around the origin."""


def pose(look: Look, centre: tuple[float, float], height: float, score: float = 0.8) -> Person:
    points = BODY * height / 97 + centre
    full = np.full(17, score, np.float32)
    return Person(look.number, look.crop, points.astype(np.float32), np.full(17, 2, np.float32), full)


def detected(boxes: Float = TWO_BOXES, t_ns: int = 0) -> Tracks:
    return with_detections(Tracks(), boxes, t_ns, CONFIG)


def seen(tracks: Tracks, control: ViewControl, t_ns: int, people: dict[int, tuple[float, float]], score: float = 0.8) -> Tracks:
    tracks, looks = choose_looks(tracks, control, t_ns, CONFIG)
    poses = tuple(pose(look, people[look.number], 480, score) for look in looks)
    return with_poses(tracks, poses, t_ns, CONFIG)[0]


def test_at_the_beginning_somebody_must_be_found() -> None:
    assert wants_detection(Tracks(), SEARCH, 0, CONFIG)
    assert choose_looks(Tracks(), SEARCH, 0, CONFIG)[1] == ()


def test_a_search_looks_at_everyone_under_their_own_number() -> None:
    _, looks = choose_looks(detected(), SEARCH, 0, CONFIG)
    assert [look.number for look in looks] == [0, 1]
    assert looks[0].crop == Crop(200, 350, 625, 0.0)


def test_more_people_than_looks_take_turns() -> None:
    boxes = np.array([(x, 100.0, x + 100.0, 400.0) for x in (0.0, 400.0, 800.0)])
    tracks = detected(boxes)
    seen_numbers = []
    for _ in range(3):
        tracks, looks = choose_looks(tracks, SEARCH, 0, CONFIG)
        seen_numbers += [look.number for look in looks]
    assert seen_numbers == [0, 1, 2, 0, 1, 2]


def test_people_beyond_the_limit_are_left_out_the_best_found_stay() -> None:
    boxes = np.array([(x, 100.0, x + 100.0, 400.0) for x in (0.0, 400.0, 800.0, 1200.0)])
    assert [track.crop.centre_x_px for track in detected(boxes).people] == [50, 450, 850]


def test_detecting_somebody_again_makes_no_second_track() -> None:
    tracks = with_detections(detected(), TWO_BOXES + 8.0, 10**9, CONFIG)
    assert [track.number for track in tracks.people] == [0, 1]


def test_while_tracking_the_detector_rests_and_in_a_search_it_runs_once_a_second() -> None:
    tracks = detected(t_ns=0)
    assert not wants_detection(tracks, SEARCH, 900 * MS, CONFIG)
    assert wants_detection(tracks, SEARCH, 1000 * MS, CONFIG)
    assert not wants_detection(tracks, predicting(200, 350, 600, 1000 * MS), 1000 * MS, CONFIG)


def test_while_nobody_is_there_the_detector_runs_four_times_a_second_and_not_at_every_picture() -> None:
    tracks = with_detections(Tracks(), np.empty((0, 4)), 0, CONFIG)
    assert not wants_detection(tracks, SEARCH, 100 * MS, CONFIG)
    assert wants_detection(tracks, SEARCH, 250 * MS, CONFIG)


def test_a_track_follows_its_own_keypoints() -> None:
    tracks = detected(TWO_BOXES[:1])
    for k in range(1, 20):
        tracks = seen(tracks, SEARCH, k * 100 * MS, {0: (200 + 15 * k, 350)})
    crop = tracks.people[0].crop
    assert (crop.centre_x_px, crop.centre_y_px) == pytest.approx((200 + 15 * 19, 356), abs=12)
    assert crop.side_px == pytest.approx(1.25 * 480, abs=30)
    assert tracks.people[0].at(2000 * MS).centre_x_px > crop.centre_x_px + 8


def test_a_crop_is_carried_on_by_a_quarter_of_its_side_at_most() -> None:
    track = replace(detected(TWO_BOXES[:1]).people[0], velocity_px_s=(4000.0, 0.0))
    assert track.at(1000 * MS).centre_x_px == pytest.approx(200 + 0.25 * 625)


def test_nobody_in_the_crop_ends_the_track_and_the_detector_is_asked() -> None:
    tracks = seen(detected(TWO_BOXES[:1]), SEARCH, 400 * MS, {0: (200, 350)}, score=0.1)
    assert tracks.people == ()
    assert wants_detection(tracks, SEARCH, 500 * MS, CONFIG)


def test_a_pose_that_jumps_onto_somebody_else_ends_the_track() -> None:
    tracks = seen(detected(TWO_BOXES[:1]), SEARCH, 100 * MS, {0: (200, 350)})
    tracks = seen(tracks, SEARCH, 200 * MS, {0: (430, 350)})
    assert tracks.people == ()


def test_two_tracks_on_one_person_become_one() -> None:
    tracks, looks = choose_looks(detected(), SEARCH, 0, CONFIG)
    poses = tuple(pose(look, (200, 350), 480) for look in looks)
    # The second look's crop lies elsewhere; it must hold the person for its keypoints to count.
    poses = (poses[0], Person(1, looks[0].crop, poses[1].keypoints_px, poses[1].sigma_px, poses[1].score))
    tracks, persons = with_poses(tracks, poses, 0, CONFIG)
    assert [track.number for track in tracks.people] == [0]
    assert [person.track for person in persons] == [0]


def test_the_most_confident_person_comes_first() -> None:
    tracks, looks = choose_looks(detected(), SEARCH, 0, CONFIG)
    poses = (pose(looks[0], (200, 350), 480, 0.5), pose(looks[1], (530, 450), 290, 0.9))
    _, persons = with_poses(tracks, poses, 0, CONFIG)
    assert [person.track for person in persons] == [1, 0]


def test_a_fresh_prediction_is_looked_at_alone_and_keeps_the_number_of_the_track_it_points_at() -> None:
    control = predicting(540, 460, 360, 100 * MS, velocity=(100.0, 0.0))
    tracks, looks = choose_looks(detected(), control, 150 * MS, CONFIG)
    assert looks == (Look(1, Crop(545, 460, 360, 0.1)),)
    assert tracks.focus == 1


def test_a_prediction_where_nobody_is_known_begins_a_new_track() -> None:
    tracks, looks = choose_looks(detected(), predicting(900, 460, 360, 0), 0, CONFIG)
    assert [look.number for look in looks] == [2]
    assert tracks.next_number == 3


def test_without_a_fresh_prediction_the_pupil_is_followed_by_its_own_keypoints() -> None:
    tracks = seen(detected(), predicting(200, 350, 600, 0), 0, {0: (200, 350)})
    for control in (FOLLOW, predicting(900, 900, 300, 0)):  # none, and one that is too old
        after, looks = choose_looks(tracks, control, 400 * MS, CONFIG)
        assert [look.number for look in looks] == [0]
        assert abs(looks[0].crop.centre_x_px - 200) < 20
        assert not wants_detection(after, control, 5000 * MS, CONFIG)


def test_when_the_pupil_is_lost_everyone_is_looked_for_again() -> None:
    tracks = seen(detected(), predicting(200, 350, 600, 0), 0, {0: (200, 350)})
    tracks = seen(tracks, FOLLOW, 400 * MS, {0: (200, 350)}, score=0.05)
    assert wants_detection(tracks, FOLLOW, 500 * MS, CONFIG)
    tracks = with_detections(tracks, TWO_BOXES, 500 * MS, CONFIG)
    assert [look.number for look in choose_looks(tracks, FOLLOW, 500 * MS, CONFIG)[1]] == [2, 3]


def test_a_seam_leaves_the_pupils_place_as_a_guess_and_forgets_the_others() -> None:
    assert detected().across_seam(5) == Tracks(next_number=2)
    followed = seen(detected(), predicting(200, 350, 600, 0), 0, {0: (200, 350)})
    after = followed.across_seam(7 * MS)
    (guess,) = after.people
    assert (guess.number, guess.t_ns, guess.seen, guess.velocity_px_s) == (0, 7 * MS, False, (0.0, 0.0))
    assert not wants_detection(after, FOLLOW, 7 * MS, CONFIG)
    empty = seen(after, FOLLOW, 7 * MS, {0: (200, 350)}, score=0.05)
    assert wants_detection(empty, FOLLOW, 40 * MS, CONFIG)


def test_no_prediction_is_followed_for_longer_than_it_is_known_to_stay_where_one_can_look() -> None:
    assert CONFIG.prediction_ns * 1e-9 <= CARRIED_S
