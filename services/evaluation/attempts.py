"""Attempts in the stream of frames, as they end: no button, no wait for the next one.

Every frame goes to `Spring` with the performances of all standards, right- and left-handed. How far a performance in the stream is
from one of them is told as a share of how far somebody is who only stands there: 0 is the same motion, and a walk, a wave or a
bend is not much nearer than 1 to anything. What ends near enough is a candidate; while it still comes nearer, or while something
else that began before is under way and so far fits better, it is waited for. Then the attempt is over, and nothing that began
before its end counts any more.

A sprint and a jog are told apart as all else is: a jog's poses are nearly a run's, but not its speed, which is one of the features.
Of development pupils, no jog came nearer to a run than 0.57, and no run with one fault was further than 0.48.
"""

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from models.arrays import Float
from models.motions.motion import Handed
from models.teaching.standard import FRAME_S, Exemplar, Standard
from services.evaluation.alignment import Spring
from services.evaluation.attempt import FoundAttempt
from services.evaluation.features import Features, features_of
from services.evaluation.keyframes import AFTER_S, BEFORE_S, keyframes_of
from services.evaluation.normalise import mirrored

_REMEMBERED_S: Final = 15.0
_SYMMETRIC: Final = 0.03
"""A standard whose features differ from its mirror image by less than this, root of the mean square, has no side that leads."""


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


