"""The 17 COCO keypoints and three points of each foot, as networks for whole bodies give them.

Source: Jin et al., "Whole-Body Human Pose Estimation in the Wild", ECCV 2020 (COCO-WholeBody: its first 23 points).
"""

from typing import Final

from models.skeleton import coco

NAMES: Final = (
    *coco.NAMES,
    "left_big_toe",
    "left_small_toe",
    "left_heel",
    "right_big_toe",
    "right_small_toe",
    "right_heel",
)
COUNT: Final = len(NAMES)
INDEX: Final = {name: index for index, name in enumerate(NAMES)}

MIRROR: Final = (*coco.MIRROR, 20, 21, 22, 17, 18, 19)
"""Index of each point's counterpart on the other side of the body."""
