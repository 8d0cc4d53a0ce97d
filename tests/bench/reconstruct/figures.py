"""The figures of one lesson, looked at in one way. Means over actions and seeds are taken elsewhere."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from models.arrays import Bool, Float
from models.camera.pinhole import Camera
from models.camera.rig import Rig
from models.skeleton import coco
from tests.bench.metrics.alignment import pampjpe_mm
from tests.bench.metrics.bound import sigma_of_distances, triangulation_bound_m
from tests.bench.metrics.correctness import pck_auc_pct, pck_pct
from tests.bench.metrics.position import distances_m, position_error
from tests.bench.metrics.reprojection import reprojection_px, rmse
from tests.bench.metrics.steadiness import acceleration_error_mm, jitter_mm, largest_jump_mm, peak_speed_bias_pct, peak_speed_m_s
from tests.bench.reconstruct.keypoints import Seen
from tests.bench.reconstruct.lesson import Span
from tests.bench.reconstruct.observed import CONFIG, RATE_HZ

PCK_MM = 50.0
AUC_LIMIT_MM = 150.0
MIN_PEAK_M_S = 2.0
"""Of a joint that is slower there is no peak to speak of."""
_DISTAL = tuple(coco.INDEX[f"{side}_{part}"] for side in ("left", "right") for part in ("wrist", "ankle"))


@dataclass(frozen=True, eq=False)
class Judged:
    """A reconstruction held against the truth over one span.

    Attributes:
        action: what is done.
        times_s: (n,) instants.
        found_m, truth_m: (n, 17, 3).
    """

    action: str
    times_s: Float
    found_m: Float
    truth_m: Float


def judge(spans: Sequence[Span], times_s: Float, found_m: Float, truth_m: Callable[[Float], Float]) -> list[Judged]:
    """Each span's instants, by name of its action."""
    judged = []
    for span in spans:
        inside = (times_s >= span.begin_s) & (times_s <= span.end_s)
        if inside.any():
            judged.append(Judged(span.action, times_s[inside], found_m[inside], truth_m(times_s[inside])))
    return judged


def of_action(judged: Sequence[Judged]) -> dict[str, float]:
    """Figures of one action, over its spans; differences are never taken across two spans."""
    found = np.concatenate([each.found_m for each in judged])
    truth = np.concatenate([each.truth_m for each in judged])
    error = position_error(found, truth)
    distance_mm = 1e3 * distances_m(found, truth)[np.isfinite(truth).all(axis=-1)]
    return {
        "mpjpe_mm": error.mpjpe_mm,
        "p95_mm": error.p95_mm,
        "pampjpe_mm": pampjpe_mm(found, truth),
        "pck50_pct": pck_pct(distance_mm, PCK_MM),
        "pck_auc150_pct": pck_auc_pct(distance_mm, AUC_LIMIT_MM),
        "acc_error_mm": _mean([acceleration_error_mm(each.found_m, each.truth_m) for each in judged]),
        "max_jump_mm": _largest([largest_jump_mm(each.found_m - each.truth_m) for each in judged]),
        "peak_speed_bias_pct": _mean([bias for each in judged for bias in peak_biases_pct(each)]),
        "missing_pct": error.missing_pct,
        "frames_without_pose": float(len(error.without_pose)),
    }


def peak_biases_pct(judged: Judged) -> list[float]:
    """Of each wrist and ankle that truly becomes fast in the span: by how much its peak speed is wrong."""
    biases = []
    for joint in _DISTAL:
        found, truth = judged.found_m[:, joint], judged.truth_m[:, joint]
        if peak_speed_m_s(truth, RATE_HZ, 1) >= MIN_PEAK_M_S:
            biases.append(peak_speed_bias_pct(found, truth, RATE_HZ))
    return [bias for bias in biases if np.isfinite(bias)]


def jitter_reduction_pct(smooth: Sequence[Judged], each_frame: Sequence[Judged]) -> float:
    """How much less the smooth motion jitters than the fit of each frame alone, where both say something."""
    ours, raw = [], []
    for one, other in zip(smooth, each_frame, strict=True):
        both = np.isfinite(one.found_m + other.found_m).all(axis=-1, keepdims=True)
        ours.append(jitter_mm(np.where(both, one.found_m, np.nan)))
        raw.append(jitter_mm(np.where(both, other.found_m, np.nan)))
    return 100 * (1 - _mean(ours) / _mean(raw))


def noise_px(camera: Camera, seen: Seen) -> Float:
    """(17,) sigma in each pixel axis of the keypoints that a camera saw and that are used, after undistortion.

    Against the truth, about the joint's median error of this camera.
    """
    error = np.where(seen.used[..., None], camera.undistort(seen.points_px) - camera.undistort(seen.truth_px), np.nan)
    sigmas = np.full(coco.COUNT, np.nan)
    for joint in range(coco.COUNT):
        known = error[np.isfinite(error[:, joint, 0]), joint]
        if len(known) >= 8:
            sigmas[joint] = sigma_of_distances(np.linalg.norm(known - np.median(known, axis=0), axis=-1))
    return sigmas


def bound_mm(rig: Rig, seen: Sequence[Seen], times_s: Float, truth_m: Float) -> Float:
    """(n, 17) the Cramer-Rao bound at the measured noise, of the keypoints of the pictures nearest to the instants.

    Args:
        rig: the cameras that looked.
        seen: what they saw, every frame.
        times_s: (n,) instants.
        truth_m: (n, 17, 3) at them.
    """
    sigma = np.stack([noise_px(rig.cameras[look.camera], look) for look in seen], axis=-1)
    usable: list[Bool] = []
    for look in seen:
        nearest = np.abs(np.subtract.outer(times_s, look.times_s)).argmin(axis=1)
        usable.append(np.asarray(look.used[nearest] & np.isfinite(look.points_px[nearest, :, 0])))
    there = np.stack(usable, axis=-1) & np.isfinite(sigma)
    return 1e3 * triangulation_bound_m(rig, truth_m, np.broadcast_to(np.nan_to_num(sigma, nan=1.0), there.shape), there)


def reprojection_rmse_px(rig: Rig, seen: Sequence[Seen], found_m: Callable[[Float], Float]) -> float:
    """Of the keypoints that are used, against the reconstruction at their own instants."""
    distances = []
    for camera in seen:
        one = Rig((rig.cameras[camera.camera],))
        joints, points = found_m(camera.times_s), camera.points_px[:, None]
        distances.append(reprojection_px(one, joints, points, camera.scores[:, None], min_score=CONFIG.sighting.min_score).ravel())
    return rmse(np.concatenate(distances))


def mean_over(actions: Sequence[str], figures: Mapping[str, Mapping[str, float]]) -> dict[str, float]:
    """Figures over some actions: the mean of each, the largest jump, the sum of frames; nothing if an action is missing."""
    if not actions or any(action not in figures for action in actions):
        return {}
    combined = {}
    for name in figures[actions[0]]:
        values = [figures[action][name] for action in actions]
        combined[name] = (
            _largest(values) if name == "max_jump_mm" else sum(values) if name == "frames_without_pose" else _mean(values)
        )
    return combined


def _largest(values: Sequence[float]) -> float:
    return float(np.max(values))  # not `max`, which overlooks a NaN that comes later


def _mean(values: Sequence[float]) -> float:
    return float(np.mean(values)) if len(values) and np.isfinite(values).all() else np.nan
