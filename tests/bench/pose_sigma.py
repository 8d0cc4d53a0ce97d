"""How honest a keypoint's sigma is, and the fit it comes from: `python -m tests.bench.pose_sigma --data build`.

On the built-in footage each camera's keypoint is held against the point that the three others triangulate. Their difference has
the variance sigma^2 + P, P being what the others' own sigmas leave uncertain in this view. The parameters of
`edge.perception.pose.Spread` are fitted by maximum likelihood on every other ten frames, with Student's t (5 degrees of freedom)
for the tails, then moved so that half of the errors lie within 1.18 sigma, as of a normal distribution; the other tens judge.
"""

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import minimize

from edge.cameras.video import Video, load_video
from edge.perception.crop import blended, crop_from_box, crop_from_pose, cut, reduction_for
from edge.perception.detection import load_person_detector
from edge.perception.networks import Network, load_network
from edge.perception.pose import find_peaks, vote
from models.arrays import Bool, Float, Float32
from models.camera.rig import Rig, decode_rig
from models.messages.control import PoseNetwork
from services.calibration.shift import solve_shifts

RIG = Path("deploy/sites/footage/rig.toml")
_FREEDOM = 5
_HALF = 1.1774  # half of a two-dimensional normal distribution lies within this many sigmas


@dataclass(frozen=True, eq=False)
class Seen:
    """What one camera saw of the pupil: (frames, 17, ...) in cells of the heads, places in pixels of the video."""

    points_px: Float
    score: Float
    dissent: Float
    cell_px: Float


@dataclass(frozen=True, eq=False)
class Errors:
    """One entry a keypoint that four cameras saw, all in cells: its error against the others, and their uncertainty."""

    frame: Float
    error: Float
    others: Float
    score: Float
    dissent: Float


def follow(video: Video, network: Network, first_box: Float) -> Seen:
    """Track the pupil through one video, as the edge process does."""
    side_px = network.size_px[0]
    crop = crop_from_box(first_box)
    rows: list[tuple[Float | Float32, ...]] = []
    for frame in video.frames(30.0):
        # The first picture is looked at twice, so that its crop is as settled as the others'.
        for _ in range(1 if rows else 2):
            reduction = reduction_for(crop.side_px, side_px)
            heads = network(cut(frame.image(reduction), reduction, crop, side_px)[np.newaxis])
            peaks = find_peaks(heads["centre"][0], heads["heatmaps"][0], heads["regressions"][0])
            points, dissent = vote(peaks, heads["offsets"][0])
            score = peaks.scores[np.arange(17), peaks.rows, peaks.columns]
            cells = heads["centre"].shape[-1]
            points_px = crop.to_image(points / cells)
            seen_in, crop = crop, blended(crop, crop_from_pose(points_px, score > 0.3, crop), 0.7)
        rows.append((points_px, score, dissent, np.full(17, seen_in.side_px / cells)))
    return Seen(*(np.array(column) for column in zip(*rows, strict=True)))


def leave_one_out(rig: Rig, seen: list[Seen], sigma_cells: float) -> Errors:
    """Each keypoint against the triangulation of the same joint in all other views."""
    cameras = rig.cameras
    points = [camera.undistort(view.points_px) for camera, view in zip(cameras, seen, strict=True)]
    rows = []
    for frame, joint in np.ndindex(seen[0].score.shape):
        if min(view.score[frame, joint] for view in seen) < 0.1:
            continue
        for here, camera in enumerate(cameras):
            others = [index for index in range(len(cameras)) if index != here and seen[index].score[frame, joint] > 0.3]
            if len(others) < 3:
                continue
            sigmas_px = [sigma_cells * seen[index].cell_px[frame, joint] for index in others]
            equations, information = [], np.zeros((3, 3))
            for index, sigma_px in zip(others, sigmas_px, strict=True):
                matrix, point = cameras[index].projection, points[index][frame, joint]
                equations += [(point[axis] * matrix[2] - matrix[axis]) / sigma_px for axis in (0, 1)]
            homogeneous = np.linalg.svd(np.array(equations))[2][-1]
            place_m = homogeneous[:3] / homogeneous[3]
            for index, sigma_px in zip(others, sigmas_px, strict=True):
                slope = cameras[index].projection_jacobian(place_m) / sigma_px
                information += slope.T @ slope
            slope = camera.projection_jacobian(place_m)
            covariance_px2 = slope @ np.linalg.inv(information) @ slope.T
            cell_px = seen[here].cell_px[frame, joint]
            error_px = np.hypot(*(points[here][frame, joint] - camera.project_undistorted(place_m)))
            uncertain = np.sqrt(np.trace(covariance_px2) / 2)
            rows.append(
                (frame, error_px / cell_px, uncertain / cell_px, seen[here].score[frame, joint], seen[here].dissent[frame, joint])
            )
    return Errors(*np.array(rows).T)


