"""Points of the body that move with it, without its skin: COCO points, feet, joints, any weighted sum of vertices."""

from dataclasses import dataclass

import numpy as np

from models.arrays import Float
from models.compiled import Counts


@dataclass(frozen=True, eq=False)
class Landmarks:
    """Points as sums over the joints that carry them (`models.body.kinematics` says how).

    Attributes:
        starts: (K + 1,) first term of each point.
        joints: (T,) joint of each term.
        shares: (T,) how much of the point that joint carries.
        offsets: (T, 3) in the mean shape, metres.
        shapedirs: (T, 3, S) change of the offsets by each shape coefficient.
        posedirs: (T, 3, P) change by the pose correctives; P is 0 for a body without.
    """

    starts: Counts
    joints: Counts
    shares: Float
    offsets: Float
    shapedirs: Float
    posedirs: Float

    def __len__(self) -> int:
        return len(self.starts) - 1

    @property
    def term_points(self) -> Counts:
        """(T,) the point to which each term belongs."""
        return np.repeat(np.arange(len(self)), np.diff(self.starts))


@dataclass(frozen=True, eq=False)
class Skin:
    """The skinned mesh in the T-pose, of which landmarks are sums.

    Attributes:
        vertices: (V, 3) in the mean shape, metres.
        shapedirs: (V, 3, S).
        posedirs: (V, 3, P); P is 0 for a body without pose correctives.
        joints: (V, W) the joints that carry each vertex.
        weights: (V, W) how much; rows sum to 1.
    """

    vertices: Float
    shapedirs: Float
    posedirs: Float
    joints: Counts
    weights: Float


def from_vertices(regressor: Float, skin: Skin, rest_joints: Float, rest_joint_shapedirs: Float) -> Landmarks:
    """Landmarks as weighted sums of vertices.

    Args:
        regressor: (K, V) weights; each row sums to 1, or the point would not follow a translation.
        skin: the mesh.
        rest_joints: (J, 3) joints of the mean shape in the T-pose, metres.
        rest_joint_shapedirs: (J, 3, S) their change by each shape coefficient.

    Raises:
        ValueError: the regressor has another shape, or a row does not sum to 1.
    """
    if regressor.ndim != 2 or regressor.shape[1] != len(skin.vertices):
        raise ValueError(f"the regressor has the shape {regressor.shape}, needed (K, {len(skin.vertices)})")
    if np.abs(regressor.sum(1) - 1).max(initial=0.0) > 1e-3:
        raise ValueError("each row of the regressor must sum to 1")
    joints: list[int] = []
    rows: list[tuple[Float, Float, Float]] = []
    shares: list[float] = []
    starts = [0]
    for weights in regressor / regressor.sum(1, keepdims=True):
        used = np.flatnonzero(weights)
        for joint in np.unique(skin.joints[used][skin.weights[used] > 0]):
            of_joint = weights[used] * np.where(skin.joints[used] == joint, skin.weights[used], 0.0).sum(1)
            share = float(of_joint.sum())
            joints.append(int(joint))
            shares.append(share)
            rows.append(
                (
                    of_joint @ skin.vertices[used] - share * rest_joints[joint],
                    np.tensordot(of_joint, skin.shapedirs[used], axes=1) - share * rest_joint_shapedirs[joint],
                    np.tensordot(of_joint, skin.posedirs[used], axes=1),
                )
            )
        starts.append(len(joints))
    offsets, shapedirs, posedirs = (np.ascontiguousarray(np.stack(column)) for column in zip(*rows, strict=True))
    return Landmarks(np.array(starts), np.array(joints), np.array(shares), offsets, shapedirs, posedirs)


def joints_as_landmarks(count: int, coefficients: int, correctives: int) -> Landmarks:
    """The joints themselves, each carried by itself."""
    return Landmarks(
        starts=np.arange(count + 1),
        joints=np.arange(count),
        shares=np.ones(count),
        offsets=np.zeros((count, 3)),
        shapedirs=np.zeros((count, 3, coefficients)),
        posedirs=np.zeros((count, 3, correctives)),
    )
