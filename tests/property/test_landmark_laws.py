"""Laws of the segments' axes, and of the landmark bias that is told in them."""

from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.arrays import Float
from models.body.pose import t_pose
from models.skeleton import coco
from models.skeleton.segment_axes import segment_axes, trunk_length_m
from tests.bodies import body_model
from tests.synthetic.person import Person

few = partial(settings, max_examples=25)
TIMES = st.floats(0.0, 20.0)
MIRROR = np.array((1.0, -1.0, 1.0))


def points_at(t_s: float) -> Float:
    return Person().joints(t_s)


@few()
@given(TIMES)
def test_axes_are_rotations(t_s: float) -> None:
    axes = segment_axes(points_at(t_s))
    np.testing.assert_allclose(axes.swapaxes(-1, -2) @ axes, np.broadcast_to(np.eye(3), axes.shape), atol=1e-9)
    np.testing.assert_allclose(np.linalg.det(axes), 1.0)


@few()
@given(TIMES, st.integers(0, 2**32 - 1))
def test_axes_turn_with_the_body(t_s: float, seed: int) -> None:
    turn, points = Rotation.random(rng=np.random.default_rng(seed)).as_matrix(), points_at(t_s)
    np.testing.assert_allclose(segment_axes(3.0 + points @ turn.T), turn @ segment_axes(points), atol=1e-9)
    assert trunk_length_m(2 * points @ turn.T) == pytest.approx(2 * trunk_length_m(points))


@few()
@given(TIMES)
def test_left_and_right_mirror_one_another(t_s: float) -> None:
    points = points_at(t_s)
    mirrored = segment_axes((MIRROR * points)[list(coco.MIRROR)])
    expected = (MIRROR[:, None] * segment_axes(points) * MIRROR)[list(coco.MIRROR)]
    np.testing.assert_allclose(mirrored, expected, atol=1e-9)


@few()
@given(TIMES)
def test_the_axis_along_a_limb_is_the_limb(t_s: float) -> None:
    points = points_at(t_s)
    axes = segment_axes(points)
    for limb, (near, far) in coco.LIMBS.items():
        along = (points[far] - points[near]) / np.linalg.norm(points[far] - points[near])
        axis = -axes[far][:, 2] if "thigh" in limb or "shank" in limb else axes[far][:, 1] * (1 if "left" in limb else -1)
        np.testing.assert_allclose(axis, along, atol=1e-9)


def test_in_the_t_pose_all_axes_are_nearly_the_worlds() -> None:
    body = body_model().shaped(np.zeros(body_model().shape_count))
    axes = segment_axes(body.coco_m(t_pose())[: coco.COUNT])
    assert (
        np.degrees(Rotation.from_matrix(axes).magnitude()).max() < 25
    )  # ears are not exactly beside the nose, arms not quite level


def test_a_missing_point_leaves_the_axes_of_other_segments_alone() -> None:
    points = points_at(1.0)
    points[coco.INDEX["left_wrist"]] = np.nan
    unknown = np.isnan(segment_axes(points)).any(axis=(1, 2))
    assert np.flatnonzero(unknown).tolist() == [coco.INDEX["left_wrist"]]
