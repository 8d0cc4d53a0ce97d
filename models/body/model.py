"""The body model and a body of one shape: joints, landmarks, skin, stature and mass in any pose, and their derivatives."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from models.arrays import Float
from models.body import kinematics
from models.body.landmarks import Landmarks, Skin, from_vertices, joints_as_landmarks
from models.body.pose import Pose
from models.body.prior import ShapePrior
from models.compiled import Counts
from models.skeleton import smpl

DENSITY_KG_PER_M3 = 980.0
"""Of a body with air in its lungs; Anny's figure, by which the shapes were fitted to the weights of the WHO."""

_PARENTS: Counts = np.array(smpl.PARENTS)


@dataclass(frozen=True, eq=False)
class BodyModel:
    """A family of bodies. See this package for the frame, `models.body.file` for reading one.

    Attributes:
        source: where it comes from and under which licence.
        skin: the mesh of the mean shape and how it changes.
        faces: (F, 3) triangles, counter-clockwise seen from outside.
        joints: (24, 3) of the mean shape in the T-pose, metres; the pelvis is the origin.
        joint_shapedirs: (24, 3, S) their change by each shape coefficient.
        landmarks: the 23 points of `models.skeleton.coco_feet`, or None for a file without.
        part_names: names of the parts of the body that clothes are painted on.
        vertex_parts: (V,) index of each vertex' part.
        prior: which shapes are likely at which age and sex, or None for a file that does not know.
    """

    source: str
    skin: Skin
    faces: Counts
    joints: Float
    joint_shapedirs: Float
    landmarks: Landmarks | None
    part_names: tuple[str, ...]
    vertex_parts: Counts
    prior: ShapePrior | None

    @property
    def shape_count(self) -> int:
        """Number of shape coefficients."""
        return int(self.joint_shapedirs.shape[2])

    @cached_property
    def joint_landmarks(self) -> Landmarks:
        """The 24 joints as landmarks, for their Jacobian."""
        return joints_as_landmarks(smpl.COUNT, self.shape_count, self.skin.posedirs.shape[2])

    def landmarks_of(self, regressor: Float) -> Landmarks:
        """Landmarks of one's own as weighted sums of vertices; `regressor` is (K, V), each row summing to 1."""
        return from_vertices(regressor, self.skin, self.joints, self.joint_shapedirs)

    def shaped(self, shape: Float) -> "Body":
        """The body with these (S,) shape coefficients, each in standard deviations of the people the model was made from."""
        if shape.shape != (self.shape_count,) or not np.isfinite(shape).all():
            raise ValueError(f"a shape of this model has {self.shape_count} finite coefficients, not {shape.shape}")
        return Body(self, np.asarray(shape, np.float64))


