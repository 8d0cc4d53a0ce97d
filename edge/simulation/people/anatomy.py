"""A body in the T-pose with the places that clothes, hair and paint go by."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from edge.simulation.people.shell import Shell
from models.arrays import Bool, Float
from models.body.model import Body
from models.body.pose import t_pose
from models.skeleton import coco_feet, smpl

_USUAL_STATURE_M = 1.45
_USUAL_EARS_M = 0.144
_HEAD = ("eyes", "cavities", "hair", "face", "neck")
_MIDDLE_M = 0.003


@dataclass(frozen=True, eq=False)
class Anatomy:
    """A body, measured. Frame: the body's own in the T-pose, metres.

    Attributes:
        body: whose.
    """

    body: Body

    @cached_property
    def skin(self) -> Shell:
        """All of the body's mesh, white; vertices as the body's."""
        model = self.body.model
        vertices = self.body.rest_vertices_m
        weights = np.zeros((len(vertices), smpl.COUNT))
        np.put_along_axis(weights, model.skin.joints, model.skin.weights, axis=1)
        return Shell(vertices, model.faces.astype(np.int32), weights, np.ones_like(vertices), np.zeros((len(vertices), 2)))

    def joint(self, name: str) -> Float:
        """(3,) a joint of `models.skeleton.smpl`."""
        return np.asarray(self.body.rest_joints_m[smpl.INDEX[name]])

    def point(self, name: str) -> Float:
        """(3,) a point of `models.skeleton.coco_feet`."""
        return np.asarray(self._points[coco_feet.INDEX[name]])

    def part(self, *names: str) -> Bool:
        """(V,) vertices of the named parts of the body."""
        known = self.body.model.part_names
        return np.isin(self.body.model.vertex_parts, [known.index(name) for name in names])

    @cached_property
    def head(self) -> Bool:
        """(V,) head and neck, with what is inside them."""
        return self.part(*_HEAD)

    @cached_property
    def scale(self) -> float:
        """Stature over that of a pupil of 1.45 m."""
        return self.body.stature_m / _USUAL_STATURE_M

    @cached_property
    def head_scale(self) -> float:
        """Distance of the ears over that of a child."""
        return float(np.linalg.norm(self.point("left_ear") - self.point("right_ear"))) / _USUAL_EARS_M

    @cached_property
    def crown_z(self) -> float:
        """Top of the head."""
        return float(self.body.rest_vertices_m[:, 2].max())

    @cached_property
    def sole_z(self) -> float:
        """Below the feet."""
        return float(self.body.rest_vertices_m[:, 2].min())

    @cached_property
    def chin_z(self) -> float:
        """Underside of the chin."""
        vertices = self.body.rest_vertices_m
        front = self.part("face") & (vertices[:, 0] > self.point("left_eye")[0] - 0.035 * self.head_scale)
        return float(vertices[front, 2].min())

    @cached_property
    def mouth_z(self) -> float:
        """Where the lips meet."""
        vertices = self.body.rest_vertices_m
        inside = self.part("cavities") & (vertices[:, 2] < self.point("nose")[2] - 0.01 * self.head_scale)
        ahead = inside & (vertices[:, 0] > np.quantile(vertices[inside, 0], 0.7))
        return float(vertices[ahead, 2].mean())

    @cached_property
    def crotch_z(self) -> float:
        """Where the legs part."""
        vertices = self.body.rest_vertices_m
        middle = (np.abs(vertices[:, 1]) < _MIDDLE_M) & self.part("hips", "abdomen")
        return float(vertices[middle, 2].min())

    @cached_property
    def armpit_z(self) -> float:
        """Underside of the arm where it leaves the chest."""
        return float(self.joint("left_shoulder")[2] - 0.062 * self.scale)

    @cached_property
    def _points(self) -> Float:
        return self.body.coco_m(t_pose())
