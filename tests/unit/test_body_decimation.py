"""Fewer vertices: the surface stays closed, symmetric and where it was, and regressors still give the same points."""

import numpy as np

from models.arrays import Float
from models.body.build.decimate import decimate
from models.body.build.regress import joint_regressor, landmark_regressor
from models.body.kinematics import skin
from tests.bodies import LARGE, body_model

MIRRORED = np.array((1.0, -1.0, 1.0))


def ball(divisions: int) -> tuple[Float, np.ndarray, np.ndarray]:
    """Vertices, triangles and mirror of a closed ball, symmetric to the plane y = 0, with vertices in that plane."""
    vertices = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], np.float64)
    faces = np.array([(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)])
    for _ in range(divisions):
        triangles = vertices[faces]
        middles = (triangles + np.roll(triangles, -1, axis=1)) / 2
        (a, b, c), (d, e, f) = triangles.transpose(1, 0, 2), middles.transpose(1, 0, 2)
        corners = np.concatenate([np.stack(three, axis=1) for three in ((a, d, f), (d, b, e), (f, e, c), (d, e, f))])
        points = corners.reshape(-1, 3) / np.linalg.norm(corners.reshape(-1, 3), axis=1, keepdims=True)
        vertices, index = np.unique(np.round(points, 12) + 0.0, axis=0, return_inverse=True)
        faces = index.reshape(-1, 3)
    mirror = np.array([np.argmin(np.linalg.norm(vertices - vertex * MIRRORED, axis=1)) for vertex in vertices])
    return vertices, faces, mirror


def test_a_decimated_ball_is_a_closed_symmetric_ball() -> None:
    vertices, faces, mirror = ball(4)
    bodies = np.stack((vertices, 0.5 * vertices * (1.0, 1.0, 2.0)))
    kept, left = decimate(bodies, faces, mirror, np.ones(len(vertices)), 200)
    assert len(kept) <= 200 < len(kept) + 3
    assert np.array_equal(np.sort(mirror[kept]), kept)
    edges = [(int(a), int(b)) for face in left for a, b in zip(face, np.roll(face, -1), strict=True)]
    assert len(set(edges)) == len(edges)
    assert {(b, a) for a, b in edges} == set(edges)
    assert len(kept) - len(edges) // 2 + len(left) == 2
    a, b, c = (vertices[kept][left[:, corner]] for corner in range(3))
    volume = np.sum(a * np.cross(b, c)) / 6
    assert 0.93 * 4 / 3 * np.pi < volume < 4 / 3 * np.pi


def test_vertices_of_no_importance_go_first() -> None:
    vertices, faces, mirror = ball(3)
    importance = np.where(vertices[:, 2] > 0, 1.0, 1e-4)
    kept, _ = decimate(vertices[None], faces, mirror, importance, 150)
    assert np.mean(vertices[kept, 2] > 0) > 0.7


def test_regressors_of_fewer_vertices_give_the_same_points_in_every_shape_and_with_every_bone() -> None:
    model = body_model(LARGE)
    full, count = model.skin, len(model.skin.vertices)
    weights = np.zeros((count, 24))
    np.put_along_axis(weights, full.joints, full.weights, axis=1)
    generator = np.random.default_rng(4)
    kept = np.sort(generator.choice(count, 2500, replace=False))
    near = np.argsort(np.linalg.norm(full.vertices - full.vertices[1000], axis=1))[:80]
    wanted = np.zeros((1, count))
    wanted[0, near] = 1 / len(near)
    regressor = landmark_regressor(wanted, kept, full.vertices, full.shapedirs, weights)
    joints = joint_regressor(model.joints, model.joint_shapedirs, kept, full.vertices, full.shapedirs)
    for seed in range(5):
        shape = np.random.default_rng(seed).normal(size=model.shape_count)
        rest = full.vertices + full.shapedirs @ shape
        rest_joints = model.joints + model.joint_shapedirs @ shape
        turns = np.linalg.qr(np.random.default_rng(seed).normal(size=(24, 3, 3)))[0]
        posed = skin(rest_joints, rest_joints, turns, rest, full.joints, full.weights)
        assert np.allclose(regressor @ posed[kept], wanted @ posed, atol=1.5e-3)
        assert np.allclose(joints @ rest[kept], rest_joints, atol=1.5e-3)
