"""The lesson that comes with KineBox: compressed without noise, and given its noise where it is installed, the same everywhere."""

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from edge.cameras.video import load_video
from edge.footage.transcode import write_motion_jpeg
from edge.simulation.lesson.attempts import read_attempts
from edge.simulation.lesson.cameras import rig_of
from edge.simulation.lesson.files import ATTEMPTS_NAME, FOLDER, SHIPPED, TRUTH_NAME, VIDEO_SUFFIX
from edge.simulation.lesson.plan import read_plan
from edge.simulation.lesson.plan_check import require_sound
from edge.simulation.lesson.presets import SIX_ACTIONS, six_actions
from edge.simulation.rendering.film import sensor_of
from edge.simulation.rendering.render_lesson import JPEG_QUALITY
from edge.simulation.shipped.install import SOURCE, cameras
from edge.simulation.shipped.ship import SITE, compress
from edge.simulation.shipped.worker import linear_light, make_film
from edge.simulation.truth import truth_file
from models.arrays import UInt8
from models.camera.rig import decode_rig
from models.config.site import decode_site
from models.errors import UserError
from tests.small_video import video_of

SIZE_PX = (320, 192)
PLAN = six_actions()


def picture(number: int) -> UInt8:
    """Bands of grey with a square that moves."""
    shown = np.repeat(np.linspace(30, 220, 8).astype(np.uint8), SIZE_PX[0] // 8)
    rows = np.repeat(shown[None], SIZE_PX[1], axis=0)
    rows[60:120, 20 + 4 * number : 80 + 4 * number] = 128
    return np.repeat(rows[..., None], 3, axis=2)


@pytest.fixture(scope="module")
def video(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("ship")
    write_motion_jpeg(folder / "cam01.avi", map(picture, range(10)), Fraction(30))
    compress(folder / "cam01.avi", folder / f"cam01{VIDEO_SUFFIX}", 30.0, crf=30, speed=8)
    return folder / f"cam01{VIDEO_SUFFIX}"


def test_a_compressed_film_gets_back_its_pictures_and_the_noise_of_its_sensor(video: Path, tmp_path: Path) -> None:
    assert make_film(video, tmp_path / "cam01.avi", PLAN, "cam01") == 10
    film = load_video(tmp_path / "cam01.avi", "cam01")
    assert film.size_px == SIZE_PX
    for number in (0, 9):
        shown, wanted = film.frame(0, number, 0).image().astype(float), picture(number).astype(float)
        flat = (slice(130, 170), slice(84, 116))
        assert shown[flat].mean() == pytest.approx(wanted[flat].mean(), abs=2.0)
        assert np.abs(shown - wanted).mean() < 8
        light = np.full((40, 32, 3), linear_light()[round(wanted[flat].mean())], np.float32)
        sensor = replace(sensor_of(PLAN, "cam01"), vignetting=0.0, white_balance=(1.0, 1.0, 1.0))
        noise = jpeg_and_back(sensor.develop(light, number))
        assert shown[flat].std() == pytest.approx(noise.std(), rel=0.5)
        assert noise.std() > 0.3, "some of it comes through JPEG"


def jpeg_and_back(shown: UInt8) -> UInt8:
    return video_of([np.ascontiguousarray(shown[..., ::-1])], quality=JPEG_QUALITY).frame(0, 0, 0).image()


def test_the_noise_is_the_same_in_every_installation_and_another_in_every_picture_and_camera(video: Path, tmp_path: Path) -> None:
    for name in ("one.avi", "two.avi"):
        make_film(video, tmp_path / name, PLAN, "cam01")
    make_film(video, tmp_path / "other.avi", PLAN, "cam02")
    one, other = (load_video(tmp_path / name, "cam01").frame(0, 5, 0).image() for name in ("one.avi", "other.avi"))
    assert (tmp_path / "one.avi").read_bytes() == (tmp_path / "two.avi").read_bytes()
    assert (one != other).any()


def test_a_film_that_cannot_be_read_is_named_and_nothing_is_left(tmp_path: Path) -> None:
    (tmp_path / "cam01.mkv").write_bytes(b"no film")
    with pytest.raises(UserError, match=r"cam01\.mkv cannot be read .*git checkout"):
        make_film(tmp_path / "cam01.mkv", tmp_path / "cam01.avi", PLAN, "cam01")
    assert [path.name for path in tmp_path.iterdir()] == ["cam01.mkv"]


def test_linear_light_is_undone_by_the_sensors_curve() -> None:
    levels = np.arange(256)
    light = np.repeat(linear_light()[levels][None, :, None], 3, axis=2)
    sensor = sensor_of(PLAN, "cam01")
    still = replace(sensor, full_well_e=np.inf, read_noise_e=0.0, vignetting=0.0, white_balance=(1.0, 1.0, 1.0))
    assert np.abs(still.develop(light, 0)[0, :, 0].astype(int) - levels).max() <= 1


def test_what_is_shipped_is_small_and_has_a_plan_that_can_still_be_rendered() -> None:
    size = sum(path.stat().st_size for path in SOURCE.iterdir())
    assert size <= 10_000_000
    plan = read_plan(SOURCE, "cam01")
    assert plan == PLAN, "the plan has changed since: python -m edge.simulation.shipped.ship"
    require_sound(plan, "shipped")
    assert tuple(cameras()) == rig_of(plan).names


def test_the_site_of_the_shipped_lesson_names_its_cameras_and_where_they_stand() -> None:
    site = decode_site((SITE / "site.toml").read_bytes(), "site.toml")
    rig = decode_rig((SITE / site.calibration).read_bytes(), site.calibration)
    assert [camera.name for camera in site.cameras] == list(rig.names) == cameras()
    assert {(camera.kind, camera.path) for camera in site.cameras} == {("simulated", f"{FOLDER}/{SHIPPED}")}
    for camera, planned in zip(rig, rig_of(read_plan(SOURCE, "cam01")), strict=True):
        assert np.allclose(camera.projection, planned.projection, rtol=1e-9), "but for how another processor rounds"


def test_what_is_true_in_the_shipped_lesson_covers_all_of_it() -> None:
    attempts = read_attempts(SOURCE / ATTEMPTS_NAME)["pupil"]
    truth = truth_file.read(SOURCE / TRUTH_NAME)
    assert tuple(attempt.action for attempt in attempts) == SIX_ACTIONS
    assert sorted(truth.cameras) == cameras()
    for camera in truth.cameras.values():
        assert camera.times_s[-1] > attempts[-1].end_s
        upright = [attempt for attempt in attempts if attempt.action != "forward_roll"]
        during = [(camera.times_s > attempt.start_s) & (camera.times_s < attempt.end_s) for attempt in upright]
        seen = np.concatenate([camera.coco_px[each, 0].reshape(-1, 2) for each in during])
        assert ((seen > 0) & (seen < np.array((1280, 720)))).all(axis=1).mean() > 0.97
