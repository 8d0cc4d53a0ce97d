"""Regressors from the vertices of a decimated mesh: landmarks and joints as sparse linear sums.

A landmark of the full mesh is a weighted mean of many vertices. On the decimated mesh the weights go to the nearest vertices that
are left and are then corrected, by as little as possible, until the landmark agrees with the full one in every shape and moves
with the same bones. A correction may be negative: these are regressors and not averages.
"""

import numpy as np
from scipy.spatial import KDTree

from models.arrays import Float

_LANDMARK_SUPPORT = 96
_JOINT_SUPPORT = 200
_AROUND_JOINT = 0.12
"""Share of all vertices, the nearest ones, among which a joint's are chosen."""
_SHARED_AMONG = 3
_RIDGE_M2 = 1e-8
"""Smaller agrees better, larger keeps the weights small."""


def landmark_regressor(full: Float, kept: np.ndarray, template: Float, shapedirs: Float, weights: Float) -> Float:
    """(K, v) weights on the vertices kept, each row summing to 1.

    Args:
        full: (K, V) weights on the full mesh.
        kept: (v,) the vertices kept.
        template: (V, 3) mean body of the full mesh.
        shapedirs: (V, 3, S) its shape directions.
        weights: (V, J) its skinning weights.
    """
    distances, nearest = KDTree(template[kept]).query(template, k=_SHARED_AMONG)
    shares = 1.0 / (distances + 1e-4)
    shares /= shares.sum(1, keepdims=True)
    properties = _properties(template, shapedirs, weights)
    out = np.zeros((len(full), len(kept)))
    for row, sums in zip(out, full, strict=True):
        for column in range(_SHARED_AMONG):
            np.add.at(row, nearest[:, column], sums * shares[:, column])
        support = np.argsort(-row, kind="stable")[:_LANDMARK_SUPPORT]
        chosen = row[support] / row[support].sum()
        there = properties[kept[support]].T
        row[:] = 0.0
        row[support] = chosen + _least_change(there, properties.T @ sums - there @ chosen)
    return out


def joint_regressor(joints: Float, joint_shapedirs: Float, kept: np.ndarray, template: Float, shapedirs: Float) -> Float:
    """(J, v) weights on the vertices kept around each joint, as SMPL's J_regressor. Shapes as in `landmark_regressor`."""
    properties = _properties(template, shapedirs, np.zeros((len(template), 0)))[kept]
    wanted = _properties(joints, joint_shapedirs, np.zeros((len(joints), 0)))
    out = np.zeros((len(joints), len(kept)))
    for row, joint, target in zip(out, joints, wanted, strict=True):
        nearest = np.argsort(np.linalg.norm(template[kept] - joint, axis=1), kind="stable")[: int(_AROUND_JOINT * len(kept))]
        support = nearest[:: -(-len(nearest) // _JOINT_SUPPORT)]
        row[support] = _least_change(properties[support].T, target)
    return out


def _properties(template: Float, shapedirs: Float, weights: Float) -> Float:
    """(V, P) what a weighted sum of vertices must keep: its weight, its place in every shape, and its share in every bone."""
    moments = (weights[:, :, None] * template[:, None, :]).reshape(len(template), -1)
    return np.concatenate((np.ones((len(template), 1)), template, shapedirs.reshape(len(template), -1), weights, moments), axis=1)


def _least_change(constraints: Float, missing: Float) -> Float:
    """The smallest weights (in the sense of least squares) that add what is missing."""
    return np.asarray(constraints.T @ np.linalg.solve(constraints @ constraints.T + _RIDGE_M2 * np.eye(len(constraints)), missing))
