"""Pose2Sim 0.10.49 on our keypoints: writes its project folder, runs it in its environment, reads its TRC back.

Settings are its demo's and documentation's for one person (thresholds 0.3 and 15 px at full resolution, at least two
cameras, gaps below 20 frames interpolated, Hampel filter before the filter proper), but for displays, which are off. Each of its
filters has its demo's parameters. Its handling of left-right swaps is documented as not implemented, and off in its demos; there is
code for it, so everything is asked for once more with it. It is given keypoints that are
already undistorted and shifted, with a calibration without distortion, so that it is not charged for what it does not do.
"""

import json
from collections.abc import Sequence
from itertools import chain
from pathlib import Path

import cv2
import numpy as np

from models.arrays import Float
from models.camera.rig import Rig
from models.skeleton import coco
from tests.bench.peers.answer import Answer, Keypoints
from tests.bench.peers.environment import run_in

NAME = "pose2sim"
DEFAULT = f"{NAME}.butterworth"
"""What its demo does."""
FILTERS = (
    "butterworth",
    "kalman",
    "one_euro",
    "gcv_spline",
    "gaussian",
    "loess",
    "median",
    "butterworth_on_speed",
    "acc_minimizing",
)
SWAPS = "_swaps"
"""Ends the name of a setting with its handling of left-right swaps."""
_SETTINGS = {
    "raw": "triangulation alone: cameras are left out until the mean reprojection error is below 15 px; no filter",
    "butterworth": "its demo: + Hampel, Butterworth 4th order 6 Hz",
    "kalman": "+ Hampel, Kalman smoother, trust ratio 500",
    "one_euro": "+ Hampel, One Euro 4 Hz, beta 1.5, zero phase",
    "gcv_spline": "+ Hampel, spline by generalised cross-validation, automatic",
    "gaussian": "+ Hampel, Gaussian kernel, sigma 1",
    "loess": "+ Hampel, LOESS over 5 frames",
    "median": "+ Hampel, median of 3",
    "butterworth_on_speed": "+ Hampel, Butterworth on speed, 4th order 10 Hz",
    "acc_minimizing": "+ Hampel, Whittaker-Henderson 6 Hz",
}
SETTINGS = _SETTINGS | {f"{name}{SWAPS}": f"{text}; swaps of left and right handled" for name, text in _SETTINGS.items()}
_NAMES = {
    "Nose": "nose",
    **{side[0].upper() + part.capitalize(): f"{side}_{part}" for side in ("left", "right") for part in
       ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")},
}  # fmt: skip
JOINTS = tuple(sorted(coco.INDEX[name] for name in _NAMES.values()))
"""The joints that it has: all but eyes and ears."""


def run_pose2sim(
    folder: Path, clips: Sequence[Keypoints], filters: Sequence[str] = FILTERS, swaps: Sequence[bool] = (False, True)
) -> list[list[Answer]]:
    """Reconstruct one person in clips: the answers of the triangulation alone and after each filter.

    Args:
        folder: an empty folder to work in.
        clips: keypoints, without distortion.
        filters: of `FILTERS`.
        swaps: without and with its handling of left-right swaps, or one of both.
    """
    order = [(clip, handled) for clip in clips for handled in swaps]
    projects = [folder / str(number) for number in range(len(order))]
    for project, (clip, handled) in zip(projects, order, strict=True):
        _write_calibration(project / "calibration", clip.rig, clip.scale)
        _write_keypoints(project / "pose", clip.rig, clip.points_px * clip.scale, clip.scores)
        (project / "Config.toml").write_text(_config(len(clip), clip.rate_hz, swaps=handled))
    times = json.loads(run_in(NAME, [",".join(filters), *(str(project.absolute()) for project in projects)]))
    answers = [
        [_answer(project, setting, seconds, len(clip), SWAPS if handled else "") for setting in ("raw", *filters)]
        for project, (clip, handled), seconds in zip(projects, order, times, strict=True)
    ]
    return [list(chain(*answers[first : first + len(swaps)])) for first in range(0, len(answers), len(swaps))]


def _answer(project: Path, setting: str, seconds: dict[str, dict[str, float]], frames: int, ending: str) -> Answer:
    stages = ["association", "triangulation", *([] if setting == "raw" else [setting])]
    cpu_ms, wall_ms = (1e3 * sum(seconds[stage][clock] for stage in stages) / frames for clock in ("cpu", "wall"))
    files = (project / "pose-3d").glob("*.trc")
    (file,) = [f for f in files if ("filt" not in f.name if setting == "raw" else f.stem.endswith(f"filt_{setting}"))]
    return Answer(f"{NAME}.{setting}{ending}", _read_trc(file, frames), cpu_ms, wall_ms)


def _write_calibration(folder: Path, rig: Rig, scale: float) -> None:
    folder.mkdir(parents=True)
    lines = []
    for camera in rig:
        matrix = camera.matrix_px * scale
        matrix[2, 2] = 1.0
        rotation = cv2.Rodrigues(camera.rotation)[0].ravel()
        lines += [
            f"[{camera.name}]",
            f'name = "{camera.name}"',
            f"size = [{camera.size_px[0] * scale:.1f}, {camera.size_px[1] * scale:.1f}]",
            f"matrix = {matrix.tolist()}",
            "distortions = [0.0, 0.0, 0.0, 0.0]",
            f"rotation = {rotation.tolist()}",
            f"translation = {camera.translation_m.tolist()}",
            "fisheye = false",
            "",
        ]
    (folder / "Calib.toml").write_text("\n".join(lines))


def _write_keypoints(folder: Path, rig: Rig, points_px: Float, scores: Float) -> None:
    for index, camera in enumerate(rig):
        target = folder / f"{camera.name}_json"
        target.mkdir(parents=True)
        for frame in range(len(points_px)):
            points, score = points_px[frame, index], scores[frame, index]
            person = {"person_id": [-1], "pose_keypoints_2d": np.column_stack((points, score)).ravel().tolist()}
            people = [person] if np.isfinite(points).all() else []
            (target / f"{camera.name}_{frame:06d}.json").write_text(json.dumps({"version": 1.3, "people": people}))


def _config(frames: int, rate_hz: float, *, swaps: bool) -> str:
    return f"""
[project]
project_dir = "."
multi_person = false
participant_height = 1.8
participant_mass = 70.0
frame_rate = {round(rate_hz)}
frame_range = [0, {frames}]
exclude_from_batch = []
[pose]
pose_model = "Body"
vid_img_extension = "mp4"
[personAssociation.single_person]
likelihood_threshold_association = 0.3
reproj_error_threshold_association = 20
tracked_keypoint = "RShoulder"
[triangulation]
reproj_error_threshold_triangulation = 15
likelihood_threshold_triangulation = 0.3
min_cameras_for_triangulation = 2
interp_if_gap_smaller_than = 20
interpolation = "linear"
remove_incomplete_frames = false
sections_to_keep = "all"
min_chunk_size = 10
fill_large_gaps_with = "last_value"
show_interp_indices = false
handle_LR_swap = {str(swaps).lower()}
undistort_points = false
make_c3d = false
[filtering]
reject_outliers = true
filter = true
type = "butterworth"
display_figures = false
save_filt_plots = false
make_c3d = false
[filtering.butterworth]
cut_off_frequency = 6
order = 4
[filtering.kalman]
trust_ratio = 500
smooth = true
[filtering.one_euro]
cut_off_frequency = 4
beta = 1.5
d_cut_off_frequency = 1.0
[filtering.gcv_spline]
cut_off_frequency = "auto"
smoothing_factor = 1.0
[filtering.acc_minimizing]
cut_off_frequency = 6
[filtering.loess]
nb_values_used = 5
[filtering.gaussian]
sigma_kernel = 1
[filtering.median]
kernel_size = 3
[filtering.butterworth_on_speed]
cut_off_frequency = 10
order = 4
"""


def _read_trc(file: Path, frames: int) -> Float:
    lines = file.read_text().splitlines()
    names = [name for name in lines[3].split("\t")[2:] if name]
    joints = np.full((frames, coco.COUNT, 3), np.nan)
    for line in lines[5:]:
        cells = line.split("\t")
        if not cells[0].strip():
            continue
        values = np.array([float(cell) if cell.strip() else np.nan for cell in cells[2 : 2 + 3 * len(names)]]).reshape(-1, 3)
        frame = int(cells[0])
        for name, value in zip(names, values, strict=True):
            if name in _NAMES and frame < frames:
                joints[frame, coco.INDEX[_NAMES[name]]] = value[[2, 0, 1]]  # its axes are our (y, z, x)
    return joints
