"""A camera of a simulated lesson: its film played in real time with its own times, and all that befalls it on its way.

The lesson begins again when it is over, as a new epoch, with the same faults at the same times.
"""

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from edge.cameras.faulty import SECOND_NS, FaultySource, Script
from edge.cameras.shape import VideoShape
from edge.cameras.source import Clock, Source
from edge.cameras.video import Pictures, Video, VideoSource, load_video
from edge.simulation.lesson.files import film_path
from edge.simulation.lesson.plan import Plan, read_plan
from edge.simulation.lesson.world_faults import delivery_faults, picture_times_s, shown_by


@dataclass(frozen=True)
class Recorded:
    """The times of a lesson's pictures, over and over: picture m of loop n at start + n period + times[m].

    Attributes:
        start_ns: CLOCK_MONOTONIC of the first loop's beginning.
        times_ns: ascending, 0 to less than the period.
        period_ns: length of the lesson.
    """

    start_ns: int
    times_ns: Sequence[int]
    period_ns: int

    def t_ns(self, number: int) -> int:
        """See `Timing.t_ns`."""
        loop, index = divmod(number, len(self.times_ns))
        return self.start_ns + loop * self.period_ns + self.times_ns[index]

    def newest(self, now_ns: int) -> int:
        """See `Timing.newest`."""
        loop, within_ns = divmod(now_ns - self.start_ns, self.period_ns)
        return loop * len(self.times_ns) + bisect_right(self.times_ns, within_ns) - 1


@dataclass(frozen=True)
class SimulatedFilm:
    """What arrives under a camera's name.

    Attributes:
        video: the pictures, by whichever camera.
        times_ns: their mid-exposures from the lesson's beginning.
        period_ns: length of the lesson.
    """

    video: Video
    times_ns: tuple[int, ...]
    period_ns: int


def open_simulated(folder: Path, camera: str, start_ns: int, clock: Clock) -> tuple[Source, VideoShape]:
    """A camera of a rendered lesson, and how long and large its film is.

    Args:
        folder: the lesson's.
        camera: its name.
        start_ns: CLOCK_MONOTONIC at which the lesson begins.
        clock: CLOCK_MONOTONIC.

    Raises:
        UserError: there is no such lesson or camera, or it is damaged or of another version.
        SourceError: a fault of the lesson's keeps it from being opened now.
    """
    plan = read_plan(folder, camera)
    film = load_film(plan, folder, camera)
    source = VideoSource(film.video, Recorded(start_ns, film.times_ns, film.period_ns), clock)
    faults = delivery_faults(plan, camera, film.period_ns / SECOND_NS)
    shape = film.video.shape(film_path(folder, camera))
    return (FaultySource(source, Script(faults, start_ns, plan.seed), clock) if faults else source), shape


def load_film(plan: Plan, folder: Path, camera: str) -> SimulatedFilm:
    """Everything that arrives under a camera's name in a lesson, in order.

    Raises:
        UserError: a film is missing or damaged.
    """
    names = {camera, *(name for swap in plan.swaps for name in swap.cameras)}
    videos = {name: load_video(film_path(folder, name), camera) for name in sorted(names)}
    count = len(videos[camera].pictures)
    period_ns = math.ceil(count * SECOND_NS / plan.rate_hz)
    arriving = sorted(
        # Rounding goes up, so that pictures at 30 Hz never fall just short of a turn at 30 Hz (see `ViewControl`).
        (math.ceil(round(t_s * SECOND_NS, 3)), name, index)
        for name, video in videos.items()
        for index, t_s in enumerate(picture_times_s(plan, name, len(video.pictures)).tolist())
        if shown_by(plan, camera, t_s) == name
    )
    pictures = Picked([(videos[name].pictures, index) for _, name, index in arriving])
    return SimulatedFilm(Video(camera, videos[camera].size_px, pictures), tuple(t_ns for t_ns, *_ in arriving), period_ns)


class Picked:
    """Pictures picked from several films, read when they are asked for."""

    def __init__(self, places: Sequence[tuple[Pictures, int]]) -> None:
        self._places = places

    def __len__(self) -> int:
        return len(self._places)

    def __getitem__(self, index: int, /) -> bytes:
        pictures, place = self._places[index]
        return pictures[place]