@dataclass(frozen=True, eq=False)
class _Template:
    """A performance as it is compared.

    Attributes:
        action, handed: whose.
        features: (S, COUNT, 3) from its start to its end.
        still: (S,) sum of squared distances, from its start to each frame, of somebody who stays as he is at its start.
    """

    action: str
    handed: Handed
    features: Float
    still: Float


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
        self._templates = tuple(
            template
            for standard, symmetric in zip(self._standards, map(_is_symmetric, self._standards), strict=True)
            for exemplar in (standard.performance, *standard.exemplars)[: config.performances]
            for template in _templates(standard.action, exemplar, symmetric)
        )
        self._spring = Spring([template.features for template in self._templates])
        self._still = np.array([template.still[-1] for template in self._templates])
        self._asked = np.ones(len(self._templates), np.bool_)
        self._candidate: _Candidate | None = None
        self.reset()

    def choose(self, activity: str | None) -> None:
        """Look for this action only, or for all.

        Raises:
            ValueError: there is no standard of it.
        """
        asked = np.array([activity in {None, template.action} for template in self._templates])
        if not asked.any():
            raise ValueError(f"there is no standard of '{activity}'")
        self._asked, self._candidate = asked, None

    def reset(self) -> None:
        """The stream begins anew."""
        self._spring.reset()
        self._features = Features(self._frame_s)
        remembered = round(_REMEMBERED_S / self._frame_s)
        self._recent: deque[Float] = deque(maxlen=remembered)
        self._known: deque[float] = deque(maxlen=remembered)
        self._motion = _Motion(self._frame_s)
        self._count = 0
        self._candidate = None

    @property
    def state(self) -> Literal["waiting", "moving"]:
        """Whether the pupil moves."""
        return "moving" if self._motion.moves else "waiting"

    def push(self, joints_m: Float, t_s: float) -> FoundAttempt | None:
        """Take the next frame.

        Args:
            joints_m: (17, 3) in the world; NaN where unknown.
            t_s: its instant, one frame after the last one's.

        Returns:
            The attempt that was decided on, with its keyframes; the later ones of its frames are those of this frame's past.
        """
        self._recent.append(joints_m)
        self._motion.push(joints_m)
        features = self._features.push(joints_m)
        known = float(np.isfinite(features[:, 0]).mean())
        self._known.append(known + (self._known[-1] if self._known else 0.0))
        self._count += 1
        if known >= self._config.seen:
            self._spring.push(features)
            self._consider()
        else:
            self._spring.skip()
        if self._candidate is None or not self._is_over(self._candidate):
            return None
        candidate, self._candidate = self._candidate, None
        self._spring.forget(candidate.end)
        return self._found(candidate, t_s)

    def _consider(self) -> None:
        """Whether a performance that ends with the newest frame is the best candidate."""
        config, now = self._config, self._count - 1
        starts, lengths = self._spring.starts, self._spring.lengths
        tempo = (now - starts + 1) * self._frame_s / (lengths * FRAME_S)
        distances = np.sqrt(self._spring.costs / self._still)
        fits = self._asked & (distances < config.distance) & (tempo > config.tempo[0]) & (tempo < config.tempo[1])
        if self._candidate is not None:
            fits &= (distances < self._candidate.distance) & (starts <= self._candidate.end)
        for template in np.flatnonzero(fits)[np.argsort(distances[fits])]:
            start = int(starts[template])
            if self._known_share(start) >= config.known:
                self._candidate = _Candidate(int(template), start, now, float(distances[template]))
                return

    def _known_share(self, start: int) -> float:
        """Of the joints, from a frame to the newest one."""
        frames = self._count - start
        if frames >= len(self._known):
            return 0.0
        return (self._known[-1] - self._known[-1 - frames]) / frames

    def _is_over(self, candidate: _Candidate) -> bool:
        waited_s = (self._count - 1 - candidate.end) * self._frame_s
        if waited_s < self._config.wait_s - 1e-6:
            return False
        return waited_s >= self._config.patience_s or not self._is_surpassed(candidate)

    def _is_surpassed(self, candidate: _Candidate) -> bool:
        """Whether what began before the candidate's end is under way, and so far fits better."""
        config = self._config
        most = (config.better * candidate.distance) ** 2
        for number, (costs, starts) in enumerate(self._spring.ahead()):
            if not self._asked[number]:
                continue
            first = int(config.under_way * len(costs))
            nearer = costs[first:] < most * self._templates[number].still[first:]
            if (nearer & (starts[first:] <= candidate.end)).any():
                return True
        return False

    def _found(self, candidate: _Candidate, now_s: float) -> FoundAttempt | None:
        """With its keyframes; None if they are not to be seen."""
        template = self._templates[candidate.template]
        newest = self._count - 1
        oldest = newest - len(self._recent) + 1
        first = max(candidate.start - round(BEFORE_S / self._frame_s), oldest)
        last = min(candidate.end + round(AFTER_S / self._frame_s), newest)
        joints = np.array([self._recent[number - oldest] for number in range(first, last + 1)])
        if template.handed == "left":
            joints = mirrored(joints)
        frames = keyframes_of(joints, self._frame_s, self._standards, template.action)
        if frames is None:
            return None
        start, exertion, peak, end = (now_s - (newest - first - float(frame)) * self._frame_s for frame in frames)
        return FoundAttempt(template.action, template.handed, (start, exertion, peak, end))


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


def _templates(action: str, exemplar: Exemplar, symmetric: bool) -> Iterator[_Template]:
    """A performance as it is compared, and unless there is no difference its mirror image."""
    first, last = round(exemplar.moments_s[0] / FRAME_S), round(exemplar.moments_s[-1] / FRAME_S)
    sides: list[tuple[Handed, Float]] = [("right", exemplar.joints_m), ("left", mirrored(exemplar.joints_m))]
    for handed, joints in sides[: 1 if symmetric else 2]:
        features = features_of(joints, FRAME_S)[first : last + 1]
        still = np.cumsum(np.nan_to_num(((features - features[0]) ** 2).sum(axis=2)).sum(axis=1))
        if still[-1] > 0:
            yield _Template(action, handed, features, still)


def _is_symmetric(standard: Standard) -> bool:
    right, left = features_of(standard.joints_m, FRAME_S), features_of(mirrored(standard.joints_m), FRAME_S)
    return bool(np.sqrt(np.nanmean(((right - left) ** 2).sum(axis=2))) < _SYMMETRIC)
