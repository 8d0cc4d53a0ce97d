"""A pupil on camera: a subject who performs a motion in his clothes."""

from functools import cached_property

import numpy as np

from edge.simulation.people.look import Dressed, Look, dress
from edge.simulation.surface import Surface
from models.arrays import Float
from models.body import kinematics
from models.body.model import Body
from models.body.pose import Pose
from models.compiled import Counts
from models.motions.motion import Motion
from models.motions.subject import Subject
from models.skeleton import smpl

_PARENTS: Counts = np.array(smpl.PARENTS)


class Avatar:
    """The `Pupil` of a scene: what is seen is his clothed surface, what is true is his body's.

    Args:
        name: code, unique in the scene.
        subject: whose body; on the model, or altered (see `edge.simulation.people.off_model`).
        look: skin, hair, clothes.
        motion: what he does, from the scene's beginning; before and after it he keeps its first and last pose.
        detail: as `edge.simulation.people.look.dress`.
    """

    def __init__(self, name: str, subject: Subject, look: Look, motion: Motion, detail: int = 1) -> None:
        self.name = name
        self.subject = subject
        self.look = look
        self.motion = motion
        self._detail = detail

    @property
    def body(self) -> Body:
        """See `Pupil`."""
        return self.subject.body

    @cached_property
    def dressed(self) -> Dressed:
        """Body and clothes in the T-pose; made when it is first needed."""
        return dress(self.body, self.look, self._detail)

    @property
    def surface(self) -> Surface:
        """See `Actor`."""
        return self.dressed.surface

    def pose(self, t_s: float) -> Pose:
        """See `Pupil`."""
        return self.motion.pose_at(min(max(t_s, 0.0), self.motion.duration_s))

    def vertices_m(self, t_s: float) -> Float:
        """(V, 3) skin, hair and clothes in the world."""
        pose, dressed = self.pose(t_s), self.dressed
        places, world, _ = kinematics.place_joints(_PARENTS, self.body.rest_joints_m, pose.translation_m, pose.rotations_rad)
        rest = dressed.surface.vertices_m
        return kinematics.skin(self.body.rest_joints_m, places, world, rest, dressed.joints, dressed.weights)

    def joints_m(self, t_s: float) -> Float:
        """See `Pupil`."""
        return self.body.joints_m(self.pose(t_s))

    def coco_m(self, t_s: float) -> Float:
        """See `Pupil`."""
        return self.body.coco_m(self.pose(t_s))
