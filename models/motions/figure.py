"""A subject as a figure of rigid segments: all poses of a motion at once. Joints, centre of mass and soles, without the skin."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from models.arrays import Float
from models.body.masses import centre_of_mass_m
from models.motions import rotations
from models.motions.soles import Sole, sole_of
from models.motions.subject import Subject
from models.skeleton import coco_feet, smpl


@dataclass(frozen=True, eq=False)
class Placed:
    """Segments of T poses.

    Attributes:
        joints_m: (T, 24, 3) in the world.
        turns: (T, 24, 3, 3) from the T-pose into the world.
    """

    joints_m: Float
    turns: Float


@dataclass(frozen=True, eq=False)
class Figure:
    """A subject's segments."""

    subject: Subject

    @cached_property
    def bones_m(self) -> Float:
        """(24, 3) from each joint's parent to it, in the T-pose."""
        rest = self.subject.body.rest_joints_m
        return np.asarray(rest - np.where(np.array(smpl.PARENTS)[:, None] < 0, 0.0, rest[list(smpl.PARENTS)]))

    @cached_property
    def leg_m(self) -> float:
        """Hip to ankle, straight."""
        return float(sum(np.linalg.norm(self.bones_m[smpl.INDEX[name]]) for name in ("left_knee", "left_ankle")))

    @cached_property
    def soles(self) -> dict[str, Sole]:
        """Of the left and the right foot."""
        return {side: sole_of(self.subject.body, side) for side in ("left", "right")}

    @cached_property
    def balance(self) -> tuple[Float, Float]:
        """(24,) share of the body's mass on each joint and (24, 3) its lever in metres: the centre of mass is the sum of
        share times joint plus turned lever (see `centre_of_mass_m`, which is linear in the points that it takes)."""
        age, sex = self.subject.age_years, self.subject.sex
        none = np.zeros((smpl.COUNT + coco_feet.COUNT, 3))
        weights = np.empty(len(none))
        for point in range(len(none)):
            alone = none.copy()
            alone[point] = 1.0
            weights[point] = centre_of_mass_m(alone[: smpl.COUNT], alone[smpl.COUNT :], age, sex)[0]
        shares, levers = weights[: smpl.COUNT].copy(), np.zeros((smpl.COUNT, 3))
        landmarks = self.subject.body.coco_landmarks
        of_terms = weights[smpl.COUNT :][landmarks.term_points]
        np.add.at(shares, landmarks.joints, of_terms * landmarks.shares)
        offsets = landmarks.offsets + landmarks.shapedirs @ self.subject.body.shape
        np.add.at(levers, landmarks.joints, of_terms[:, None] * offsets)
        return shares, levers

    def place(self, translations_m: Float, rotations_rad: Float) -> Placed:
        """Segments of poses: (T, 3) of the pelvis and (T, 24, 3) rotation vectors."""
        return self.place_local(translations_m, rotations.matrices(rotations_rad))

    def place_local(self, translations_m: Float, local: Float) -> Placed:
        """The same from (T, 24, 3, 3) rotations against the parents."""
        turns, joints = np.empty_like(local), np.empty(local.shape[:-1])
        turns[:, 0], joints[:, 0] = local[:, 0], translations_m
        for joint, parent in enumerate(smpl.PARENTS[1:], start=1):
            turns[:, joint] = turns[:, parent] @ local[:, joint]
            joints[:, joint] = joints[:, parent] + rotations.through(turns[:, parent], self.bones_m[joint])
        return Placed(joints, turns)

    def centres_of_mass_m(self, placed: Placed) -> Float:
        """(T, 3) as `models.body.masses.centre_of_mass_m` has them."""
        shares, levers = self.balance
        return np.asarray(shares @ placed.joints_m + np.einsum("tjab,jb->ta", placed.turns, levers))


@lru_cache(maxsize=32)
def figure_of(subject: Subject) -> Figure:
    """The figure of a subject, made once: what is measured on his skin takes longer than a motion."""
    return Figure(subject)
