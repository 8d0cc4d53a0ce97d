"""What of a frame is compared with the standards while the pupil still moves: nothing here waits for a later frame.

A posture counts as the pupil himself would tell it: turned to where he faces, from the middle of his hips, in his own size, heights
from the floor. How fast he goes counts as one joint more, which lies where the hips would be after `AHEAD_S`: jogging and a sprint
are alike in all but that.
"""

from collections import deque
from typing import Final

import numpy as np

from models.arrays import Float
from models.skeleton import coco
from services.evaluation.normalise import MIRROR_FLIP, facing, root_m

JOINTS: Final = tuple(coco.INDEX[name] for name in coco.NAMES if name == "nose" or name.partition("_")[2] not in {"", "eye", "ear"})
"""One point of the head, shoulders, elbows, wrists, hips, knees and ankles."""
COUNT: Final = len(JOINTS) + 1
AHEAD_S: Final = 0.2
_SPAN_S: Final = 0.1
"""Over which the speed is taken."""
_REMEMBERED_S: Final = 4.0
"""Of how much of the past the size is the median."""
_UPPER: Final = np.array([[coco.INDEX[f"{side}_{name}"] for name in ("shoulder", "hip", "knee")] for side in ("left", "right")])
_LOWER: Final = np.array([[coco.INDEX[f"{side}_{name}"] for name in ("hip", "knee", "ankle")] for side in ("left", "right")])
_MIRROR: Final = [*(JOINTS.index(coco.MIRROR[joint]) for joint in JOINTS), COUNT - 1]
_FORGOTTEN_S: Final = 1.0
"""Whoever comes after nobody was there for so long may be another pupil."""
_SIZE_EVERY: Final = 5
"""Frames after which the size is found anew."""


class Features:
    """Takes frame after frame of one pupil; keeps where he faced while his trunk was upright, and how tall he is."""

    def __init__(self, frame_s: float) -> None:
        self._span = max(round(_SPAN_S / frame_s), 1)
        self._ahead = AHEAD_S / (self._span * frame_s)
        self._sizes: deque[Float] = deque(maxlen=max(round(_REMEMBERED_S / frame_s / _SIZE_EVERY), 1))
        self._roots: deque[Float] = deque(maxlen=self._span + 1)
        self._facing = np.full(2, np.nan)
        self._size = np.nan
        self._count = 0
        self._gone, self._gone_at_most = 0, round(_FORGOTTEN_S / frame_s)

    def push(self, joints_m: Float) -> Float:
        """(COUNT, 3) of the next frame, (17, 3) joints in the world; NaN where unknown, everywhere until he is seen upright."""
        self._gone = 0 if np.isfinite(joints_m).any() else self._gone + 1
        if self._gone == self._gone_at_most:
            self._sizes.clear()
            self._size, self._facing = np.nan, np.full(2, np.nan)
        if self._count % _SIZE_EVERY == 0 or not self._size > 0:
            self.measure(joints_m)
        self._count += 1
        ahead = facing(joints_m)
        if not np.isnan(ahead[0]):
            self._facing = ahead
        root = root_m(joints_m)
        self._roots.append(root)
        x, y = self._facing
        turn = np.array(((x, y, 0.0), (-y, x, 0.0), (0.0, 0.0, 1.0))) / self._size
        out = np.empty((COUNT, 3))
        out[:-1] = (joints_m[JOINTS, :] - (root[0], root[1], 0.0)) @ turn.T
        moved = root - self._roots[0] if len(self._roots) > self._span else np.full(3, np.nan)
        out[-1] = turn @ (moved * self._ahead)
        return out

    def measure(self, joints_m: Float) -> None:
        """Learn from a frame how tall the pupil is; `push` does so by itself."""
        lengths = np.linalg.norm(joints_m[_UPPER] - joints_m[_LOWER], axis=-1)
        one = np.where(np.isnan(lengths[0]), lengths[1], np.where(np.isnan(lengths[1]), lengths[0], lengths.mean(axis=0)))
        if not np.isnan(one).any():
            self._sizes.append(one)
            size = float(np.median(np.array(self._sizes), axis=0).sum())
            self._size = size if size > 0 else np.nan


def features_of(joints_m: Float, frame_s: float) -> Float:
    """(T, COUNT, 3) of a whole performance, as a stream would give them that knew the pupil's size from the beginning."""
    features = Features(frame_s)
    for joints in joints_m[::_SIZE_EVERY]:
        features.measure(joints)
    return np.stack([features.push(joints) for joints in joints_m])


def mirrored_features(features: Float) -> Float:
    """(..., COUNT, 3) of who does with the left what these do with the right; bit for bit those of the mirrored motion."""
    return np.asarray(features[..., _MIRROR, :] * MIRROR_FLIP)
