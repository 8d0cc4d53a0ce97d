"""The 24 joints of the SMPL body: names, order, tree and mirror pairs.

Source: Loper et al., "SMPL: A Skinned Multi-Person Linear Model", ACM Trans. Graphics 34(6), 2015. The names are those that
the field uses; `left_hip` is the joint that turns the left thigh. Left and right are the person's own.
"""

from typing import Final

NAMES: Final = (
    "pelvis",
    "left_hip",
    "right_hip",
    "spine1",
    "left_knee",
    "right_knee",
    "spine2",
    "left_ankle",
    "right_ankle",
    "spine3",
    "left_foot",
    "right_foot",
    "neck",
    "left_collar",
    "right_collar",
    "head",
    "left_shoulder",
    "right_shoulder",
    "left_elbow",
    "right_elbow",
    "left_wrist",
    "right_wrist",
    "left_hand",
    "right_hand",
)
COUNT: Final = len(NAMES)
INDEX: Final = {name: index for index, name in enumerate(NAMES)}

PARENTS: Final = (-1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19, 20, 21)
"""Index of the joint that carries each joint; every parent stands before its children. The pelvis is carried by none."""

MIRROR: Final = (0, 2, 1, 3, 5, 4, 6, 8, 7, 9, 11, 10, 12, 14, 13, 15, 17, 16, 19, 18, 21, 20, 23, 22)
"""Index of each joint's counterpart on the other side of the body; joints of the spine are their own."""
