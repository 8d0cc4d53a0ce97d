"""Laws of the body that hold for every person in every pose."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from models.arrays import Float
from models.body.landmarks import Landmarks
from models.body.model import Body, BodyModel
from models.body.pose import PARAMETERS, Pose, from_vector, mirrored, t_pose
from models.skeleton import coco_feet, smpl
from tests.bodies import body_model, someone
from tests.synthetic.toy_smpl import toy_body

pytestmark = pytest.mark.slow

SEEDS = st.integers(0, 10_000)
TURNS = arrays(np.float64, (smpl.COUNT, 3), elements=st.floats(-2.5, 2.5, allow_subnormal=False))
PLACES = arrays(np.float64, (3,), elements=st.floats(-5, 5, allow_subnormal=False))
POSES = st.builds(Pose, PLACES, TURNS)
STEP = 1e-6
MIRRORED = np.array((1.0, -1.0, 1.0))


@given(SEEDS, POSES)
@settings(max_examples=40, deadline=None)
def test_bones_keep_their_length_in_every_pose(seed: int, pose: Pose) -> None:
    body = body_model().shaped(someone(body_model(), seed))
    assert np.allclose(_bones(body.joints_m(pose)), _bones(body.rest_joints_m), atol=1e-12)


def _bones(joints: Float) -> Float:
    return np.asarray(np.linalg.norm(joints[1:] - joints[list(smpl.PARENTS[1:])], axis=1))


@given(SEEDS, POSES, arrays(np.float64, (3,), elements=st.floats(-3, 3)), PLACES)
@settings(max_examples=30, deadline=None)
def test_a_turned_and_moved_pelvis_turns_and_moves_everything_with_it(seed: int, pose: Pose, turn: Float, shift: Float) -> None:
    body = body_model().shaped(someone(body_model(), seed))
    alone = Pose(np.zeros(3), np.vstack((np.zeros(3), pose.rotations_rad[1:])))
    moved = Pose(shift, np.vstack((turn, pose.rotations_rad[1:])))
    rotation = body.orientations(moved)[0]
    for points in (Body.joints_m, Body.coco_m, Body.vertices_m):
        assert np.allclose(points(body, moved), points(body, alone) @ rotation.T + shift, atol=1e-11)


@given(SEEDS, POSES)
@settings(max_examples=20, deadline=None)
def test_the_mirrored_pose_gives_the_mirrored_body(seed: int, pose: Pose) -> None:
    body = body_model().shaped(someone(body_model(), seed))
    other = mirrored(pose)
    assert np.allclose(body.joints_m(other)[list(smpl.MIRROR)], body.joints_m(pose) * MIRRORED, atol=1e-6)
    assert np.allclose(body.coco_m(other)[list(coco_feet.MIRROR)], body.coco_m(pose) * MIRRORED, atol=1e-4)
    ours, theirs = body.vertices_m(pose) * MIRRORED, body.vertices_m(other)
    rest = body.model.skin.vertices
    twins = np.array([np.argmin(np.linalg.norm(rest - vertex * MIRRORED, axis=1)) for vertex in rest[::50]])
    assert np.allclose(theirs[twins], ours[::50], atol=1e-4)


@given(POSES)
@settings(max_examples=20, deadline=None)
def test_landmarks_are_the_same_sums_of_the_skin_that_the_file_names(pose: Pose) -> None:
    model = body_model()
    generator = np.random.default_rng(5)
    regressor = generator.random((4, len(model.skin.vertices))) * (generator.random((4, len(model.skin.vertices))) < 0.01)
    regressor /= regressor.sum(1, keepdims=True)
    body = model.shaped(someone(model, 3))
    assert np.allclose(body.landmarks_m(pose, model.landmarks_of(regressor)), regressor @ body.vertices_m(pose), atol=1e-9)


@pytest.mark.parametrize("toy", [False, True], ids=["shipped", "with pose correctives"])
@given(SEEDS, POSES)
@settings(max_examples=25, deadline=None)
def test_the_analytic_jacobian_is_the_derivative(toy: bool, seed: int, pose: Pose) -> None:
    model, landmarks = _model_and_landmarks(toy)
    shape = np.random.default_rng(seed).normal(size=model.shape_count)
    for points in (landmarks, model.joint_landmarks):
        at, jacobian = model.shaped(shape).landmarks_jacobian(pose, points)
        assert np.allclose(at, model.shaped(shape).landmarks_m(pose, points), atol=1e-12)
        assert np.allclose(jacobian, _central_differences(model, points, pose, shape), atol=2e-7)


@pytest.mark.parametrize("size", [0.0, 1e-12, 1e-5, 1e-4, 1.1e-4, 3.14, 6.2])
def test_the_jacobian_holds_where_its_series_begins_and_at_large_turns(size: float) -> None:
    model, landmarks = _model_and_landmarks(toy=True)
    turns = np.random.default_rng(1).normal(size=(smpl.COUNT, 3))
    pose = Pose(np.zeros(3), size * turns / np.linalg.norm(turns, axis=1, keepdims=True))
    shape = np.zeros(model.shape_count)
    _, jacobian = model.shaped(shape).landmarks_jacobian(pose, landmarks)
    assert np.allclose(jacobian, _central_differences(model, landmarks, pose, shape), atol=2e-7)


def _model_and_landmarks(toy: bool) -> tuple[BodyModel, Landmarks]:
    if not toy:
        model = body_model()
        return model, model.shaped(np.zeros(model.shape_count)).coco_landmarks
    model = toy_body()
    regressor = np.random.default_rng(2).random((3, len(model.skin.vertices)))
    return model, model.landmarks_of(regressor / regressor.sum(1, keepdims=True))


def _central_differences(model: BodyModel, landmarks: Landmarks, pose: Pose, shape: Float) -> Float:
    def at(vector: Float) -> Float:
        return model.shaped(vector[PARAMETERS:]).landmarks_m(from_vector(vector[:PARAMETERS]), landmarks)

    vector = np.concatenate((pose.vector, shape))
    steps = STEP * np.eye(len(vector))
    return np.stack([(at(vector + step) - at(vector - step)) / (2 * STEP) for step in steps], axis=-1)


def test_the_joints_jacobian_places_joints_where_forward_kinematics_does() -> None:
    model = body_model()
    body = model.shaped(someone(model, 1))
    pose = Pose(np.array((1.0, 2.0, 3.0)), np.random.default_rng(1).normal(0, 0.5, (smpl.COUNT, 3)))
    assert np.allclose(body.landmarks_jacobian(pose, model.joint_landmarks)[0], body.joints_m(pose), atol=1e-12)


def test_at_pose_zero_the_skin_is_the_t_pose() -> None:
    body = body_model().shaped(someone(body_model(), 2))
    assert np.allclose(body.vertices_m(t_pose()), body.rest_vertices_m, atol=1e-12)
