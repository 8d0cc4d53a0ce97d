"""The landmark bias: where a network's points lie on the body, against the body's own COCO points.

A network was trained on what people clicked in pictures, and a hip was clicked elsewhere than where the body has it. So its points
have a place of their own on the segment that they belong to, which is the same from all sides. That place is estimated by robust
least squares over all pictures: projected, the body's point moved by the bias in its segment's axes
(`models.skeleton.segment_axes`) shall lie where the network saw it. A single picture says nothing of the bias along its line of
sight; pictures from all sides do. Left and right are mirror images, so a pair of joints shares one bias: front, outwards (away
from the body's middle) and up. It is told in shares of the trunk's length, so that it holds for children and adults.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.camera.pinhole import Camera
from models.skeleton import coco
from models.skeleton.segment_axes import segment_axes, trunk_length_m

PAIRS: Final = {
    "nose": (coco.INDEX["nose"],),
    **{
        part: (coco.INDEX[f"left_{part}"], coco.INDEX[f"right_{part}"])
        for part in ("eye", "ear", "shoulder", "elbow", "wrist", "hip", "knee", "ankle")
    },
}
"""Joints that share a bias, by name."""
AXES: Final = ("front", "outwards", "up")
_ITERATIONS: Final = 12
_HUBER: Final = 1.5
_LEAST: Final = 30
"""Keypoints; fewer tell nothing."""


@dataclass(frozen=True, eq=False)
class Looks:
    """What one camera's pictures say.

    Attributes:
        camera: calibration.
        points_px: (n, 17, 2) the network's points, as observed (distorted).
        truth_m: (n, 17, 3) the body's points as they were exposed.
        counts: (n, 17) which points to go by: seen, and believed.
    """

    camera: Camera
    points_px: Float
    truth_m: Float
    counts: Bool


@dataclass(frozen=True, eq=False)
class Bias:
    """Of one joint or pair.

    Attributes:
        shares: (3,) front, outwards, up, over the trunk's length.
        mm: (3,) the same times the mean trunk's length.
        sigma_mm: (3,) standard error of `mm`, as if all pictures were independent: of a film they are not, so it is a lower bound.
        count: keypoints that it rests on.
    """

    shares: Float
    mm: Float
    sigma_mm: Float
    count: int


def estimate_bias(looks: Sequence[Looks], joints: Iterable[int]) -> Bias | None:
    """The bias that a joint, or the two of a pair, have in common; None if too few keypoints tell of it."""
    slopes, errors, lengths = [], [], []
    for look in looks:
        axes, length = segment_axes(look.truth_m), trunk_length_m(look.truth_m)
        flat = look.camera.undistort(look.points_px)
        for joint in joints:
            error = flat[:, joint] - look.camera.project_undistorted(look.truth_m[:, joint])
            slope = look.camera.projection_jacobian(look.truth_m[:, joint]) @ (axes[:, joint] * _outwards(joint))
            slope = slope * length[:, None, None]
            known = look.counts[:, joint] & np.isfinite(error).all(axis=1) & np.isfinite(slope).all(axis=(1, 2))
            slopes.append(slope[known])
            errors.append(error[known])
            lengths.append(length[known])
    slope, error, length = np.concatenate(slopes), np.concatenate(errors), np.concatenate(lengths)
    if len(error) < _LEAST:
        return None
    shares, covariance = _robust_solution(slope, error)
    scale_mm = 1e3 * float(length.mean())
    return Bias(shares, shares * scale_mm, np.sqrt(np.diag(covariance)) * scale_mm, len(error))


def all_biases(looks: Sequence[Looks]) -> dict[str, Bias]:
    """By name of the pair, where enough is known."""
    found = {name: estimate_bias(looks, joints) for name, joints in PAIRS.items()}
    return {name: bias for name, bias in found.items() if bias is not None}


def as_points(biases: dict[str, Bias]) -> Float:
    """(17, 3) shares of the trunk's length, in (front, left, up) of each point's own segment; zero where nothing is known.

    The nose has no left: whatever a film says of that is chance.
    """
    points = np.zeros((coco.COUNT, 3))
    for name, bias in biases.items():
        for joint in PAIRS[name]:
            points[joint] = bias.shares * _outwards(joint) * (1.0, float(name != "nose"), 1.0)
    return points


def _outwards(joint: int) -> Float:
    """(3,) signs from (front, outwards, up) to (front, left, up)."""
    return np.array((1.0, -1.0 if coco.NAMES[joint].startswith("right") else 1.0, 1.0))


def _robust_solution(slope: Float, error: Float) -> tuple[Float, Float]:
    """Huber's estimate of b in error = slope b, (n, 2, 3) and (n, 2), and its covariance."""
    weights = np.ones(len(error))
    for _ in range(_ITERATIONS):
        normal = np.einsum("n,nij,nik->jk", weights, slope, slope)
        solution = np.linalg.solve(normal, np.einsum("n,nij,ni->j", weights, slope, error))
        distance = np.linalg.norm(error - slope @ solution, axis=1)
        sigma = max(float(np.median(distance)) / np.sqrt(2 * np.log(2)), 1e-6)
        weights = np.minimum(1.0, _HUBER * sigma / np.maximum(distance, 1e-9))
    variance = float((weights * distance**2).sum() / max(2 * weights.sum() - 3, 1.0))
    return np.asarray(solution), np.asarray(variance * np.linalg.inv(normal))
