"""What a network got wrong, told so that it can be moved to another picture, and back.

A keypoint belongs to its own joint or, where left and right are mistaken for one another, to that joint's counterpart. Which of
the two, and how far from it, is told apart: a swapped wrist is then on the other wrist in the new picture as well, wherever that
is. One of a pair alone on the other's place is told just so.
"""

from dataclasses import dataclass, fields, replace

import numpy as np

from models.arrays import Bool, Float
from models.skeleton import coco
from tests.twin.context import MIRROR, Frame
from tests.twin.truth import Said

_NEARER = 0.5
_APART = 0.04
"""A keypoint is its counterpart's if it is nearer to that by `_NEARER`, and further from its own than `_APART` statures."""


@dataclass(frozen=True, eq=False)
class Errors:
    """Of n pictures. Where the pupil was not found, the numbers mean nothing.

    Attributes:
        residual: (n, 17, 2) keypoint less the true point that it belongs to, in the frame of `tests.twin.context.Frame`.
        crossed: (n, 17) whether that is the counterpart's.
        score: (n, 17).
        spread: (n, 17) log of the reported sigma over the crop's side.
        found: (n,) whether there are keypoints.
        renewed: (n,) whether the track has a new number.
    """

    residual: Float
    crossed: Bool
    score: Float
    spread: Float
    found: Bool
    renewed: Bool

    def __len__(self) -> int:
        return len(self.found)

    def mirrored(self) -> "Errors":
        """The same errors in a mirror."""
        residual = self.residual[:, MIRROR] * (-1.0, 1.0)
        crossed, score, spread = self.crossed[:, MIRROR], self.score[:, MIRROR], self.spread[:, MIRROR]
        return Errors(residual, crossed, score, spread, self.found, self.renewed)

    def chosen(self, which: object) -> "Errors":
        """Those of some pictures, by anything that numpy takes as an index."""
        return Errors(*(getattr(self, field.name)[which] for field in fields(self)))


def together(errors: list[Errors]) -> Errors:
    """One after another."""
    return Errors(*(np.concatenate([getattr(one, field.name) for one in errors]) for field in fields(Errors)))


def nothing(count: int) -> Errors:
    """Of `count` pictures in which nobody was found."""
    points, no = np.zeros((count, coco.COUNT)), np.zeros(count, np.bool_)
    return Errors(np.zeros((count, coco.COUNT, 2)), np.zeros((count, coco.COUNT), np.bool_), points, points.copy(), no, no.copy())


def errors_of(frame: Frame, said: Said) -> Errors:
    """What was wrong with what was said."""
    found = said.found & np.isfinite(frame.points_px).all(axis=(1, 2))
    own = _in_frame(said.keypoints_px - frame.points_px, frame)
    residual, crossed = _told_apart(own, _in_frame(frame.points_px[:, MIRROR] - frame.points_px, frame))
    spread = np.log(said.sigma_px / said.side_px[:, None])
    residual, score, spread = (np.nan_to_num(values) for values in (residual, said.score, spread))
    return Errors(residual, crossed & found[:, None], score, spread, found, said.renewed & found)


def as_seen(pose: Float, errors: Errors) -> Errors:
    """The same keypoints, told as one does who knows nothing but them: a swap of points that coincide is none.

    Args:
        pose: (n, 17, 2) as `Context.pose`.
        errors: of these situations.
    """
    residual, crossed = _told_apart(displacement(pose, errors), pose[:, MIRROR] - pose)
    return replace(errors, residual=residual, crossed=crossed)


def _told_apart(own: Float, across: Float) -> tuple[Float, Bool]:
    """Residuals (n, 17, 2) and whether they are from the counterpart (n, 17).

    Args:
        own: (n, 17, 2) keypoint less its own true point.
        across: (n, 17, 2) the counterpart's true point less its own.
    """
    other = own - across
    far, farther = np.linalg.norm(other, axis=-1), np.linalg.norm(own, axis=-1)
    crossed = (far < _NEARER * farther) & (farther > _APART)
    return np.where(crossed[..., None], other, own), crossed


def said_of(frame: Frame, errors: Errors, delay_s: Float) -> Said:
    """What a network says that errs so."""
    true_px = np.where(errors.crossed[..., None], frame.points_px[:, MIRROR], frame.points_px)
    keypoints_px = true_px + errors.residual @ np.swapaxes(frame.turn, 1, 2) * frame.stature_px[:, None, None]
    sigma_px = np.exp(errors.spread) * frame.side_px[:, None]
    lost = ~errors.found
    keypoints_px[lost], sigma_px[lost] = np.nan, np.nan
    score, side_px = np.where(lost[:, None], np.nan, errors.score), np.where(lost, np.nan, frame.side_px)
    return Said(keypoints_px, sigma_px, score, side_px, errors.renewed, delay_s)


def displacement(pose: Float, errors: Errors) -> Float:
    """(n, 17, 2) keypoint less its own true point, in statures, crossed or not; `pose` as `Context.pose`."""
    across = np.where(errors.crossed[..., None], pose[:, MIRROR] - pose, 0.0)
    return np.asarray(errors.residual + across)


def _in_frame(offset_px: Float, frame: Frame) -> Float:
    return np.asarray(offset_px @ frame.turn / frame.stature_px[:, None, None])
