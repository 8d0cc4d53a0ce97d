"""Attempts in the stream of frames, as they end: no button, no wait for the next one.

Every frame goes to `Spring` with the performances of all standards, right- and left-handed (`services.evaluation.templates`).
What ends near enough to one of them is a candidate; while it still comes nearer, or while something else that began before is under
way and so far fits better, it is waited for. Then the attempt is over, and nothing that began before its end counts any more.

A sprint and a jog are told apart as all else is: a jog's poses are nearly a run's, but not its speed, which is one of the features.
Of development pupils, no jog came nearer to a run than 0.57, and no run with one fault was further than 0.48.
"""

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from models.arrays import Float
from models.teaching.standard import FRAME_S, Standard
from services.evaluation.alignment import Spring
from services.evaluation.attempt import FoundAttempt
from services.evaluation.features import Features
from services.evaluation.keyframes import AFTER_S, BEFORE_S, in_order, keyframes_of, room_for
from services.evaluation.normalise import mirrored
from services.evaluation.templates import Template, templates_of

_ENDED_S: Final = 0.1
"""What has not come nearer for so long is at its end, also where nothing follows; before, it may be half of something."""


@dataclass(frozen=True)
class FindingConfig:
    """What counts as an attempt.

    Attributes:
        distance: of an attempt from a performance of its standard at most, as a share of a still person's.
        tempo: shortest and longest duration against the performance's.
        wait_s: how long after the best end it must not have come nearer.
        patience_s: how long it is waited at most for something else that is under way.
        under_way: share of it that must have been performed for that.
        better: share of the distance that the other one must keep below.
        seen: share of the joints that must be known in a frame; others are passed over.
        known: share of the joints that must be known on average.
        performances: of each standard that are compared.
    """

    distance: float = 0.53
    tempo: tuple[float, float] = (0.55, 1.8)
    wait_s: float = 0.37
    patience_s: float = 1.5
    under_way: float = 0.35
    better: float = 0.8
    seen: float = 0.5
    known: float = 0.7
    performances: int = 4


DEFAULT: Final = FindingConfig()


@dataclass(frozen=True)
class _Candidate:
    """Something that may be an attempt; `start` and `end` are numbers of frames."""

    template: int
    start: int
    end: int
    distance: float


