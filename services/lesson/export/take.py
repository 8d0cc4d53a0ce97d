"""What is exported: a stretch of motion, whose it is, and the attempts in it."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from models.arrays import Bool, Float
from models.messages.motion import JointState
from services.evaluation.attempt import PHASES, FoundAttempt
from services.evaluation.track import Track
from services.lesson.export.holding import told
from services.lesson.export.labels import LABELS


class TakeError(ValueError):
    """Why a motion cannot be exported, in words that go on after the name of its file."""


@dataclass(frozen=True)
class Keyframe:
    """An instant of an attempt.

    Attributes:
        action: name of the attempt's action.
        attempt: counts the attempts of the take from 1.
        phase: as in `services.evaluation.attempt.PHASES`.
        t_s: seconds from the first frame.
    """

    action: str
    attempt: int
    phase: str
    t_s: float


@dataclass(frozen=True, eq=False)
class Take:
    """A motion with at least two frames, in which something is known, and everything that is known is finite.

    Attributes:
        track: the motion.
        name: of the file that it goes into, without folder and suffix.
        pupil: code of the pupil; empty if nobody is named.
        attempts: found in the track, in their order, on its clock.

    Raises:
        TakeError: the track is too short, empty, broken, or an attempt lies outside of it.
    """

    track: Track
    name: str
    pupil: str = ""
    attempts: tuple[FoundAttempt, ...] = ()
    keyframes: tuple[Keyframe, ...] = field(init=False)

    def __post_init__(self) -> None:
        if len(self.track) < 2:
            raise TakeError("has fewer than two frames; nothing moves in it")
        if not self.known.any():
            raise TakeError("has no frame in which a joint is known")
        broken = np.argwhere(self.known & ~np.isfinite(self.track.joints_m).all(axis=2))
        if len(broken):
            frame, joint = (int(index) for index in broken[0])
            raise TakeError(f"is broken: joint {joint} is said to be known in frame {frame + 1} and is no finite number")
        object.__setattr__(self, "keyframes", tuple(self._keyframes()))

    @property
    def known(self) -> Bool:
        """(T, 17) where there is a position."""
        return np.asarray(self.track.states != JointState.UNKNOWN)

    @property
    def joints_m(self) -> Float:
        """(T, 17, 3), NaN where unknown."""
        return np.where(self.known[..., None], self.track.joints_m, np.nan)

    @property
    def rate_hz(self) -> float:
        """Frames a second, without what rounding of the clock left behind the sixth digit."""
        times = self.track.t_s
        return float(f"{(len(times) - 1) / float(times[-1] - times[0]):.6g}")

    @property
    def seconds(self) -> Float:
        """(T,) of the frames, from the first."""
        return np.arange(len(self.track)) / self.rate_hz

    def about(self) -> dict[str, Any]:
        """What is known beside the motion, for formats and files that take JSON. Frames are counted from 1, the last is with it."""
        guessed = self.track.states == JointState.GUESSED
        return {
            "source": "KineBox",
            "pupil": self.pupil,
            "rate_hz": self.rate_hz,
            "frames": len(self.track),
            "attempts": [
                {
                    "action": attempt.action,
                    "handed": attempt.handed,
                    "keyframes_s": {key.phase: round(key.t_s, 6) for key in self.keyframes if key.attempt == number},
                }
                for number, attempt in enumerate(self.attempts, start=1)
            ],
            "guessed_frames": told({label: guessed[:, joint] for joint, label in enumerate(LABELS)}),
        }

    def _keyframes(self) -> list[Keyframe]:
        first, last = float(self.track.t_s[0]), float(self.track.t_s[-1])
        found = []
        for number, attempt in enumerate(self.attempts, start=1):
            if not first <= attempt.moments_s[0] < attempt.moments_s[-1] <= last:
                raise TakeError(f"does not hold the whole of its attempt {number}, {attempt.action}")
            moments = zip(PHASES, attempt.moments_s, strict=True)
            found += [Keyframe(attempt.action, number, phase, moment - first) for phase, moment in moments]
        return found
