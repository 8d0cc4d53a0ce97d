"""Cameras that are not where the calibration says must be named, and no camera that is."""

from dataclasses import replace

import msgspec
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.camera.rig import Rig
from models.messages.observation import Observation
from services.fusion.agreement import Agreement, Disagreement
from services.fusion.config import SightingConfig
from tests.synthetic.gym import Gym, knocked, ring_rig
from tests.synthetic.person import Person

pytestmark = pytest.mark.slow

SECONDS = 14.0


def calibrated_as(rig: Rig, order: tuple[int, ...]) -> Rig:
    """The same cameras' names with the calibration of others."""
    return Rig(tuple(replace(rig.cameras[source], name=name) for name, source in zip(rig.names, order, strict=True)))


def told(rig: Rig, gym: Gym) -> Disagreement | None:
    agreement = Agreement(rig, SightingConfig())
    for event in gym.events():
        if isinstance(event, Observation):
            agreement.observe(event)
    return agreement.judge()


@pytest.mark.parametrize("rate_hz", [5.0, 12.0, 30.0])
def test_nobody_is_blamed_when_the_calibration_is_right_whatever_the_network_gets_wrong(rate_hz: float) -> None:
    gym = Gym(seconds=SECONDS, rates_hz=(rate_hz,), bystanders=((Person(centre_m=(1.5, 2.0), phase=0.3), (0, 2)),))
    assert told(gym.rig, gym) is None


def test_a_camera_that_mostly_looks_at_somebody_else_is_not_blamed() -> None:
    # A box that has no CPU for more looks at one person a picture, and then not always at the same one as the other cameras.
    gym = Gym(seconds=20.0, rates_hz=(5.0,), bystanders=((Person(centre_m=(1.5, 2.0), phase=0.3), (2,)),))
    agreement = Agreement(gym.rig, SightingConfig())
    for event in gym.events():
        if isinstance(event, Observation):
            other = event.camera == "cam2" and event.t_mid_ns // 1_000_000_000 % 5 < 3
            looked_at = event.persons[1:] if other else event.persons[:1]
            agreement.observe(msgspec.structs.replace(event, persons=looked_at))
    assert agreement.judge() is None


@pytest.mark.parametrize(("a", "b"), [(0, 1), (0, 2), (1, 3)])
def test_two_cameras_that_are_exchanged_are_named_as_exchanged(a: int, b: int) -> None:
    gym = Gym(seconds=SECONDS)
    order = list(range(4))
    order[a], order[b] = b, a
    found = told(calibrated_as(gym.rig, tuple(order)), gym)
    assert found is not None
    # In a ring, exchanging opposite cameras looks like exchanging the other two, turned by half a circle.
    assert (f"cam{a}", f"cam{b}") in found.exchanged
    assert len(found.exchanged) <= 2
    assert f"cam{a} and cam{b}" in found.trouble.words
    assert found.trouble.code == "cameras_exchanged"


def test_a_camera_that_was_turned_is_named_alone() -> None:
    gym = Gym(seconds=SECONDS)
    found = told(knocked(gym.rig, 2), gym)
    assert found is not None
    assert found.strangers == ("cam2",)
    assert found.exchanged == ()
    assert (found.trouble.code, found.trouble.words) == ("camera_moved", "cam2 does not agree with the calibration")


def turned_in_the_plane_of(rig: Rig, index: int, other: int, angle: float) -> Rig:
    """The same, but turned so that what the camera sees moves along the lines that another one's points draw in its picture."""
    camera = rig.cameras[index]
    axis = np.cross(np.array((0.0, 0.0, 1.0)) - camera.centre_m, rig.cameras[other].centre_m - camera.centre_m)
    rotation = camera.rotation @ Rotation.from_rotvec(angle * axis / np.linalg.norm(axis)).as_matrix()
    moved = replace(camera, rotation=rotation, translation_m=-rotation @ camera.centre_m)
    return Rig((*rig.cameras[:index], moved, *rig.cameras[index + 1 :]))


def test_a_camera_that_was_turned_is_named_also_if_beside_one_other_it_fits_now_and_then() -> None:
    gym = Gym(seconds=SECONDS)
    found = told(turned_in_the_plane_of(gym.rig, 2, 0, 0.05), gym)
    assert found is not None
    assert found.strangers == ("cam2",)
    assert found.trouble.code == "camera_moved"


