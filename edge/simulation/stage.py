"""From a lesson plan to what stands before the cameras: the gym, the pupils with what they do, the rig."""

from dataclasses import dataclass, replace

import numpy as np
from msgspec import UNSET

from edge.simulation.attempts import AttemptsByPupil
from edge.simulation.avatar import Avatar
from edge.simulation.casting import Member, cast
from edge.simulation.plan import Plan
from edge.simulation.programme import programme_of
from edge.simulation.rigs import make_rig
from edge.simulation.scene import Lamp, Scene
from edge.simulation.surface import Surface
from models.camera.pinhole import Camera
from models.camera.rig import Rig
from models.errors import UserError


@dataclass(frozen=True, eq=False)
class Stage:
    """What there is to film.

    Attributes:
        scene: all that can be seen.
        rig: the cameras as they are calibrated; where each really is, a plan may change.
        length_s: of the lesson.
        attempts: of each pupil.
    """

    scene: Scene
    rig: Rig
    length_s: float
    attempts: AttemptsByPupil


def rig_of(plan: Plan) -> Rig:
    """The cameras of a plan, as they are calibrated.

    Raises:
        UserError: there is no such rig, or it has fewer cameras.
    """
    rig = make_rig(plan.rig, plan.split, plan.seed)
    count = len(rig) if plan.cameras is UNSET else plan.cameras
    if count > len(rig):
        raise UserError(f"cameras: rig '{plan.rig}' has {len(rig)}, not {count}; ask for fewer, or name another rig")
    cameras = rig.cameras[:count]
    return Rig(cameras if plan.size_px is UNSET else tuple(resized(camera, plan.size_px) for camera in cameras))


def resized(camera: Camera, size_px: tuple[int, int]) -> Camera:
    """The same camera with pictures of another size: as wide as before, and as high as that then shows."""
    scale = size_px[0] / camera.size_px[0]
    matrix = camera.matrix_px.copy()
    matrix[:2, :2] *= scale
    # Pixel centres are at whole numbers: the middle of a picture w wide is at (w - 1) / 2.
    middle, before = (np.asarray(size, np.float64) / 2 - 0.5 for size in (size_px, camera.size_px))
    matrix[:2, 2] = middle + (matrix[:2, 2] - before) * scale
    return replace(camera, size_px=size_px, matrix_px=matrix)


def set_stage(plan: Plan) -> Stage:
    """Cast the pupils, have them learn what they do, and furnish the gym.

    Raises:
        UserError: a pupil cannot do what the plan says.
    """
    members = [_cast(plan, number) for number in range(len(plan.pupils))]
    motions = [programme_of(plan, number, member.subject) for number, member in enumerate(members)]
    avatars = tuple(
        Avatar(pupil.name, member.subject, member.look, motion)
        for pupil, member, motion in zip(plan.pupils, members, motions, strict=True)
    )
    length_s = max(motion.duration_s for motion in motions) if plan.length_s is UNSET else plan.length_s
    attempts = {pupil.name: motion.attempts for pupil, motion in zip(plan.pupils, motions, strict=True)}
    return Stage(Scene(_room(), avatars, (), (Lamp((0, 0, 1), (0.6, 0.6, 0.6)),)), rig_of(plan), length_s, attempts)


def _cast(plan: Plan, number: int) -> Member:
    wanted = plan.pupils[number]
    looks = plan.lot("looks", number) if wanted.looks is UNSET else wanted.looks
    age_years = None if wanted.age_years is UNSET else wanted.age_years
    return cast(plan.split, looks, age_years, None if wanted.sex is UNSET else wanted.sex)


def _room() -> tuple[Surface, ...]:
    corners = np.array([(-8.0, -8.0, 0.0), (8.0, -8.0, 0.0), (8.0, 8.0, 0.0), (-8.0, 8.0, 0.0)])
    return (Surface("floor", corners, np.array([(0, 1, 2), (0, 2, 3)], np.int32), np.full((4, 3), 0.5)),)
