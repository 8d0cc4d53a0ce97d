"""The newest smooth motion, on an even grid of time: what is missing is unknown, and after a longer gap all begins anew."""

from collections import deque
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.messages.feedback import MAX_FRAMES
from models.messages.motion import JointState, Motion
from models.skeleton import coco
from models.teaching.standard import FRAME_S
from services.evaluation.config import EvaluationConfig
from services.evaluation.track import Track

KEPT_S: Final = MAX_FRAMES * FRAME_S
"""All that can be told of as one attempt: longer than anything that is taught as one movement
(`models.teaching.standard.LONGEST_S`), performed as slowly as counts, with what is before and after it."""
LONGEST_GAP_S: Final = 0.5
"""Nobody knows what the pupil did in a longer one: the stream begins anew."""
FARTHEST_M: Final = 100.0
"""No gym is larger: who is further away, or known less well than that, is nowhere."""


@dataclass(frozen=True, eq=False)
class Frame:
    """One instant.

    Attributes:
        number: counts the frames since the stream began.
        joints_m: (17, 3) NaN where unknown.
        covariance_m2: (17, 3, 3) likewise.
        states: (17,) `JointState`.
    """

    number: int
    joints_m: Float
    covariance_m2: Float
    states: "np.ndarray[tuple[int], np.dtype[np.uint8]]"


@dataclass(eq=False)
class Stream:
    """Attributes:
    epoch, sequence, t_ns: of the newest motion.
    missed: motions that fusion gave out and that never came, since the start.
    frames: the newest of them, without those that are missing.
    """

    epoch: int = -1
    sequence: int = -1
    t_ns: int = -1
    missed: int = 0
    frames: deque[Frame] = field(default_factory=deque)

    def goes_on(self, motion: Motion, config: EvaluationConfig) -> bool:
        """Whether the next motion is of this stream, and not the beginning of another one."""
        ahead, in_time = self._ahead(motion, config)
        return in_time and ahead <= LONGEST_GAP_S / config.frame_s

    def take(self, motion: Motion, config: EvaluationConfig) -> list[Frame]:
        """Take in the next motion: its frame, with an unknown one before it for each that is missing."""
        goes_on = self.goes_on(motion, config)
        ahead, in_time = self._ahead(motion, config)
        if in_time:
            self.missed += ahead - 1
        self.epoch, self.sequence, self.t_ns = motion.epoch, motion.sequence, motion.t_ns
        if not goes_on:
            self.frames.clear()
            self.frames.append(_frame(0, motion))
            return [self.newest]
        last = self.frames[-1].number
        new = [*(_unknown(last + each) for each in range(1, ahead)), _frame(last + ahead, motion)]
        self.frames.extend(new)
        while len(self.frames) > KEPT_S / config.frame_s:
            self.frames.popleft()
        return new

    @property
    def newest(self) -> Frame:
        """The frame of the newest motion; IndexError before the first."""
        return self.frames[-1]

    def track(self, from_s: float, to_s: float, frame_s: float) -> Track:
        """What is kept of a stretch of the stream's time, of which frame 0 is at 0; ValueError if that is nothing."""
        kept = [frame for frame in self.frames if from_s <= frame.number * frame_s <= to_s]
        if not kept:
            raise ValueError(f"nothing is kept of {from_s:.2f} to {to_s:.2f} s")
        return Track(
            np.array([frame.number for frame in kept]) * frame_s,
            np.stack([frame.joints_m for frame in kept]),
            np.stack([frame.covariance_m2 for frame in kept]),
            np.stack([frame.states for frame in kept]),
        )

    def _ahead(self, motion: Motion, config: EvaluationConfig) -> tuple[int, bool]:
        """By how many frames a motion is ahead of the newest one as its number says, and whether its time says the same."""
        ahead = motion.sequence - self.sequence
        passed = (motion.t_ns - self.t_ns) * 1e-9 * config.speed / config.frame_s
        return ahead, motion.epoch == self.epoch and bool(self.frames) and ahead > 0 and abs(passed - ahead) <= config.slack_frames


def _frame(number: int, motion: Motion) -> Frame:
    joints, covariance = motion.joints_m.astype(np.float64), motion.covariance_m2.astype(np.float64)
    known = (motion.states != JointState.UNKNOWN) & _somewhere(joints, covariance)
    return Frame(
        number,
        np.where(known[:, None], joints, np.nan),
        np.where(known[:, None, None], covariance, np.nan),
        np.where(known, motion.states, JointState.UNKNOWN).astype(np.uint8),
    )


def _somewhere(joints_m: Float, covariance_m2: Float) -> Bool:
    """(17,) whether a joint is in the gym, and known at least that well."""
    variances = np.diagonal(covariance_m2, axis1=1, axis2=2)
    bounded = (np.abs(covariance_m2) <= FARTHEST_M**2).all(axis=(1, 2))
    return np.asarray((np.abs(joints_m) <= FARTHEST_M).all(axis=1) & bounded & (variances >= 0).all(axis=1))


def _unknown(number: int) -> Frame:
    nothing = np.full((coco.COUNT, 3, 3), np.nan)
    return Frame(number, nothing[:, 0], nothing, np.full(coco.COUNT, JointState.UNKNOWN, np.uint8))
