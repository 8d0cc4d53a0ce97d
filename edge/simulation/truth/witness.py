"""Takes down what is true in a picture: bodies, where their points land, and what hides them. Needs no graphics library."""

import numpy as np

from edge.simulation.picture.course import Course, Courses, places_at, points_m
from edge.simulation.picture.lens import Lens, land
from edge.simulation.picture.meshes import corners_of
from edge.simulation.picture.scene import Pupil, Scene
from edge.simulation.picture.shutter import Shutter
from edge.simulation.picture.tessellation import tessellate
from edge.simulation.truth.truth import Truth
from edge.simulation.truth.visibility import Seen, first_surfaces, judge, reach_m
from models.arrays import Float, Float32, UInt8
from models.skeleton import coco_feet, smpl

_POINTS = smpl.COUNT + coco_feet.COUNT
_NUMBERS = 22


class Witness:
    """Watches one camera's pictures of a scene.

    Args:
        scene: the scene.
        lens: the camera as it truly is.
        shutter: its shutter.
        courses: of the scene's pupils and things, if somebody has them already (`Renderer.courses`).
    """

    def __init__(self, scene: Scene, lens: Lens, shutter: Shutter, courses: Courses | None = None) -> None:
        self._scene = scene
        self._lens = lens
        self._shutter = shutter
        self._courses = Courses((*scene.pupils, *scene.things)) if courses is None else courses
        self._reaches_m = [reach_m(pupil.body) for pupil in scene.pupils]
        cut = [tessellate(corners_of(surface)[..., :3], lens).reshape(-1, 3) for surface in scene.room]
        corners = np.concatenate([np.empty((0, 3)), *cut])
        self._room = lens.project(corners), lens.camera.to_camera(corners)[:, 2]
        self._faces = [np.asarray(actor.surface.faces, np.int64) for actor in (*scene.pupils, *scene.things)]
        self._room_faces = np.arange(len(corners)).reshape(-1, 3)

    def take_down(self, t_s: float) -> Truth:
        """The truth of the picture at `t_s`."""
        courses = self._courses.at(t_s, self._shutter)
        landed = [None if course is None else self._land(course) for course in courses]
        pupils = [self._pupil(pupil, t_s) if there else _Found() for pupil, there in zip(self._scene.pupils, landed, strict=False)]
        pixels = np.stack([found.pixels for found in pupils])
        depths = np.stack([found.depths for found in pupils])
        seen = self._seen(landed, pixels, depths)
        joints = slice(0, smpl.COUNT)
        coco = slice(smpl.COUNT, _POINTS)
        return Truth(
            times_s=np.array((t_s,)),
            cameras=self._lens.numbers[None, :_NUMBERS],
            translations_m=_single([found.translation for found in pupils]),
            rotations_rad=_single([found.rotations for found in pupils]),
            joints_m=_single([found.points_m[joints] for found in pupils]),
            coco_m=_single([found.points_m[coco] for found in pupils]),
            coco_exposed_m=_single([found.exposed_m[coco] for found in pupils]),
            joints_px=_single(pixels[:, joints]),
            coco_px=_single(pixels[:, coco]),
            joints_seen=seen[None, :, joints],
            coco_seen=seen[None, :, coco],
            boxes_px=_single([_box(there) for there in landed[: len(pupils)]]),
        )

    def _pupil(self, pupil: Pupil, t_s: float) -> "_Found":
        points = self._courses.of_points(pupil, t_s, self._shutter)
        pixels, depths, times = self._land(points)
        pose = pupil.pose(t_s)
        return _Found(pose.translation_m, pose.rotations_rad, points_m(pupil, t_s), places_at(points, times), pixels, depths)

    def _seen(self, landed: list[tuple[Float, Float, Float] | None], pixels: Float, depths: Float) -> UInt8:
        """(P, K) `Seen`."""
        width, height = self._lens.camera.size_px
        queries = pixels.reshape(-1, 2)
        first, owners = np.full(len(queries), np.inf), np.full(len(queries), -1)
        for number, (faces, there) in enumerate(zip(self._faces, landed, strict=True)):
            if there is not None:
                first_surfaces(*there[:2], faces, number, queries, first, owners, width, height)
        first_surfaces(*self._room, self._room_faces, len(landed), queries, first, owners, width, height)
        first_of, owners_of = (found.reshape(depths.shape) for found in (first, owners))
        inside = ((pixels >= -0.5) & (pixels < np.array((width, height)) - 0.5)).all(-1)
        seen = [
            judge(
                number, depths[number], reach, first_of[number], owners_of[number], len(self._scene.pupils), len(self._scene.things)
            )
            for number, reach in enumerate(self._reaches_m)
        ]
        return np.where(inside, np.stack(seen), np.uint8(Seen.OUTSIDE))

    def _land(self, course: Course) -> tuple[Float, Float, Float]:
        return land(course.powers, self._lens.numbers, 0.0, self._shutter.readout_s / course.half_s, self._height)

    @property
    def _height(self) -> int:
        return self._lens.camera.size_px[1]


class _Found:
    """What is known of a pupil in a picture; NaN for one who is not there."""

    def __init__(
        self,
        translation: Float | None = None,
        rotations: Float | None = None,
        points_m: Float | None = None,
        exposed_m: Float | None = None,
        pixels: Float | None = None,
        depths: Float | None = None,
    ) -> None:
        self.translation = np.full(3, np.nan) if translation is None else translation
        self.rotations = np.full((smpl.COUNT, 3), np.nan) if rotations is None else rotations
        self.points_m = np.full((_POINTS, 3), np.nan) if points_m is None else points_m
        self.exposed_m = np.full((_POINTS, 3), np.nan) if exposed_m is None else exposed_m
        self.pixels = np.full((_POINTS, 2), np.nan) if pixels is None else pixels
        self.depths = np.full(_POINTS, np.nan) if depths is None else depths


def _box(landed: tuple[Float, Float, Float] | None) -> Float:
    """(4,) around all that lies before the camera."""
    pixels = np.empty((0, 2)) if landed is None else landed[0][np.isfinite(landed[0]).all(1)]
    return np.concatenate((pixels.min(0), pixels.max(0))) if len(pixels) else np.full(4, np.nan)


def _single(parts: list[Float] | Float) -> Float32:
    """(1, P, ...)."""
    return np.asarray(parts, np.float32)[None]