@dataclass(frozen=True, eq=False)
class Body:
    """A person: everything that does not change with the pose is computed once.

    Attributes:
        model: the family.
        shape: (S,) shape coefficients.
    """

    model: BodyModel
    shape: Float
    rest_joints_m: Float = field(init=False)
    """(24, 3) in the T-pose."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "rest_joints_m", self.model.joints + self.model.joint_shapedirs @ self.shape)

    @cached_property
    def rest_vertices_m(self) -> Float:
        """(V, 3) in the T-pose."""
        return self.model.skin.vertices + self.model.skin.shapedirs @ self.shape

    @cached_property
    def stature_m(self) -> float:
        """Standing height without shoes."""
        return float(np.ptp(self.rest_vertices_m[:, 2]))

    @cached_property
    def volume_m3(self) -> float:
        """Of the closed mesh in the T-pose, by the divergence theorem."""
        a, b, c = (self.rest_vertices_m[self.model.faces[:, corner]] for corner in range(3))
        return float(np.sum(a * np.cross(b, c)) / 6)

    @property
    def mass_kg(self) -> float:
        """Volume times `DENSITY_KG_PER_M3`."""
        return self.volume_m3 * DENSITY_KG_PER_M3

    def joints_m(self, pose: Pose) -> Float:
        """(24, 3) joints in the world."""
        return kinematics.place_joints(_PARENTS, self.rest_joints_m, pose.translation_m, pose.rotations_rad)[0]

    def orientations(self, pose: Pose) -> Float:
        """(24, 3, 3) rotations of the segments from the T-pose into the world."""
        return kinematics.place_joints(_PARENTS, self.rest_joints_m, pose.translation_m, pose.rotations_rad)[1]

    def coco_m(self, pose: Pose) -> Float:
        """(23, 3) COCO points and points of the feet in the world, in the order of `models.skeleton.coco_feet`.

        Raises:
            ValueError: the model's file has no coco_regressor.
        """
        return self.landmarks_m(pose, self.coco_landmarks)

    @property
    def coco_landmarks(self) -> Landmarks:
        """The landmarks that `coco_m` gives, for their Jacobian. Raises as it does."""
        if self.model.landmarks is None:
            raise ValueError(f"the body from '{self.model.source}' has no coco_regressor, which COCO points need")
        return self.model.landmarks

    def landmarks_m(self, pose: Pose, landmarks: Landmarks) -> Float:
        """(K, 3) landmarks in the world."""
        places, world, local = kinematics.place_joints(_PARENTS, self.rest_joints_m, pose.translation_m, pose.rotations_rad)
        offsets = self._offsets(landmarks, local)
        return kinematics.place_landmarks(places, world, landmarks.starts, landmarks.joints, landmarks.shares, offsets)

    def landmarks_jacobian(self, pose: Pose, landmarks: Landmarks) -> tuple[Float, Float]:
        """Landmarks and their derivative.

        Returns:
            (K, 3) points in metres and (K, 3, 75 + S): by translation (m per m), by the 24 rotation vectors (m per rad; the
            order of `Pose.vector`), and by the shape coefficients (m).
        """
        rotations = pose.rotations_rad
        places, world, local = kinematics.place_joints(_PARENTS, self.rest_joints_m, pose.translation_m, rotations)
        terms = (landmarks.starts, landmarks.joints, landmarks.shares, self._offsets(landmarks, local))
        points = kinematics.place_landmarks(places, world, *terms)
        joint_shapedirs = self.model.joint_shapedirs
        jacobian = kinematics.landmark_jacobian(
            _PARENTS, joint_shapedirs, rotations, places, world, local, *terms, landmarks.shapedirs, landmarks.posedirs
        )
        return points, jacobian

    def vertices_m(self, pose: Pose) -> Float:
        """(V, 3) skin in the world."""
        places, world, local = kinematics.place_joints(_PARENTS, self.rest_joints_m, pose.translation_m, pose.rotations_rad)
        skin, rest = self.model.skin, self.rest_vertices_m
        if skin.posedirs.shape[2]:
            rest = rest + skin.posedirs @ _pose_features(local)
        return kinematics.skin(self.rest_joints_m, places, world, rest, skin.joints, skin.weights)

    def _offsets(self, landmarks: Landmarks, local: Float) -> Float:
        offsets = self._shaped_offsets(landmarks)
        return offsets + landmarks.posedirs @ _pose_features(local) if landmarks.posedirs.shape[2] else offsets

    def _shaped_offsets(self, landmarks: Landmarks) -> Float:
        return self._own_offsets if landmarks is self.model.landmarks else landmarks.offsets + landmarks.shapedirs @ self.shape

    @cached_property
    def _own_offsets(self) -> Float:
        landmarks = self.coco_landmarks
        return landmarks.offsets + landmarks.shapedirs @ self.shape


def _pose_features(local: Float) -> Float:
    """(9 (J - 1),) entries of the local rotations less the identity, row by row, without the pelvis (SMPL, eq. 9)."""
    return np.asarray((local[1:] - np.eye(3)).ravel())
