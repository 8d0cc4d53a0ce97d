"""Observations of a lesson that was never rendered, with the errors that the networks made where it was alike."""

import heapq
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Final

import numpy as np

from models.arrays import Float
from models.errors import UserError
from models.messages.observation import Observation
from tests.twin.bootstrap import Bootstrap, Walker
from tests.twin.context import Frame, inside, look
from tests.twin.errors import Errors, said_of
from tests.twin.lesson import Lesson, Sampled, truth_of
from tests.twin.library import Library, decode
from tests.twin.settings import Settings, from_plain
from tests.twin.speech import Speaker
from tests.twin.truth import Truth

FILE: Final = Path(__file__).parent / "data" / "twin.npz"
_BLOCK_S: Final = 4.0
_LEAST_POINTS: Final = 5
"""With fewer points in the picture there is nobody for the edge (`edge.perception.tracking.TrackingConfig.joints_min`)."""


@dataclass(frozen=True, eq=False)
class Twin:
    """A fitted twin.

    Attributes:
        library: what was seen to go wrong.
        settings: how it is drawn from.
    """

    library: Library
    settings: Settings

    @classmethod
    def load(cls, path: Path = FILE) -> "Twin":
        """The twin of the networks that the box runs.

        Raises:
            UserError: there is no such file, or it is of another version.
        """
        try:
            data = path.read_bytes()
        except OSError as error:
            raise UserError(f"{path}: {error.strerror}; make it with make twin") from error
        library, settings = decode(data, str(path))
        return cls(library, from_plain(settings))

    def observations(self, lesson: Lesson) -> Iterator[tuple[float, Observation]]:
        """What the edge processes would publish, in the order of arrival.

        Args:
            lesson: who moves before which cameras.

        Yields:
            Time of arrival in seconds from the lesson's beginning, and the observation. The same lesson gives the same ones;
            lessons of consecutive seeds have the errors of each of the library's pupils in their turn.

        Raises:
            UserError: the library has no pictures at such intervals.
        """
        delays_s = self.library.delays_s if lesson.delays_s is None else np.array(lesson.delays_s)
        voices = [
            self._voice(lesson.seed, index, times_s, delays_s, lesson.start_ns) for index, times_s in enumerate(lesson.times_s)
        ]
        waiting: list[tuple[float, int, int, Observation]] = []
        blocks = int(lesson.seconds / _BLOCK_S) + 1
        for block in range(blocks):
            begin_s, end_s = block * _BLOCK_S, (block + 1) * _BLOCK_S
            sampled = Sampled(lesson.pupils, begin_s, end_s)
            for index, (camera, voice, times_s) in enumerate(zip(lesson.rig, voices, lesson.times_s, strict=True)):
                t_s = times_s[(times_s >= begin_s) & (times_s < end_s)]
                for arrival_s, observation in voice.tell(truth_of(sampled, camera, t_s, lesson.shutter)) if len(t_s) else ():
                    heapq.heappush(waiting, (arrival_s, index, observation.sequence, observation))
            while waiting and (waiting[0][0] < end_s or block == blocks - 1):
                arrival_s, _, _, observation = heapq.heappop(waiting)
                yield arrival_s, observation

    def retold(self, truths: Sequence[Truth], seed: int, start_ns: int, delays_s: Float) -> list[tuple[float, Observation]]:
        """As `observations`, of pictures whose truth is at hand: one truth a camera."""
        told = []
        for index, truth in enumerate(truths):
            told += self._voice(seed, index, truth.t_s, delays_s, start_ns).tell(truth)
        return sorted(told, key=lambda one: one[0])

    def _voice(self, seed: int, index: int, times_s: Float, delays_s: Float, start_ns: int) -> "_Voice":
        interval_s = float(np.median(np.diff(times_s))) if len(times_s) > 1 else self.settings.interval_s
        walker = self._bootstrap(interval_s).walker(np.random.default_rng((seed, index, 1)), seed)
        return _Voice(walker, np.random.default_rng((seed, index)), delays_s, Speaker(start_ns, self.settings.network))

    def _bootstrap(self, interval_s: float) -> Bootstrap:
        key = round(interval_s, 4)
        if key not in self._ready:
            self._ready[key] = Bootstrap(self.library, self.settings, interval_s)
        return self._ready[key]

    @cached_property
    def _ready(self) -> dict[float, Bootstrap]:
        return {}


def errors_in(walker: Walker, truth: Truth) -> tuple[Frame, Errors]:
    """The next errors of a walker in the pictures of a truth, and the frame that they are told in."""
    frame, context = look(truth)
    errors = walker.errors(context)
    ahead = np.isfinite(frame.points_px).all(axis=(1, 2))
    errors.found[:] &= ahead & (inside(frame.points_px, truth.camera).sum(axis=1) >= _LEAST_POINTS)
    return frame, errors


class _Voice:
    """What one camera says, picture by picture."""

    def __init__(self, walker: Walker, random: np.random.Generator, delays_s: Float, speaker: Speaker) -> None:
        self._walker, self._random, self._delays_s, self._speaker = walker, random, delays_s, speaker

    def tell(self, truth: Truth) -> list[tuple[float, Observation]]:
        """Arrivals and observations of the next pictures."""
        frame, errors = errors_in(self._walker, truth)
        shares = np.linspace(0.0, 1.0, len(self._delays_s))
        delay_s = np.interp(self._random.uniform(size=len(truth)), shares, self._delays_s)
        return self._speaker.say(truth, frame, said_of(frame, errors, delay_s))
