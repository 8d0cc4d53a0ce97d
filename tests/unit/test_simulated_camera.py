"""A rendered lesson plays as it was recorded: its times, its faults, and over and over."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import cv2
import msgspec
import numpy as np
import pytest

from edge.cameras.simulated import Recorded, open_simulated
from edge.cameras.source import Frame
from edge.check import check
from edge.inspect import inspect
from edge.simulation.lesson.cameras import rig_of
from edge.simulation.lesson.files import PLAN_NAME, film_path
from edge.simulation.lesson.lesson_rig import require_rig_of_lesson
from edge.simulation.lesson.plan import Plan, ShutterPlan, SwapPlan
from edge.simulation.lesson.world_faults import phase_s
from models.camera.rig import Rig
from models.config.site import SITE_VERSION, CameraConfig, FaultConfig, Site, decode_site
from models.errors import UserError
from tests.lesson_folder import CAMERAS, PICTURES, draw_lesson, plan_with
from tests.small_video import SIZE_PX
from tests.virtual_clock import VirtualClock

SECOND_NS = 1_000_000_000
START_NS = 7 * SECOND_NS


def played(folder: Path, plan: Plan, camera: str, seconds: float) -> list[Frame]:
    draw_lesson(folder, plan)
    clock, frames = VirtualClock(START_NS), list[Frame]()
    source, _ = open_simulated(folder, camera, START_NS, clock)
    while clock.t_ns < START_NS + seconds * SECOND_NS:
        if (frame := source.grab(0.2)) is not None:
            frames.append(frame)
    return frames


def level(frame: Frame) -> int:
    return round(float(frame.image(8).mean()))


def test_a_lesson_is_played_picture_by_picture_and_again_as_a_new_epoch(tmp_path: Path) -> None:
    frames = played(tmp_path / "lesson", plan_with(), "cam02", 2.5)
    numbers = [(frame.epoch, frame.index) for frame in frames[:75]]
    assert numbers == [divmod(number, PICTURES) for number in range(75)]
    assert all(0 <= frame.t_mid_ns - START_NS - k * SECOND_NS / 30 < 1 for k, frame in enumerate(frames))
    assert [level(frame) for frame in frames[::10]][:6] == pytest.approx([40, 50, 60, 40, 50, 60], abs=2)


def test_a_free_running_shutter_keeps_its_phase_over_all_loops(tmp_path: Path) -> None:
    plan = plan_with(shutter=ShutterPlan(phases="free_running"))
    frames = played(tmp_path / "lesson", plan, "cam03", 3.0)
    phase_ns = phase_s(plan, "cam03") * SECOND_NS
    assert phase_ns > 0
    for k, frame in enumerate(frames):
        assert frame.t_mid_ns - START_NS - k * SECOND_NS / 30 == pytest.approx(phase_ns, abs=2)


def test_cameras_that_swap_show_one_anothers_pictures_at_one_anothers_times(tmp_path: Path) -> None:
    plan = plan_with(swaps=[SwapPlan(cameras=("cam01", "cam03"), at_s=0.5)], shutter=ShutterPlan(phases="free_running"))
    for number, frame in enumerate(played(tmp_path / "lesson", plan, "cam01", 0.95)):
        t_s = (frame.t_mid_ns - START_NS) / SECOND_NS
        device, k = ("cam01", 0) if t_s < 0.5 else ("cam03", 2)
        index = round((t_s - phase_s(plan, device)) * 30)
        assert t_s == pytest.approx(phase_s(plan, device) + index / 30, abs=1e-8)
        assert level(frame) == pytest.approx(40 * k + index, abs=2), number


def test_what_befalls_a_camera_on_its_way_befalls_it_in_every_loop(tmp_path: Path) -> None:
    faults = [
        FaultConfig(camera="cam01", kind="drop", at_s=0.2, for_s=0.2),
        FaultConfig(camera="cam01", kind="dark", at_s=0.5, for_s=0.1),
        FaultConfig(camera="cam01", kind="drift", at_s=0.0, for_s=1.0, ppm=1000.0),
        FaultConfig(camera="cam02", kind="drop", at_s=0.0, for_s=1.0),
    ]
    frames = [frame for frame in played(tmp_path / "lesson", plan_with(faults=faults), "cam01", 2.0) if frame.epoch < 2]
    for epoch in range(2):
        seen = [frame for frame in frames if frame.epoch == epoch]
        assert {frame.index for frame in seen} == set(range(PICTURES)) - set(range(6, 12))
        for frame in seen:
            since_ns = frame.index * SECOND_NS / 30
            assert frame.t_mid_ns - START_NS - epoch * SECOND_NS - since_ns == pytest.approx(1e-3 * since_ns, abs=2)
            assert (level(frame) == 0) == (frame.index in {0, 15, 16, 17})


def test_times_of_a_lesson_are_asked_for_in_both_directions_and_agree() -> None:
    recorded = Recorded(100, (3, 10, 25), 30)
    times = [recorded.t_ns(number) for number in range(7)]
    assert times == [103, 110, 125, 133, 140, 155, 163]
    for now_ns in range(95, 165):
        assert recorded.newest(now_ns) == sum(t_ns <= now_ns for t_ns in times) - 1


def site_of(*names: str) -> Site:
    cameras = [CameraConfig(name=name, kind="simulated", path="simulated/drawn") for name in names]
    return Site(version=SITE_VERSION, name="s", calibration="rig.toml", cameras=cameras)


@pytest.mark.parametrize(
    ("harm", "said"),
    [
        (
            lambda folder: film_path(folder, "cam02").unlink(),
            r"camera 'cam02': .*cam02\.avi is missing; .* films of cam01, cam03: ",
        ),
        (lambda folder: film_path(folder, "cam02").write_bytes(b"x"), r"cam02\.avi has 1 bytes instead of .* `kinebox simulate`"),
        (lambda folder: (folder / PLAN_NAME).unlink(), r"camera 'cam01': .*drawn is no rendered lesson.*`kinebox simulate`"),
        (lambda folder: (folder / PLAN_NAME).write_text("version = 9\n"), r"plan\.toml: .*version 9"),
    ],
)
def test_a_lesson_that_cannot_be_played_is_found_before_anything_is_started(
    harm: Callable[[Path], object], said: str, tmp_path: Path
) -> None:
    folder = draw_lesson(tmp_path / "simulated/drawn", plan_with())
    harm(folder)
    site = site_of("cam01", "cam02")
    with pytest.raises(UserError, match=said):
        check(site, rig_of(plan_with(size_px=SIZE_PX)), tmp_path)
    assert any(found.fault for found in inspect(site, None, tmp_path, None))


def test_a_film_that_is_shown_only_after_a_swap_is_looked_for_before_anything_is_started(tmp_path: Path) -> None:
    plan = plan_with(swaps=[SwapPlan(cameras=("cam01", "cam03"), at_s=0.5)])
    folder = draw_lesson(tmp_path / "simulated/drawn", plan)
    film_path(folder, "cam03").unlink()
    with pytest.raises(UserError, match=r"camera 'cam01': .*cam03\.avi is missing"):
        check(site_of("cam01", "cam02"), rig_of(plan_with(size_px=SIZE_PX)), tmp_path)


@pytest.mark.parametrize(
    ("other", "said"),
    [
        (
            {"rig": "row"},
            r"^camera 'cam01' would see .* as wide.*: the site's calibration is of .*drawn; set `calibration` in the site file",
        ),
        ({"seed": 1}, r"^camera.* 'cam0[12]'.*: the site's calibration is of other cameras"),
    ],
)
def test_a_calibration_of_another_rig_is_refused_though_its_pictures_have_the_same_size(
    other: dict[str, object], said: str, tmp_path: Path
) -> None:
    plan = plan_with(size_px=SIZE_PX)
    draw_lesson(tmp_path / "simulated/drawn", plan)
    foreign = msgspec.structs.replace(plan, **other)
    with pytest.raises(UserError, match=said) as refused:
        check(site_of("cam01", "cam02"), rig_of(foreign), tmp_path)
    assert "\n" not in str(refused.value)
    faults = [found.fault for found in inspect(site_of("cam01", "cam02"), rig_of(foreign), tmp_path, None)]
    assert str(refused.value) in faults
    assert str(refused.value) not in [found.fault for found in inspect(site_of("cam01", "cam02"), rig_of(plan), tmp_path, None)]


def test_a_lesson_may_be_calibrated_anew_in_a_world_of_its_own(tmp_path: Path) -> None:
    plan = plan_with(size_px=SIZE_PX)
    turned, moved_m = cv2.Rodrigues(np.array((0.3, -0.2, 2.0)))[0], np.array((4.0, -3.0, 1.0))
    anew = [
        replace(
            camera, rotation=camera.rotation @ turned.T, translation_m=camera.translation_m - camera.rotation @ turned.T @ moved_m
        )
        for camera in rig_of(plan)
    ]
    anew[1] = replace(
        anew[1], translation_m=anew[1].translation_m + 0.1, matrix_px=anew[1].matrix_px * np.array((1.03, 1.03, 1))[:, None]
    )
    require_rig_of_lesson(tmp_path, plan, Rig(tuple(anew)))


def test_a_simulated_camera_has_its_rate_from_its_lesson() -> None:
    head = 'version = 2\nname = "s"\ncalibration = "rig.toml"\n'
    cameras = "".join(f'[[cameras]]\nname = "{name}"\nkind = "simulated"\npath = "l"\n' for name in CAMERAS)
    assert {camera.kind for camera in decode_site((head + cameras).encode(), "s").cameras} == {"simulated"}
    with pytest.raises(UserError, match=r"no\. 3 .*leave out `rate_hz`"):
        decode_site((head + cameras + "rate_hz = 15.0\n").encode(), "s")