class AttemptFinder:
    """Fed frame by frame; gives an attempt once it is over."""

    def __init__(self, standards: Sequence[Standard], frame_s: float = FRAME_S, config: FindingConfig = DEFAULT) -> None:
        self._standards, self._frame_s, self._config = tuple(standards), frame_s, config
        self._all = tuple(template for standard in self._standards for template in templates_of(standard, config.performances))
        longest_s = max(len(template.features) for template in self._all) * FRAME_S * config.tempo[1]
        self._remembered = math.ceil((BEFORE_S + longest_s + config.patience_s) / frame_s) + 1
        self._fewest = room_for(frame_s)
        self._activity: str | None = None
        self._candidate: _Candidate | None = None
        self._look_for(self._all)
        self.reset()

    def choose(self, activity: str | None) -> None:
        """Look for this action only, or for all. If that is a change, what began before has no part any more: `finish` it first.

        Raises:
            ValueError: there is no standard of it.
        """
        asked = tuple(template for template in self._all if activity in {None, template.action})
        if not asked:
            raise ValueError(f"there is no standard of '{activity}'")
        if activity != self._activity:
            self._activity, self._candidate = activity, None
            self._look_for(asked)
            self._spring.reset(self._count)

    def finish(self) -> FoundAttempt | None:
        """The attempt that was about to be decided on, with its keyframes: what follows has nothing to do with it."""
        candidate, self._candidate = self._candidate, None
        if candidate is None or self._waited_s(candidate) < _ENDED_S - 1e-6:
            return None
        self._spring.forget(candidate.end)
        return self._found(candidate, self._newest_s)

    def reset(self) -> None:
        """The stream begins anew."""
        self._spring.reset()
        self._features = Features(self._frame_s)
        self._recent: deque[Float] = deque(maxlen=self._remembered)
        # Share of the joints that are known, summed over the frames until before each, and until the newest one.
        self._known: deque[float] = deque((0.0,), maxlen=self._remembered + 1)
        self._motion = _Motion(self._frame_s)
        self._count = 0
        self._newest_s = 0.0
        self._candidate = None

    def _look_for(self, templates: tuple[Template, ...]) -> None:
        self._templates = templates
        self._spring = Spring([template.features for template in templates])
        self._still = np.array([template.still[-1] for template in templates])

    @property
    def state(self) -> Literal["waiting", "moving"]:
        """Whether the pupil moves."""
        return "moving" if self._motion.moves else "waiting"

    def push(self, joints_m: Float, t_s: float) -> FoundAttempt | None:
        """Take the next frame, as `advance` does; the attempt that is over then, as `finish` tells it."""
        return self.finish() if self.advance(joints_m, t_s) else None

    def advance(self, joints_m: Float, t_s: float) -> bool:
        """Take the next frame.

        Args:
            joints_m: (17, 3) in the world; NaN where unknown.
            t_s: its instant, one frame after the last one's.

        Returns:
            Whether an attempt is over: `finish` it before the next frame.
        """
        self._recent.append(joints_m)
        self._motion.push(joints_m)
        features = self._features.push(joints_m)
        known = float(np.isfinite(features[:, 0]).mean())
        self._known.append(known + self._known[-1])
        self._count += 1
        self._newest_s = t_s
        if known >= self._config.seen:
            self._spring.push(features)
            self._consider()
        else:
            self._spring.skip()
        return self._candidate is not None and self._is_over(self._candidate)

    def _consider(self) -> None:
        """Whether a performance that ends with the newest frame is the best candidate."""
        config, now = self._config, self._count - 1
        starts, lengths = self._spring.starts, self._spring.lengths
        tempo = (now - starts + 1) * self._frame_s / (lengths * FRAME_S)
        distances = np.sqrt(self._spring.costs / self._still)
        fits = (distances < config.distance) & (tempo > config.tempo[0]) & (tempo < config.tempo[1])
        if self._candidate is not None:
            fits &= (distances < self._candidate.distance) & (starts <= self._candidate.end)
        for template in np.flatnonzero(fits)[np.argsort(distances[fits])]:
            start = int(starts[template])
            if now - start + 1 >= self._fewest and self._known_share(start) >= config.known:
                self._candidate = _Candidate(int(template), start, now, float(distances[template]))
                return

    def _known_share(self, start: int) -> float:
        """Of the joints, from a frame to the newest one."""
        frames = self._count - start
        if frames >= len(self._known):
            return 0.0
        return (self._known[-1] - self._known[-1 - frames]) / frames

    def _is_over(self, candidate: _Candidate) -> bool:
        waited_s = self._waited_s(candidate)
        if waited_s < self._config.wait_s - 1e-6:
            return False
        return waited_s >= self._config.patience_s or not self._is_surpassed(candidate)

    def _waited_s(self, candidate: _Candidate) -> float:
        return (self._count - 1 - candidate.end) * self._frame_s

    def _is_surpassed(self, candidate: _Candidate) -> bool:
        """Whether what began before the candidate's end is under way, and so far fits better."""
        config = self._config
        most = (config.better * candidate.distance) ** 2
        for number, (costs, starts) in enumerate(self._spring.ahead()):
            first = int(config.under_way * len(costs))
            nearer = costs[first:] < most * self._templates[number].still[first:]
            if (nearer & (starts[first:] <= candidate.end)).any():
                return True
        return False

    def _found(self, candidate: _Candidate, now_s: float) -> FoundAttempt:
        """With its keyframes, or, where they are not to be seen, with the template's."""
        template = self._templates[candidate.template]
        newest = self._count - 1
        oldest = newest - len(self._recent) + 1
        first = max(candidate.start - round(BEFORE_S / self._frame_s), oldest)
        last = min(candidate.end + round(AFTER_S / self._frame_s), newest)
        joints = np.array([self._recent[number - oldest] for number in range(first, last + 1)])
        if template.handed == "left":
            joints = mirrored(joints)
        frames = keyframes_of(joints, self._frame_s, self._standards, template.action)
        timed = frames is not None
        if frames is None:
            pace = (candidate.end - candidate.start) / (len(template.features) - 1)
            frames = in_order(candidate.start - first + pace * template.keyframes, len(joints), self._frame_s)
        start, exertion, peak, end = (now_s - (newest - first - float(frame)) * self._frame_s for frame in frames)
        return FoundAttempt(template.action, template.handed, (start, exertion, peak, end), timed)


class _Motion:
    """Whether a pupil moves: most of a quarter of his joints do, over a fifth of a second."""

    _SPAN_S: Final = 0.2
    _STARTS_M_S: Final = 0.35
    _STOPS_M_S: Final = 0.2

    def __init__(self, frame_s: float) -> None:
        self._places: deque[Float] = deque(maxlen=max(round(self._SPAN_S / frame_s), 1) + 1)
        self._span_s = frame_s * max(round(self._SPAN_S / frame_s), 1)
        self.moves = False

    def push(self, joints_m: Float) -> None:
        """Take the next frame."""
        self._places.append(joints_m)
        speeds = np.linalg.norm(joints_m - self._places[0], axis=1) / self._span_s
        speeds = speeds[np.isfinite(speeds)]
        if len(speeds):
            fast = float(np.sort(speeds)[(3 * len(speeds)) // 4])
            self.moves = fast > (self._STOPS_M_S if self.moves else self._STARTS_M_S)
