"""One step: a frame becomes an observation, and what it cost is known."""

from itertools import count

import numpy as np
import pytest

from edge.cameras.jpeg import JpegFrame
from edge.cameras.source import PictureError
from edge.cameras.video import Video
from edge.observe import EdgeConfig, EdgeState, Stages, observe
from edge.turns import default_control
from models.messages.control import CropPrediction, ViewControl
from models.messages.observation import Crop, Observation
from models.messages.precision import RELATIVE_ERROR
from tests.fake_networks import FIGURE, FakeDetector, FakePose, fake_networks
from tests.small_video import plain_picture, spot_picture, video_of

SIZE_PX = (320, 240)
CONTROL = default_control("cam01", 0, 4, 0, 30.0)
MS = 1_000_000


def spot_at(x: float, y: float) -> Video:
    return video_of([spot_picture(np.array((x, y)), 6.0, SIZE_PX)])


def dark() -> Video:
    return video_of([plain_picture(0, SIZE_PX)])


class Run:
    """Feeds pictures to the step, a tenth of a second apart."""

    def __init__(self) -> None:
        self.networks, pose, detector = fake_networks()
        self.pose: FakePose = pose
        self.detector: FakeDetector = detector
        self.state = EdgeState()
        self.t_ns = 0
        ticks = count(step=1000)
        self.stages = Stages(lambda: next(ticks))

    def see(self, video: Video, control: ViewControl = CONTROL, epoch: int = 0) -> Observation:
        frame = video.frame(epoch, 0, self.t_ns)
        self.t_ns += 100 * MS
        self.state, observation = observe(self.state, frame, self.networks, control, EdgeConfig(), self.stages)
        return observation


def test_keypoints_and_their_sigma_are_scaled_to_the_picture() -> None:
    run = Run()
    (person,) = run.see(spot_at(150, 110)).persons
    side = person.crop.side_px
    assert person.keypoints_px.mean(axis=0) == pytest.approx((150 + FIGURE[:, 0].mean() * side, 110), abs=0.5)
    assert person.sigma_px == pytest.approx(np.full(17, 0.01 * side), rel=RELATIVE_ERROR)
    assert person.score == pytest.approx(np.full(17, 0.8), rel=RELATIVE_ERROR)


def test_the_step_follows_without_detecting_again() -> None:
    run = Run()
    tracks = {run.see(spot_at(100 + 4 * k, 110)).persons[0].track for k in range(9)}
    assert tracks == {0}
    assert run.detector.calls == 1
    assert run.pose.calls == 9


def test_who_is_lost_is_searched_for_and_gets_a_new_number() -> None:
    run = Run()
    run.see(spot_at(100, 110))
    assert run.see(dark()).persons == ()
    run.t_ns += 300 * MS
    assert run.see(spot_at(220, 110)).persons[0].track == 1
    assert run.detector.calls == 2


def test_a_new_epoch_forgets_everyone() -> None:
    run = Run()
    run.see(spot_at(100, 110))
    later = run.see(spot_at(230, 110), epoch=1)
    assert (later.epoch, later.sequence, later.persons[0].track) == (1, 1, 1)
    assert run.detector.calls == 2


def test_a_prediction_from_before_the_seam_is_not_followed_into_the_new_epoch() -> None:
    run = Run()
    run.see(spot_at(100, 110))
    old = ViewControl("cam01", 1, 0, 10.0, 0, "thunder", False, CropPrediction(Crop(100, 110, 130, 0.0), 99 * MS, 0, 0))
    assert run.see(spot_at(230, 110), old, epoch=1).persons[0].crop.centre_x_px == pytest.approx(230, abs=2)
    new = ViewControl("cam01", 2, 0, 10.0, 0, "thunder", False, CropPrediction(Crop(231, 111, 130, 0.0), 200 * MS, 0, 0))
    assert run.see(spot_at(230, 110), new, epoch=1).persons[0].crop == Crop(231, 111, 130, 0.0)


def test_a_prediction_spares_the_detector_even_at_the_first_picture() -> None:
    run = Run()
    control = ViewControl("cam01", 1, 0, 10.0, 0, "thunder", False, CropPrediction(Crop(150, 110, 130, 0.2), 0, 0, 0))
    (person,) = run.see(spot_at(150, 110), control).persons
    assert person.crop == Crop(150, 110, 130, 0.2)
    assert run.detector.calls == 0


def test_observations_are_numbered_and_say_what_they_come_from() -> None:
    run = Run()
    run.see(dark())
    observation = run.see(spot_at(150, 110))
    expected = ("cam01", 0, 1, 0, 100 * MS, 0, "thunder")
    fields = ("camera", "epoch", "sequence", "frame", "t_mid_ns", "t_published_ns", "network")
    assert tuple(getattr(observation, field) for field in fields) == expected


def test_every_stage_is_charged_for_what_it_did() -> None:
    run = Run()
    run.see(spot_at(150, 110))
    first = dict(run.stages.spent_ns)
    assert set(first) == {"decode", "detect", "crop", "pose"}
    run.see(spot_at(150, 110))
    assert run.stages.spent_ns["detect"] == first["detect"]
    assert run.stages.spent_ns["pose"] == 2 * first["pose"]


def test_a_damaged_picture_leaves_the_state_as_it_was() -> None:
    run = Run()
    run.see(spot_at(150, 110))
    before = run.state
    frame = JpegFrame("cam01", 0, 1, run.t_ns, SIZE_PX, b"\xff\xd8 broken")
    with pytest.raises(PictureError):
        observe(run.state, frame, run.networks, CONTROL, EdgeConfig(), run.stages)
    assert run.see(spot_at(150, 110)).persons[0].track == before.tracks.people[0].number


def test_the_detector_sees_large_pictures_reduced_and_its_boxes_are_scaled_back() -> None:
    run = Run()
    large = video_of([spot_picture(np.array((700.0, 500.0)), 20.0, (1280, 960))])
    (person,) = run.see(large).persons
    assert run.detector.shapes == [(480, 640, 3)]
    assert (person.crop.centre_x_px, person.crop.centre_y_px) == pytest.approx((700, 500), abs=2)


def test_how_bright_a_picture_is_comes_from_its_brightest_places_and_not_from_a_hot_pixel() -> None:
    hot = plain_picture(0, SIZE_PX)
    hot[120, 160] = 255
    for video, low, high in ((dark(), 0.0, 2.0), (video_of([hot]), 0.0, 20.0), (spot_at(150, 110), 100.0, 255.0)):
        run = Run()
        run.see(video)
        assert run.state.bright is not None
        assert low <= run.state.bright <= high
