"""Where a pose network's points lie on the body, against the body's own COCO points: the landmark bias.

Written by `python -m tests.bench.networks --data build --corrections`, from 5 simulated development pupils who perform every
action; do not edit by hand. Of each COCO point: front, left and up in the axes of its segment
(`models.skeleton.segment_axes`), over the length of the trunk. Fusion takes it off if `FusionConfig.landmark_bias` says so.
"""

from typing import Final

THUNDER: Final = (
    (-0.0068, 0.0, -0.0043),  # nose
    (-0.0028, -0.0071, -0.005),  # left_eye
    (-0.0028, 0.0071, -0.005),  # right_eye
    (-0.0041, -0.0109, -0.0003),  # left_ear
    (-0.0041, 0.0109, -0.0003),  # right_ear
    (-0.0174, -0.0016, 0.0047),  # left_shoulder
    (-0.0174, 0.0016, 0.0047),  # right_shoulder
    (-0.0074, 0.0052, 0.0046),  # left_elbow
    (-0.0074, -0.0052, 0.0046),  # right_elbow
    (-0.0072, 0.0067, 0.0084),  # left_wrist
    (-0.0072, -0.0067, 0.0084),  # right_wrist
    (0.0009, 0.009, 0.0155),  # left_hip
    (0.0009, -0.009, 0.0155),  # right_hip
    (0.0208, -0.0073, 0.0044),  # left_knee
    (0.0208, 0.0073, 0.0044),  # right_knee
    (-0.0031, 0.004, 0.0099),  # left_ankle
    (-0.0031, -0.004, 0.0099),  # right_ankle
)
