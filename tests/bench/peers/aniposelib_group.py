"""aniposelib 0.8.0 on our keypoints: hands it arrays, runs it in its environment, takes its joints back.

It is the library under Anipose, so its settings are the library's defaults and those of the program Anipose 1.1. Limbs are its
constraints, the trunk's sides its weak ones. Keypoints of a score below 0.3 are withheld, as its tutorial does with a threshold.
Coordinates are metres, the calibration is given without distortion.
"""

import json
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from models.arrays import Float
from tests.bench.peers.answer import Answer, Keypoints
from tests.bench.peers.environment import environment_of, run_in

NAME = "aniposelib"
ENVIRONMENT = environment_of(NAME)
MIN_SCORE = 0.3
SETTINGS = {
    "plain": "`triangulate`: linear, all views",
    "ransac": "`triangulate_ransac`: of the subsets of at least 3 views the one with least error, as Anipose calls it",
    "optim_library": "`triangulate_optim` with the library's defaults: smooth 4 (1st difference), length 2, weak length 0.5, 15 px",
    "optim_anipose": "`triangulate_optim` with Anipose's defaults: smooth 2 (3rd difference), length 2, weak length 1, 5 px",
    "optim_ransac": "the same from RANSAC's points (`ransac = true`, `optim = true`)",
}
_STAGES = {
    "plain": ("plain",),
    "ransac": ("ransac",),
    "optim_library": ("plain", "optim_library"),
    "optim_anipose": ("plain", "optim_anipose"),
    "optim_ransac": ("ransac", "optim_ransac"),
}


def run_aniposelib(folder: Path, clips: Sequence[Keypoints], settings: Sequence[str] = tuple(SETTINGS)) -> list[list[Answer]]:
    """Reconstruct clips in some settings.

    Args:
        folder: an empty folder to work in.
        clips: keypoints, without distortion.
        settings: of `SETTINGS`.
    """
    arguments = [",".join(settings)]
    for number, clip in enumerate(clips):
        source, target = folder / f"{number}.npz", folder / f"{number}-found.npz"
        np.savez(source, **_arrays(clip))  # type: ignore[arg-type]  # the stub takes `allow_pickle` for any of them
        arguments += [str(source), str(target)]
    times = json.loads(run_in(NAME, arguments))
    answers = []
    for clip, file, seconds in zip(clips, arguments[2::2], times, strict=True):
        with np.load(file) as found:
            answers.append([_answer(setting, found[setting], seconds, len(clip)) for setting in settings])
    return answers


def _answer(setting: str, joints_m: Float, seconds: dict[str, dict[str, float]], frames: int) -> Answer:
    cpu_ms, wall_ms = (1e3 * sum(seconds[stage][clock] for stage in _STAGES[setting]) / frames for clock in ("cpu", "wall"))
    return Answer(f"{NAME}.{setting}", joints_m, cpu_ms, wall_ms)


def _arrays(clip: Keypoints) -> dict[str, Float]:
    points = np.where(clip.scores[..., None] >= MIN_SCORE, clip.points_px * clip.scale, np.nan)
    matrices = np.stack([camera.matrix_px * clip.scale for camera in clip.rig])
    matrices[:, 2, 2] = 1.0
    return {
        "points": points.swapaxes(0, 1),
        "names": np.array(clip.rig.names),
        "matrices": matrices,
        "sizes": np.array([camera.size_px for camera in clip.rig]) * clip.scale,
        "rvecs": np.stack([cv2.Rodrigues(camera.rotation)[0].ravel() for camera in clip.rig]),
        "tvecs": np.stack([camera.translation_m for camera in clip.rig]),
    }
