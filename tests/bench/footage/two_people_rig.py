"""Writes the calibration of the second built-in footage anew: `python -m tests.bench.footage.two_people_rig --data build`.

The second person was rendered into the first footage's views, which were moved and scaled by up to 0.8 % on the way. How is known
from matching ORB features of both footages (2,000 matches a view, RANSAC at 2 px, the same on pictures 0, 50 and 90):
`PUBLISHED` puts that into each camera's matrix. What is left is one 2D shift a camera, as for the first footage, solved on
pictures 0-49 from Thunder's keypoints of the pupil, who is told from the woman by being fused.
"""

import argparse
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from edge.footage.sets import TWO_PEOPLE
from edge.footage.transcode import SIZE_PX
from models.camera.pinhole import Camera
from models.camera.rig import Rig
from services.calibration.resolution import resized
from tests.bench.footage.one_person_rig import calibrated_rig, write_shifted
from tests.bench.footage.run import load_videos, look, pupil_keypoints
from tests.bench.reconstruct.fused import fuse
from tests.bench.reconstruct.observed import RATE_HZ

PUBLISHED = {
    "cam01": (0.9963, 0.5, 0.0),
    "cam02": (0.9926, -0.7, 7.3),
    "cam03": (1.0036, -1.6, -12.0),
    "cam04": (1.0, -0.3, 0.4),
}
"""Scale and offset (px of 1088) from a calibrated picture to the published one."""


def as_published(camera: Camera) -> Camera:
    """The camera that would have taken the published pictures."""
    scale, right, down = PUBLISHED[camera.name]
    matrix = camera.matrix_px.copy()
    matrix[:2] *= scale
    matrix[:2, 2] += right, down
    return replace(camera, matrix_px=matrix)


def main() -> None:
    """Solve, report and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--data", type=Path, default=Path("build"))
    data: Path = parser.parse_args().data
    cv2.setNumThreads(1)
    rig = Rig(tuple(resized(as_published(camera), SIZE_PX) for camera in calibrated_rig(data, TWO_PEOPLE)))
    videos = load_videos(rig, data, TWO_PEOPLE)
    events = look(rig, videos, data, RATE_HZ)
    found = fuse(rig, events, len(videos[0].pictures) / RATE_HZ)
    points, scores = pupil_keypoints(rig, events, found.smooth_m)
    write_shifted(rig, points, np.nan_to_num(scores), TWO_PEOPLE, Path(__file__).name)


if __name__ == "__main__":
    main()