def sigma_of(parameters: Float, errors: Errors) -> Float:
    """`Spread`'s formula, in cells."""
    by_score = np.exp(parameters[0] + parameters[1] * (1 - errors.score))
    sigma: Float = np.hypot(by_score, parameters[2] * np.maximum(errors.dissent - 0.4, 0))
    return sigma


def fit(errors: Errors, chosen: Bool) -> Float:
    """log_best, per_doubt and per_dissent."""

    def loss(parameters: Float) -> float:
        variance = sigma_of(parameters, errors) ** 2 + errors.others**2
        tails = (_FREEDOM + 2) / 2 * np.log1p(errors.error**2 / variance / _FREEDOM)
        return float(np.mean((np.log(variance) + tails)[chosen]))

    parameters: Float = minimize(loss, (-1.0, 2.0, 2.0), method="Nelder-Mead", options={"maxiter": 4000}).x
    parameters[0] += np.log(np.median(in_sigmas(parameters, errors)[chosen]) / _HALF)
    return parameters


def in_sigmas(parameters: Float, errors: Errors) -> Float:
    """Every error over its own standard deviation."""
    ratio: Float = errors.error / np.sqrt(sigma_of(parameters, errors) ** 2 + errors.others**2)
    return ratio


def lines(network: PoseNetwork, data: Path) -> Iterator[str]:
    """The report on one network."""
    rig = decode_rig(RIG.read_bytes(), str(RIG))
    videos = [load_video(data / "footage" / f"{name}.avi", name) for name in rig.names]
    pose, detector = load_network(f"movenet-{network}", data), load_person_detector(data)
    boxes = [detector.detect(next(video.frames(30.0)).image(1))[0][0] for video in videos]
    seen = [follow(video, pose, box) for video, box in zip(videos, boxes, strict=True)]
    first = slice(0, 50)
    keypoints, scores = np.stack([view.points_px for view in seen], axis=1), np.stack([view.score for view in seen], axis=1)
    rig = rig.with_shifts(solve_shifts(rig, keypoints[first], scores[first]))
    errors = leave_one_out(rig, seen, 0.45)
    odd = errors.frame // 10 % 2 == 0
    parameters = fit(errors, odd)
    ratio = in_sigmas(parameters, errors)
    yield f"{network}: log_best {parameters[0]:.2f}, per_doubt {parameters[1]:.2f}, per_dissent {parameters[2]:.1f}"
    shares = ", ".join(f"{np.mean(ratio[~odd] < count):.2f} within {count} sigma" for count in (1, 2, 3))
    yield f"  judged by the other frames ({np.sum(~odd)} keypoints): {shares} (normal: 0.39, 0.86, 0.99)"
    for low, high in ((0.1, 0.3), (0.3, 0.5), (0.5, 0.7), (0.7, 0.85), (0.85, 1.0)):
        chosen = (errors.score >= low) & (errors.score < high)
        sigma, half = np.median(sigma_of(parameters, errors)[chosen]), np.median(ratio[chosen])
        yield f"  score {low:.2f} to {high:.2f}: sigma {sigma:.2f} cells, half of the errors within {half:.2f} sigma"


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description="Fit and judge the keypoints' standard deviation on the built-in footage.")
    parser.add_argument("--data", type=Path, default=Path("build"))
    data = parser.parse_args().data
    for network in ("thunder", "lightning"):
        for line in lines(network, data):
            print(line)


if __name__ == "__main__":
    main()