def test_two_cameras_that_never_see_the_same_person_do_not_keep_a_camera_from_being_named() -> None:
    gym = Gym(seconds=32.0)
    agreement = Agreement(knocked(gym.rig, 2), SightingConfig())
    for event in gym.events():
        if isinstance(event, Observation):
            # The two look at different halves of the room, between which the pupil goes to and fro; both go on to send pictures.
            sees_pupil = {"cam2": event.t_mid_ns // 4_000_000_000 % 2 == 0, "cam3": event.t_mid_ns // 4_000_000_000 % 2 == 1}
            agreement.observe(event if sees_pupil.get(event.camera, True) else msgspec.structs.replace(event, persons=()))
    found = agreement.judge()
    assert found is not None
    assert found.strangers == ("cam2",)


def test_two_cameras_can_only_be_told_to_contradict_one_another() -> None:
    gym = Gym(rig=ring_rig(5), seconds=SECONDS)
    pair = Rig(gym.rig.cameras[:2])
    wrong = Rig((pair.cameras[0], replace(gym.rig.cameras[3], name="cam1")))
    found = told(wrong, replace(gym, rig=pair))
    assert found is not None
    assert found.contradictory
    assert found.exchanged == ()
    assert found.trouble.code == "cameras_disagree"
    assert "cam0, cam1 do not agree with one another" in found.trouble.words


def test_nobody_is_blamed_before_there_is_enough_to_tell() -> None:
    gym = Gym(seconds=3.0)
    assert told(calibrated_as(gym.rig, (1, 0, 2, 3)), gym) is None
    empty = Agreement(gym.rig, SightingConfig())
    assert empty.judge() is None


def watched(rig: Rig, gym: Gym, shifts: tuple[tuple[tuple[int, ...], float], ...]) -> list[Disagreement | None]:
    """Every second's verdict on a gym of which, one shift after the other, only some cameras are heard for so many seconds."""
    agreement, verdicts = Agreement(rig, SightingConfig()), list[Disagreement | None]()
    pictures = [event for event in gym.events() if isinstance(event, Observation)]
    begin_s = pictures[0].t_mid_ns * 1e-9
    ends_s = np.cumsum([seconds for _, seconds in shifts])
    second = 0
    for picture in pictures:
        t_s = picture.t_mid_ns * 1e-9 - begin_s
        shift = int(np.searchsorted(ends_s, t_s, side="right"))
        if shift == len(shifts):
            break
        if picture.camera in {rig.names[i] for i in shifts[shift][0]}:
            agreement.observe(picture)
        if t_s >= second + 1:
            second += 1
            verdicts.append(agreement.judge())
    return verdicts


def test_cameras_that_were_not_yet_compared_with_one_another_do_not_contradict() -> None:
    gym = Gym(seconds=40.0)
    # After a seam under load some cameras are back before the others.
    verdicts = watched(gym.rig, gym, (((0, 1), 12.0), ((2, 3), 12.0), ((0, 1, 2, 3), 12.0)))
    assert len(verdicts) >= 34
    assert verdicts == [None] * len(verdicts)


def test_the_first_verdict_on_exchanged_cameras_is_that_they_are_exchanged() -> None:
    gym = Gym(seconds=40.0)
    verdicts = watched(calibrated_as(gym.rig, (1, 0, 2, 3)), gym, (((0, 1, 2), 9.0), ((0, 1, 2, 3), 30.0)))
    first = next(verdict for verdict in verdicts if verdict is not None)
    assert ("cam0", "cam1") in first.exchanged


@pytest.mark.filterwarnings("error")
def test_a_body_without_extent_neither_agrees_nor_contradicts() -> None:
    gym = Gym(seconds=SECONDS)

    def shrunk(picture: Observation) -> Observation:
        points = [np.full_like(person.keypoints_px, 400.0) for person in picture.persons]
        persons = (msgspec.structs.replace(one, keypoints_px=px) for one, px in zip(picture.persons, points, strict=True))
        return msgspec.structs.replace(picture, persons=tuple(persons))

    agreement = Agreement(gym.rig, SightingConfig())
    for event in gym.events():
        if isinstance(event, Observation):
            agreement.observe(shrunk(event))
    assert agreement.judge() is None


def test_a_camera_that_is_put_right_is_no_longer_named() -> None:
    gym = Gym(seconds=SECONDS)
    agreement = Agreement(gym.rig, SightingConfig())
    pictures = [event for event in gym.events() if isinstance(event, Observation)]
    renamed = {"cam0": "cam1", "cam1": "cam0", "cam2": "cam2", "cam3": "cam3"}
    for picture in pictures:
        agreement.observe(msgspec.structs.replace(picture, camera=renamed[picture.camera]))
    assert agreement.judge() is not None
    later_ns = round(SECONDS * 1e9)
    for picture in pictures:
        agreement.observe(msgspec.structs.replace(picture, t_mid_ns=picture.t_mid_ns + later_ns))
    assert agreement.judge() is None
