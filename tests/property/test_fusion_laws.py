"""What must hold of fusion whatever the numbers are."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.arrays import Float
from models.camera.rig import Rig
from models.messages.observation import Observation
from models.messages.precision import RELATIVE_ERROR
from models.skeleton import coco
from services.fusion.triangulation import triangulate
from services.fusion.views import Views
from tests.synthetic.gym import Gym, ring_rig
from tests.synthetic.person import Person
from tests.synthetic.play import DEFAULT, Played, after, play

GYM = Gym(seconds=1.5)
ANGLES = st.floats(-3.1, 3.1)
PLACES = st.tuples(*[st.floats(-20.0, 20.0)] * 3)


@cache
def _reference() -> Played:
    return play(GYM.rig, GYM.events())


def _rotation(a: float, b: float, c: float) -> Float:
    def about(axis: int, angle: float) -> Float:
        i, j = [(1, 2), (2, 0), (0, 1)][axis]
        matrix = np.eye(3)
        matrix[i, i] = matrix[j, j] = np.cos(angle)
        matrix[i, j], matrix[j, i] = -np.sin(angle), np.sin(angle)
        return matrix

    rotation: Float = about(2, a) @ about(1, b) @ about(0, c)
    return rotation


def _moved(rig: Rig, rotation: Float, translation: Float) -> Rig:
    """The rig in a world whose points are rotation @ X + translation."""
    cameras = []
    for camera in rig:
        turned = camera.rotation @ rotation.T
        cameras.append(replace(camera, rotation=turned, translation_m=camera.translation_m - turned @ translation))
    return Rig(tuple(cameras))


def test_the_same_events_give_the_same_bits() -> None:
    again = play(GYM.rig, GYM.events())
    for ours, theirs in zip(_reference().live + _reference().smooth, again.live + again.smooth, strict=True):
        assert ours.joints_m.tobytes() == theirs.joints_m.tobytes()
        assert ours.covariance_m2.tobytes() == theirs.covariance_m2.tobytes()
        assert ours.states.tobytes() == theirs.states.tobytes()
        assert repr(ours.cameras) == repr(theirs.cameras)


@pytest.mark.slow
@settings(max_examples=5, deadline=None)
@given(angles=st.tuples(ANGLES, ANGLES, ANGLES), place=PLACES)
def test_moving_the_world_moves_the_figure_and_changes_nothing_else(
    angles: tuple[float, float, float], place: tuple[float, float, float]
) -> None:
    rotation, translation = _rotation(*angles), np.array(place)
    played = play(_moved(GYM.rig, rotation, translation), GYM.events())
    for ours, theirs in zip(after(played.smooth, 0.4), after(_reference().smooth, 0.4), strict=True):
        np.testing.assert_array_equal(ours.states, theirs.states)
        np.testing.assert_allclose(ours.joints_m, theirs.joints_m @ rotation.T + translation, atol=2e-4)
        expected = rotation @ theirs.covariance_m2 @ rotation.T
        # What is rounded for the wire is rounded along the axes of the world.
        rounded = 8 * RELATIVE_ERROR * np.trace(expected, axis1=1, axis2=2)[:, None, None]
        assert (np.abs(ours.covariance_m2 - expected) <= 1e-5 + rounded).all()


@pytest.mark.slow
@settings(max_examples=5, deadline=None)
@given(order=st.permutations(range(4)))
def test_the_order_of_the_cameras_does_not_matter(order: list[int]) -> None:
    rig = GYM.rig.select(GYM.rig.names[i] for i in order)
    played = play(rig, GYM.events())
    for ours, theirs in zip(after(played.smooth, 0.4), after(_reference().smooth, 0.4), strict=True):
        np.testing.assert_allclose(ours.joints_m, theirs.joints_m, atol=2e-4)
        assert {use.camera: use.used for use in ours.cameras} == {use.camera: use.used for use in theirs.cameras}


@settings(max_examples=40, deadline=None)
@given(cameras=st.integers(2, 8), phase=st.floats(0.0, 1.0), outliers=st.integers(0, 1), seed=st.integers(0, 999))
def test_exact_points_triangulate_exactly_whatever_one_view_claims(cameras: int, phase: float, outliers: int, seed: int) -> None:
    rig = ring_rig(cameras if cameras > 2 else 3)
    views, truth, random = Views.of(rig), Person(phase=phase).joints(0.0), np.random.default_rng(seed)
    points = np.stack([camera.project(truth) for camera in rig])
    if len(rig) >= 4 and outliers:
        liar = int(random.integers(len(rig)))
        said = random.uniform((0, 0), (1280, 720), (coco.COUNT, 2))
        # What lies within some sigma of the truth is no lie, but noise that rightly counts.
        near = np.linalg.norm(said - points[liar], axis=1) < 20.0
        points[liar] = np.where(near[:, None], said + 40.0, said)
    sigma, usable = np.full(points.shape[:2], 2.0), np.ones(points.shape[:2], np.bool_)
    found = triangulate(views, points, sigma, usable, DEFAULT.triangulation)
    assert np.abs(found.points_m - truth).max() < 2e-3
    assert (found.count >= len(rig) - outliers).all()


@given(split=st.integers(1, 200))
@settings(max_examples=5, deadline=None)
def test_a_message_that_comes_twice_is_fused_once(split: int) -> None:
    events = GYM.events()
    again = [*events[:split], *(e for e in events[:split] if isinstance(e, Observation)), *events[split:]]
    played = play(GYM.rig, again)
    assert len(played.live) == len(_reference().live)
    assert np.isfinite([motion.joints_m for motion in played.live]).all()
