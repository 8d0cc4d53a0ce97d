"""Writes the calibration of the built-in footage anew: `python -m tests.bench.footage.one_person_rig --data build`.

Converts the calibration to the prepared resolution and solves one 2D shift a camera on pictures 0-49 from Thunder's keypoints
of the pupil. Prints the residuals with and without the shifts on pictures 50-99, which the solution has not seen.
"""

import argparse
from pathlib import Path

import cv2
import numpy as np

from edge.cameras.video import load_video
from edge.footage.sets import CALIBRATION, CAMERAS, ONE_PERSON, PACKAGE, VERSION, Footage
from edge.footage.transcode import SIZE_PX
from edge.observe import Networks
from edge.offline import observe_video
from edge.perception.detection import load_person_detector
from edge.perception.pose import load_pose_network
from models.arrays import Float
from models.camera.rig import Rig, encode_rig
from models.messages.observation import Observation, Person
from services.calibration.qualisys import decode_qualisys
from services.calibration.resolution import resized
from services.calibration.shift import residuals_px, solve_shifts

SITES = Path(__file__).parents[3] / "deploy/sites"
SOLVED_ON = slice(0, 50)
REPORTED_ON = slice(50, 100)
CALIBRATED_WIDTH_PX = 1088
SCORE_MIN = 0.3


def calibrated_rig(data: Path, footage: Footage) -> Rig:
    """Qualisys's calibration, at the resolution that it was made in."""
    return decode_qualisys((data / footage.name / CALIBRATION).read_bytes(), CALIBRATION)


def pupil_keypoints(data: Path) -> tuple[Float, Float]:
    """Pixels (frames, cameras, 17, 2) and scores (frames, cameras, 17) of the pupil: who is tallest in the picture."""
    cv2.setNumThreads(1)
    pose, detector = load_pose_network("thunder", data), load_person_detector(data, score_min=0.25)
    networks = Networks(pose, lambda: detector)
    views = [observe_video(load_video(data / ONE_PERSON.name / f"{name}.avi", name), networks, 30.0) for name in CAMERAS]
    pupils = [[_tallest(observation) for observation in view] for view in views]
    points = np.array([[np.full((17, 2), np.nan) if p is None else p.keypoints_px for p in view] for view in pupils], np.float64)
    scores = np.array([[np.zeros(17) if p is None else p.score for p in view] for view in pupils], np.float64)
    return points.swapaxes(0, 1), scores.swapaxes(0, 1)


def _tallest(observation: Observation) -> Person | None:
    return max(observation.persons, key=lambda person: person.crop.side_px, default=None)


def main() -> None:
    """Solve, report and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--data", type=Path, default=Path("build"))
    data: Path = parser.parse_args().data
    rig = Rig(tuple(resized(camera, SIZE_PX) for camera in calibrated_rig(data, ONE_PERSON)))
    write_shifted(rig, *pupil_keypoints(data), ONE_PERSON, Path(__file__).name)


def write_shifted(rig: Rig, points: Float, scores: Float, footage: Footage, tool: str) -> None:
    """Solve the shifts, report what they change, and write the site's calibration; keypoints as `pupil_keypoints` has them."""
    shifts = np.round(solve_shifts(rig, points[SOLVED_ON], scores[SOLVED_ON]), 2)
    to_full = CALIBRATED_WIDTH_PX / SIZE_PX[0]
    for name, used in (("without shifts", rig), ("with shifts", rig.with_shifts(shifts))):
        residuals = residuals_px(used, points[REPORTED_ON], scores[REPORTED_ON]) * to_full
        per_camera = ", ".join(f"{np.nanmedian(residuals[:, i]):.1f}" for i in range(len(rig)))
        print(f"{name}: median {np.nanmedian(residuals):.1f} px of {CALIBRATED_WIDTH_PX} (cameras {per_camera})")
    converted = f"converted to {SIZE_PX[0]}x{SIZE_PX[1]} px by tests/bench/footage/{tool}"
    source = f"{CALIBRATION} of {PACKAGE} {VERSION} (BSD-3-Clause), {converted}"
    (SITES / footage.name / "rig.toml").write_bytes(encode_rig(rig.with_shifts(shifts), source))


if __name__ == "__main__":
    main()
