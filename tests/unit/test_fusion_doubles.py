"""A foot that several cameras see on the other foot does not go there."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import pytest

from models.arrays import Float
from models.messages.observation import Observation
from models.skeleton import coco
from services.fusion.config import FusionConfig
from services.fusion.doubles import single, untwinned
from services.fusion.joint_filter import Expectation
from services.fusion.pipeline import Tick
from services.fusion.views import Sighting, Views
from tests.synthetic.gym import T0_NS, Gym
from tests.synthetic.person import Person
from tests.synthetic.play import DEFAULT, after, errors_mm, play

LEFT, RIGHT = coco.INDEX["left_ankle"], coco.INDEX["right_ankle"]
_DOUBT = 4.0
_UP_S, _DOWN_S = 2.0, 2.5
"""The right foot is lifted from the one to the other."""


def _sighting(points_px: Float) -> Sighting:
    return Sighting(0, 1, 1.0, points_px, np.full(coco.COUNT, 3.0), np.ones(coco.COUNT, np.bool_))


def _expected(points_px: Float) -> Expectation:
    return Expectation(points_px, np.full(coco.COUNT, 16.0), np.full(coco.COUNT, 200.0), np.ones(coco.COUNT, np.bool_))


@pytest.fixture
def apart_px() -> Float:
    """Points of which none is near another."""
    return np.stack((40.0 * np.arange(coco.COUNT), np.full(coco.COUNT, 100.0)), axis=1)


@pytest.mark.parametrize(("lost", "other"), [(RIGHT, LEFT), (LEFT, RIGHT)])
def test_the_point_that_left_its_place_for_the_other_foot_is_doubted_and_nothing_else(
    lost: int, other: int, apart_px: Float
) -> None:
    seen = apart_px.copy()
    seen[lost] = seen[other] + 2.0
    sighting = single(_sighting(seen), _expected(apart_px), _DOUBT)
    grown = np.ones(coco.COUNT)
    grown[lost] = _DOUBT
    np.testing.assert_allclose(sighting.sigma_px, 3.0 * grown)
    assert sighting.usable.all()
    np.testing.assert_array_equal(sighting.points_px, seen)


def test_feet_that_are_expected_one_before_the_other_are_believed(apart_px: Float) -> None:
    apart_px[RIGHT] = apart_px[LEFT] + 3.0
    sighting = _sighting(apart_px)
    assert single(sighting, _expected(apart_px), _DOUBT) is sighting


def test_hips_one_behind_the_other_are_believed_wherever_they_are_expected(apart_px: Float) -> None:
    seen = apart_px.copy()
    seen[coco.INDEX["right_hip"]] = seen[coco.INDEX["left_hip"]]
    sighting = _sighting(seen)
    assert single(sighting, _expected(apart_px), _DOUBT) is sighting


@pytest.mark.parametrize("missing", ["known", "usable"])
def test_of_a_foot_that_is_not_seen_or_not_expected_nothing_is_doubted(missing: str, apart_px: Float) -> None:
    seen = apart_px.copy()
    seen[RIGHT] = seen[LEFT]
    sighting, expected = _sighting(seen), _expected(apart_px)
    (expected.known if missing == "known" else sighting.usable)[LEFT] = False
    assert single(sighting, expected, _DOUBT) is sighting


@dataclass(frozen=True)
class Lifter(Person):
    """Stands, and lifts the right foot beside him for half a second."""

    radius_m: float = 0.0
    throws: bool = False

    def joints(self, t_s: float) -> Float:
        """See `Person.joints`."""
        out = super().joints(0.0)
        share = np.clip((t_s - _UP_S) / (_DOWN_S - _UP_S), 0.0, 1.0)
        up = np.sin(np.pi * share) ** 2
        out[RIGHT] += up * np.array((0.35, 0.0, 0.30))
        return out


GYM: Final = replace(Gym(pupil=Lifter(), seconds=4.0, rates_hz=(15.0,), noise_px=1.0, reported_px=2.0).quiet(), jitter=0.02)
FOOLED: Final = ("cam1", "cam2")


def _events() -> Iterator[Observation | Tick]:
    """Half of the cameras name the standing foot twice for as long as the other one is up."""
    for event in GYM.events():
        if isinstance(event, Observation) and event.camera in FOOLED and _UP_S <= (event.t_mid_ns - T0_NS) * 1e-9 <= _DOWN_S:
            for person in event.persons:
                person.keypoints_px[RIGHT] = person.keypoints_px[LEFT]
        yield event


def _ankle_mm(config: FusionConfig) -> Float:
    motions = after(play(GYM.rig, _events(), config).smooth, _UP_S, _DOWN_S)
    errors: Float = errors_mm(motions, GYM.truth)[:, RIGHT]
    return errors


def test_a_foot_that_half_of_the_cameras_see_on_the_other_one_stays_mostly_where_the_rest_see_it() -> None:
    believed = replace(DEFAULT, sighting=replace(DEFAULT.sighting, doubled=1.0))
    assert np.nanmean(_ankle_mm(DEFAULT)) < 0.4 * np.nanmean(_ankle_mm(believed))


def test_feet_that_two_cameras_see_apart_are_not_triangulated_from_cameras_that_see_them_together() -> None:
    views = Views.of(GYM.rig)
    joints_m = GYM.truth(T0_NS + round((_UP_S + _DOWN_S) / 2 * 1e9))
    points_px = np.stack([camera.project(joints_m) for camera in GYM.rig])
    usable = np.ones((len(views), coco.COUNT), np.bool_)
    fooled = [views.index[name] for name in FOOLED]
    points_px[fooled, RIGHT] = points_px[fooled, LEFT]
    expected = usable.copy()
    expected[np.ix_(fooled, [LEFT, RIGHT])] = False
    np.testing.assert_array_equal(untwinned(views, points_px, usable, np.array((0.0, 0.0, 1.0))), expected)


def test_feet_that_only_one_camera_sees_apart_are_triangulated_from_all() -> None:
    views = Views.of(GYM.rig)
    points_px = np.stack([camera.project(GYM.truth(T0_NS)) for camera in GYM.rig])
    points_px[1:, RIGHT] = points_px[1:, LEFT]
    usable = np.ones((len(views), coco.COUNT), np.bool_)
    assert untwinned(views, points_px, usable, np.array((0.0, 0.0, 1.0))).all()
