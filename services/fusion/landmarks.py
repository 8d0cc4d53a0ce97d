"""From where the pose network's points lie on the body to the body's own COCO points: the landmark bias is taken off.

A network puts a hip where people clicked hips in pictures, which is not where a body has it. On the body that difference is nearly
the same in all views and poses (`services.fusion.landmark_bias`), so it can be taken off joints in space.
"""

from dataclasses import replace

import numpy as np

from models.arrays import Float
from models.messages.motion import JointState
from models.skeleton.segment_axes import segment_axes, trunk_length_m
from services.fusion.verdict import Pose


def corrected(pose: Pose, bias: Float) -> Pose:
    """A pose without the bias.

    Args:
        pose: as fused.
        bias: (17, 3) in (front, left, up) of each point's segment, over the trunk's length.

    Returns:
        The pose with those joints moved whose segment's axes are known; the others stay where they were.
    """
    known = (pose.states != JointState.UNKNOWN)[:, None]
    points = np.where(known, pose.joints_m, np.nan)
    offset = trunk_length_m(points) * np.einsum("jik,jk->ji", segment_axes(points), bias)
    return replace(pose, joints_m=np.where(np.isfinite(offset) & known, pose.joints_m - offset, pose.joints_m))
