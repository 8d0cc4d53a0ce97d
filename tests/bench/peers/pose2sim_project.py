"""Pose2Sim 0.10.49 on our keypoints: writes its project folder, runs it in its environment, reads its TRC back.

Settings are its demo's and documentation's for one person (thresholds 0.3 and 15 px at full resolution, at least two
cameras, Butterworth 4th order 6 Hz after its Hampel filter), but for displays, which are off. It is given keypoints that are
already undistorted and shifted, with a calibration without distortion, so that it is not charged for what it does not do.
"""

import json
import os
import subprocess
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from models.arrays import Float
from models.camera.rig import Rig
from models.skeleton import coco

ENVIRONMENT = Path("build/peers/pose2sim")
_RUNNER = Path(__file__).parent / "pose2sim/run.py"
_NAMES = {
    "Nose": "nose",
    **{side[0].upper() + part.capitalize(): f"{side}_{part}" for side in ("left", "right") for part in
       ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")},
}  # fmt: skip


@dataclass(frozen=True)
class Pose2SimResult:
    """What it found.

    Attributes:
        raw_m, filtered_m: (frames, 17, 3) in our world frame; NaN where it has nothing (eyes and ears always).
        wall_s, cpu_s: of association, triangulation and filtering together.
    """

    raw_m: Float
    filtered_m: Float
    wall_s: float
    cpu_s: float


def run_pose2sim(folder: Path, rig: Rig, points_px: Float, scores: Float, rate_hz: float, scale: float) -> Pose2SimResult:
    """Reconstruct one person.

    Args:
        folder: an empty folder to work in.
        rig: calibration, in the resolution of the keypoints.
        points_px: (frames, cameras, persons, 17, 2) undistorted keypoints with `shift_px` taken off; NaN for nobody.
        scores: (frames, cameras, persons, 17).
        rate_hz: frames a second.
        scale: full resolution over the keypoints' resolution; its thresholds are in full-resolution pixels.
    """
    _write_calibration(folder / "calibration", rig, scale)
    _write_keypoints(folder / "pose", rig, points_px * scale, scores)
    (folder / "Config.toml").write_text(_config(len(points_px), rate_hz))
    environment = {**os.environ, "MPLBACKEND": "Agg", "QT_QPA_PLATFORM": "offscreen"}
    for name in ("PYTHONPATH", "PYTHONHOME"):
        environment.pop(name, None)
    result = subprocess.run(
        [str((ENVIRONMENT / "bin/python").absolute()), str(_RUNNER), str(folder)],
        capture_output=True, text=True, check=False, env=environment,
    )  # fmt: skip
    if result.returncode != 0:
        raise RuntimeError(f"Pose2Sim failed:\n{result.stderr[-3000:]}")
    seconds = json.loads(result.stdout.strip().splitlines()[-1])
    files = sorted((folder / "pose-3d").glob("*.trc"))
    filtered = [file for file in files if "filt" in file.name]
    raw = [file for file in files if "filt" not in file.name]
    return Pose2SimResult(
        raw_m=_read_trc(raw[0], len(points_px)),
        filtered_m=_read_trc(filtered[0], len(points_px)),
        wall_s=sum(stage["wall"] for stage in seconds.values()),
        cpu_s=sum(stage["cpu"] for stage in seconds.values()),
    )


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
            people = []
            for points, score in zip(points_px[frame, index], scores[frame, index], strict=True):
                if np.isfinite(points).all():
                    people.append({"person_id": [-1], "pose_keypoints_2d": np.column_stack((points, score)).ravel().tolist()})
            (target / f"{camera.name}_{frame:06d}.json").write_text(json.dumps({"version": 1.3, "people": people}))


def _config(frames: int, rate_hz: float) -> str:
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
handle_LR_swap = false
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
