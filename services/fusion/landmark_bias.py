"""Where a pose network's points lie on the body, against the body's own COCO points: the landmark bias.

Written by `python -m tests.bench.networks --data build --corrections`, from 2 simulated development pupils who perform every
action; do not edit by hand. Of each COCO point: front, left and up in the axes of its segment
(`models.skeleton.segment_axes`), over the length of the trunk. Fusion takes it off if `FusionConfig.landmark_bias` says so.
"""

from typing import Final

THUNDER: Final = (
    (-0.0042, 0.0, -0.0085),  # nose
    (-0.0007, -0.0061, -0.0085),  # left_eye
    (-0.0007, 0.0061, -0.0085),  # right_eye
    (-0.008, -0.0042, -0.0002),  # left_ear
    (-0.008, 0.0042, -0.0002),  # right_ear
    (-0.0201, -0.0044, 0.0041),  # left_shoulder
    (-0.0201, 0.0044, 0.0041),  # right_shoulder
    (-0.008, 0.0118, 0.0074),  # left_elbow
    (-0.008, -0.0118, 0.0074),  # right_elbow
    (-0.0062, 0.0031, 0.0107),  # left_wrist
    (-0.0062, -0.0031, 0.0107),  # right_wrist
    (-0.0054, 0.0112, 0.0225),  # left_hip
    (-0.0054, -0.0112, 0.0225),  # right_hip
    (0.0313, -0.0075, 0.0201),  # left_knee
    (0.0313, 0.0075, 0.0201),  # right_knee
    (-0.0027, 0.0011, 0.0172),  # left_ankle
    (-0.0027, -0.0011, 0.0172),  # right_ankle
)
