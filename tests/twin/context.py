"""What a situation looks like to a network, of which its errors depend: pose in the picture, view, occlusion, speed, size.

Everything is computed from the truth alone, so that it can be had without a picture, and is free of the picture's place, of its
scale and of the trunk's angle, by which the crops are turned, too.
"""

from dataclasses import dataclass, fields

import numpy as np

from models.arrays import Float
from models.camera.pinhole import Camera
from models.skeleton import coco
from services.fusion.prediction import CROP_MARGIN, SHORT_TRUNK
from tests.twin.occlusion import hidden
from tests.twin.truth import Truth

MIRROR = np.array(coco.MIRROR)
_LEFT_SHOULDER, _RIGHT_SHOULDER, _LEFT_HIP, _RIGHT_HIP = coco.TRUNK


@dataclass(frozen=True, eq=False)
class Frame:
    """From a picture's pixels to the frame in which errors are told: trunk upwards, one the body's stature.

    Attributes:
        points_px: (n, 17, 2) true points in the picture, distorted; NaN behind the camera.
        turn: (n, 2, 2) applied to row vectors in pixels, it turns the trunk upwards.
        lean_rad: (n,) angle of the trunk, as in `models.skeleton.trunk`; 0 where it cannot be told.
        stature_px: (n,) the pupil's standing height at its distance.
        side_px: (n,) of the crop that fusion would ask for.
    """

    points_px: Float
    turn: Float
    lean_rad: Float
    stature_px: Float
    side_px: Float


@dataclass(frozen=True, eq=False)
class Context:
    """Features of n situations; zeros where points are behind the camera.

    Attributes:
        pose: (n, 17, 2) points in the picture from the middle of the hips, trunk upwards, over the stature.
        hidden: (n, 17) see `tests.twin.occlusion`; 1 outside the picture, too.
        speed: (n, 17) log(1 + speed in the picture in statures a second).
        view: (n, 3) direction to the camera in the trunk's axes (front, left, up), a unit vector.
        size: (n,) log of the stature in pixels.
        extent: (n,) log of the crop's side over the stature.
    """

    pose: Float
    hidden: Float
    speed: Float
    view: Float
    size: Float
    extent: Float

    def __len__(self) -> int:
        return len(self.size)

    def mirrored(self) -> "Context":
        """The same situations in a mirror: a network sees a mirrored picture as well as the picture."""
        pose, view = self.pose[:, MIRROR].copy(), self.view.copy()
        pose[..., 0] *= -1
        view[:, 1] *= -1
        return Context(pose, self.hidden[:, MIRROR], self.speed[:, MIRROR], view, self.size, self.extent)

    def chosen(self, which: object) -> "Context":
        """Some of the situations, by anything that numpy takes as an index."""
        return Context(*(getattr(self, field.name)[which] for field in fields(self)))


def together(contexts: list[Context]) -> Context:
    """One after another."""
    return Context(*(np.concatenate([getattr(context, field.name) for context in contexts]) for field in fields(Context)))


def look(truth: Truth) -> tuple[Frame, Context]:
    """The frame of the errors, and the situation, in each picture of a truth."""
    camera, points_m = truth.camera, truth.points_m[:, 0]
    points_px = camera.project(points_m)
    depth_m = camera.to_camera(points_m.mean(axis=1))[:, 2]
    focal_px = float(np.sqrt(camera.matrix_px[0, 0] * camera.matrix_px[1, 1]))
    stature_px = focal_px * truth.statures_m[0] / np.maximum(depth_m, 0.1)
    lean = _lean(points_px)
    turn = np.stack((np.stack((np.cos(lean), -np.sin(lean)), axis=-1), np.stack((np.sin(lean), np.cos(lean)), axis=-1)), axis=-2)
    hips_px = points_px[:, [_LEFT_HIP, _RIGHT_HIP]].mean(axis=1, keepdims=True)
    pose = (points_px - hips_px) @ turn / stature_px[:, None, None]
    side = CROP_MARGIN * np.ptp(pose, axis=1).max(axis=1)
    covered = hidden(camera.centre_m, truth.points_m, truth.statures_m)
    covered[~inside(points_px, camera)] = 1.0
    moved_px = camera.project(points_m + 1e-3 * truth.velocity_m_s) - points_px
    speed = np.log1p(np.linalg.norm(moved_px, axis=-1) / 1e-3 / stature_px[:, None])
    features = pose, covered, speed, _view(points_m, camera.centre_m), np.log(stature_px), np.log(np.maximum(side, 1e-3))
    return Frame(points_px, turn, lean, stature_px, side * stature_px), Context(*map(np.nan_to_num, features))


def inside(points_px: Float, camera: Camera) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Which points (..., 2) are in the picture; NaN is not."""
    width, height = camera.size_px
    return np.asarray(((points_px >= -0.5) & (points_px <= (width - 0.5, height - 0.5))).all(axis=-1))


def _lean(points_px: Float) -> Float:
    trunk = points_px[:, [_LEFT_SHOULDER, _RIGHT_SHOULDER]].mean(axis=1) - points_px[:, [_LEFT_HIP, _RIGHT_HIP]].mean(axis=1)
    extent = np.ptp(points_px, axis=1).max(axis=1)
    told = np.hypot(trunk[:, 0], trunk[:, 1]) >= SHORT_TRUNK * extent
    return np.where(told, np.arctan2(trunk[:, 0], -trunk[:, 1]), 0.0)


def _view(points_m: Float, centre_m: Float) -> Float:
    """(n, 3) where the camera is, seen from the trunk."""
    shoulders = points_m[:, [_LEFT_SHOULDER, _RIGHT_SHOULDER]].mean(axis=1)
    hips = points_m[:, [_LEFT_HIP, _RIGHT_HIP]].mean(axis=1)
    up = _unit(shoulders - hips)
    across = points_m[:, _LEFT_SHOULDER] - points_m[:, _RIGHT_SHOULDER] + points_m[:, _LEFT_HIP] - points_m[:, _RIGHT_HIP]
    left = _unit(across - (across * up).sum(axis=1, keepdims=True) * up)
    to_camera = _unit(centre_m - (shoulders + hips) / 2)
    return np.stack([(axis * to_camera).sum(axis=1) for axis in (np.cross(left, up), left, up)], axis=-1)


def _unit(vectors: Float) -> Float:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-9))
