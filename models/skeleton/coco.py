"""The 17 COCO keypoints: names, order, mirror pairs and limbs.

Source: Lin et al., "Microsoft COCO: Common Objects in Context", ECCV 2014 (keypoint task). Left and right are the
person's own.
"""

from typing import Final

NAMES: Final = (
    "nose",
    "left_eye",
    "right_eye",
    "left_ear",
    "right_ear",
    "left_shoulder",
    "right_shoulder",
    "left_elbow",
    "right_elbow",
    "left_wrist",
    "right_wrist",
    "left_hip",
    "right_hip",
    "left_knee",
    "right_knee",
    "left_ankle",
    "right_ankle",
)
COUNT: Final = len(NAMES)
INDEX: Final = {name: index for index, name in enumerate(NAMES)}

MIRROR: Final = (0, 2, 1, 4, 3, 6, 5, 8, 7, 10, 9, 12, 11, 14, 13, 16, 15)
"""Index of each joint's counterpart on the other side of the body; the nose is its own."""

LIMBS: Final = {
    "left_upper_arm": (5, 7),
    "right_upper_arm": (6, 8),
    "left_forearm": (7, 9),
    "right_forearm": (8, 10),
    "left_thigh": (11, 13),
    "right_thigh": (12, 14),
    "left_shank": (13, 15),
    "right_shank": (14, 16),
}
"""Rigid segments whose length must not change over time: name -> (proximal, distal) joint index."""

TRUNK: Final = (INDEX["left_shoulder"], INDEX["right_shoulder"], INDEX["left_hip"], INDEX["right_hip"])
