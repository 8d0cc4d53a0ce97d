"""A stretch of smooth motion on an even grid of time: what everything in this folder measures."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from models.arrays import Bool, Float, UInt8
from models.messages.motion import JointState, Motion
from models.skeleton import coco

_OFF_GRID = 0.25
"""A motion may lie so many frames beside the grid before it is refused."""


@dataclass(frozen=True, eq=False)
class Track:
    """Joints of one pupil, frame by frame. What is not known is NaN, and stays so in all that is measured from it.

    Attributes:
        t_s: (T,) instants, evenly spaced, CLOCK_MONOTONIC seconds or seconds from wherever a recording begins.
        joints_m: (T, 17, 3) COCO points in the world (right-handed, z up), metres; NaN where unknown.
        covariance_m2: (T, 17, 3, 3) their covariance; NaN where unknown.
        states: (T, 17) `JointState`.
    """

    t_s: Float
    joints_m: Float
    covariance_m2: Float
    states: UInt8

    def __post_init__(self) -> None:
        count = len(self.t_s)
        shapes = {"joints_m": (count, coco.COUNT, 3), "covariance_m2": (count, coco.COUNT, 3, 3), "states": (count, coco.COUNT)}
        for name, shape in shapes.items():
            if getattr(self, name).shape != shape:
                raise ValueError(f"{name} of a track of {count} frames has the shape {shape}, not {getattr(self, name).shape}")
        steps = np.diff(self.t_s)
        if count > 1 and not (steps > 0).all():
            raise ValueError("the frames of a track follow one another in time")
        if count > 2 and np.ptp(steps) > 0.01 * steps[0]:
            raise ValueError(f"the frames of a track are evenly spaced, not {steps.min():.4f} to {steps.max():.4f} s apart")

    def __len__(self) -> int:
        return len(self.t_s)

    @property
    def frame_s(self) -> float:
        """From one frame to the next; 0 for fewer than two."""
        return float(self.t_s[1] - self.t_s[0]) if len(self) > 1 else 0.0

    @property
    def seen(self) -> Bool:
        """(T, 17) where two views or more agreed: only that may be judged."""
        return np.asarray(self.states == JointState.SEEN)

    def part(self, first: int, end: int) -> "Track":
        """Frames `first` to `end` - 1; views of the same arrays."""
        kept = slice(first, end)
        return Track(self.t_s[kept], self.joints_m[kept], self.covariance_m2[kept], self.states[kept])

    def hidden(self) -> "Track":
        """As long, of somebody of whom nothing is known."""
        unknown = np.full_like(self.states, JointState.UNKNOWN)
        return Track(self.t_s, np.full_like(self.joints_m, np.nan), np.full_like(self.covariance_m2, np.nan), unknown)

    def frame_at(self, t_s: float) -> float:
        """The place of an instant among the frames, in frames; also between two of them, and beyond the ends."""
        return (t_s - float(self.t_s[0])) / self.frame_s if len(self) > 1 else 0.0


def known_track(joints_m: Float, frame_s: float, sigma_m: float = 0.0) -> Track:
    """A motion whose every joint (T, 17, 3) is known, from time 0: truth, a standard, an imported file. NaN is unknown."""
    known: Bool = np.asarray(np.isfinite(joints_m).all(axis=2))
    states = np.where(known, JointState.SEEN, JointState.UNKNOWN).astype(np.uint8)
    covariance = np.broadcast_to(sigma_m**2 * np.eye(3), (*joints_m.shape, 3))
    return Track(
        np.arange(len(joints_m), dtype=np.float64) * frame_s,
        np.where(known[..., None], joints_m, np.nan),
        np.where(known[..., None, None], covariance, np.nan),
        states,
    )


def track_of(motions: Sequence[Motion], frame_s: float) -> Track:
    """Smooth motions of one epoch, in the order of time, with unknown frames where some are missing.

    Raises:
        ValueError: they are none, are of several epochs, or do not lie on a grid of `frame_s`.
    """
    if not motions or len({motion.epoch for motion in motions}) != 1:
        raise ValueError("a track is of motions of one epoch, at least one")
    first_ns = motions[0].t_ns
    places = np.array([(motion.t_ns - first_ns) * 1e-9 / frame_s for motion in motions])
    frames = np.rint(places).astype(np.int64)
    if (np.diff(frames) < 1).any() or np.abs(places - frames).max() > _OFF_GRID:
        raise ValueError(f"motions of a track follow one another on a grid of {1e3 * frame_s:g} ms")
    count = int(frames[-1]) + 1
    joints = np.full((count, coco.COUNT, 3), np.nan)
    covariance = np.full((count, coco.COUNT, 3, 3), np.nan)
    states = np.full((count, coco.COUNT), JointState.UNKNOWN, np.uint8)
    for frame, motion in zip(frames, motions, strict=True):
        known = motion.states != JointState.UNKNOWN
        joints[frame, known], covariance[frame, known] = motion.joints_m[known], motion.covariance_m2[known]
        states[frame] = motion.states
    t_s = first_ns * 1e-9 + np.arange(count, dtype=np.float64) * frame_s
    return Track(t_s, joints, covariance, states)
