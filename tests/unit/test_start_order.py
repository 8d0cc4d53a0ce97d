from collections.abc import Sequence

import numpy as np
import pytest

from models.camera.pinhole import Camera
from models.camera.rig import Rig
from services.supervisor.child import ChildSpec
from services.supervisor.start_order import HEAD_START_S, LATEST_S, HeadStart, first


def rig_looking(degrees: Sequence[float]) -> Rig:
    return Rig(tuple(camera_looking(f"c{number}", angle) for number, angle in enumerate(degrees)))


def camera_looking(name: str, degrees: float) -> Camera:
    forward = np.array((np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0.0))
    right = np.cross(forward, (0.0, 0.0, 1.0))
    rotation = np.stack((right, np.cross(forward, right), forward))
    matrix = np.array(((700.0, 0.0, 640.0), (0.0, 700.0, 360.0), (0.0, 0.0, 1.0)))
    return Camera(name, (1280, 720), matrix, np.zeros(5), rotation, rotation @ (5 * forward), np.zeros(2))


def specs_of(rig: Rig) -> list[ChildSpec]:
    others = [ChildSpec(name) for name in ("tablet", "evaluation", "recorder")]
    return [ChildSpec("fusion"), *(ChildSpec("edge", name) for name in rig.names), *others]


def cameras_first(degrees: Sequence[float]) -> set[str]:
    rig = rig_looking(degrees)
    return {name.removeprefix("edge-") for name in first(specs_of(rig), rig)} - {"fusion", "tablet"}


@pytest.mark.parametrize(("degrees", "pair"), [((0, 10, 85), {"c0", "c2"}), ((0, 180, 200, 95), {"c0", "c3"})])
def test_the_first_two_cameras_see_the_pupil_from_sides_that_are_nearest_to_a_right_angle(
    degrees: Sequence[float], pair: set[str]
) -> None:
    assert cameras_first(degrees) == pair


@pytest.mark.parametrize("degrees", [(0,), (0, 90)])
def test_a_site_with_no_more_than_two_cameras_starts_them_all_at_once(degrees: Sequence[float]) -> None:
    assert len(cameras_first(degrees)) == len(degrees)


def test_a_replay_starts_whole() -> None:
    specs = [ChildSpec("replay"), ChildSpec("tablet"), ChildSpec("evaluation")]
    assert first(specs, rig_looking((0, 90, 180))) == {"replay", "tablet", "evaluation"}


def test_the_others_start_when_the_first_have_been_at_work_for_a_while_and_not_sooner() -> None:
    start = HeadStart({"fusion", "tablet", "edge-c0"}, 0.0)
    assert not start.is_over({"fusion", "tablet"}, 1.0)
    everybody = {"fusion", "tablet", "edge-c0", "supervisor"}
    assert not start.is_over(everybody, 2.0)
    assert not start.is_over(everybody, 2.0 + HEAD_START_S - 0.1)
    assert start.is_over(everybody, 2.0 + HEAD_START_S)


def test_a_first_camera_that_never_comes_does_not_hold_up_the_others_for_ever() -> None:
    start = HeadStart({"fusion", "edge-c0"}, 0.0)
    assert not start.is_over({"fusion"}, LATEST_S - 0.1)
    assert start.is_over({"fusion"}, LATEST_S)


def test_a_first_camera_that_ends_again_does_not_hold_up_the_others() -> None:
    start = HeadStart({"fusion", "edge-c0"}, 0.0)
    assert not start.is_over({"fusion", "edge-c0"}, 1.0)
    assert start.is_over({"fusion"}, 1.0 + HEAD_START_S)
