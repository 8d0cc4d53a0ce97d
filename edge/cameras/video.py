"""A Motion JPEG file played as if it were a camera: in real time, every picture in order, over and over."""

import math
import os
import weakref
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Protocol

import av

from edge.cameras.jpeg import JpegFrame, is_whole
from edge.cameras.shape import VideoShape
from edge.cameras.source import Clock
from models.errors import UserError

_SECOND_NS = 1_000_000_000


class Pictures(Protocol):
    """Compressed pictures, in memory or wherever they come from when they are asked for."""

    def __len__(self) -> int: ...

    def __getitem__(self, index: int, /) -> bytes: ...


@dataclass(frozen=True)
class Video:
    """A film: its pictures, compressed."""

    camera: str
    size_px: tuple[int, int]
    pictures: Pictures

    def shape(self, path: Path) -> VideoShape:
        """How long and large it is; `path` is where it came from."""
        return VideoShape(path, len(self.pictures), self.size_px)

    def frames(self, rate_hz: float) -> Iterator[JpegFrame]:
        """Every picture once, as if played at that rate from time zero, without waiting (for benches and tests)."""
        schedule = Schedule(0, 0, rate_hz)
        for index in range(len(self.pictures)):
            yield self.frame(0, index, schedule.t_ns(index))

    def frame(self, epoch: int, index: int, t_mid_ns: int) -> JpegFrame:
        """Picture `index`, stamped."""
        return JpegFrame(self.camera, epoch, index, t_mid_ns, self.size_px, self.pictures[index])


class PicturesOfFile:
    """The pictures of a file, each read when it is asked for: a long lesson is larger than the memory of a box.

    What cannot be read any more is an empty picture, which is damaged.

    Args:
        path: the file, which is held open.
    """

    def __init__(self, path: Path) -> None:
        self._descriptor = os.open(path, os.O_RDONLY)
        weakref.finalize(self, os.close, self._descriptor)
        self._places: list[tuple[int, int] | bytes] = []

    def __len__(self) -> int:
        return len(self._places)

    def append(self, position: int | None, picture: bytes) -> None:
        """Add a picture, which the file has at `position`; what it has not there, as some containers do, is kept in memory."""
        place = (position or 0, len(picture))
        self._places.append(place if self._read(*place) == picture else picture)

    def __getitem__(self, index: int, /) -> bytes:
        place = self._places[index]
        return place if isinstance(place, bytes) else self._read(*place)

    def _read(self, position: int, size: int) -> bytes:
        try:
            return os.pread(self._descriptor, size, position)
        except OSError:
            return b""


def load_video(path: Path, camera: str) -> Video:
    """Open a Motion JPEG file, having seen that every picture of it is whole.

    Raises:
        UserError: the file is missing, empty, truncated, may not be read, is no video, or one whose pictures do not stand alone.
    """
    where = f"camera '{camera}': {path}"
    try:
        if not path.is_file():
            raise UserError(
                f"{where} is missing; correct `path` in the site file "
                "(the built-in footage: .venv/bin/python -m edge.footage.prepare)"
            )
        if path.stat().st_size == 0:
            raise UserError(f"{where} is empty; copy or prepare it again")
        with av.open(str(path)) as container:
            if not container.streams.video:
                raise UserError(f"{where} contains no video; give a Motion JPEG file")
            stream = container.streams.video[0]
            codec = stream.codec_context.name
            size_px, announced = (stream.width, stream.height), stream.frames
            pictures, whole = PicturesOfFile(path), 0
            for packet in container.demux(stream):
                if packet.size:
                    data = bytes(packet)
                    pictures.append(packet.pos, data)
                    whole += is_whole(data)
    except (av.FFmpegError, OSError) as error:
        raise UserError(f"{where} is not a video that can be read ({error}); copy or prepare it again") from error
    if codec != "mjpeg":
        raise UserError(f"{where} is {codec}; only Motion JPEG is played (ffmpeg -i IN -c:v mjpeg -q:v 3 OUT.avi)")
    if not pictures or whole < max(len(pictures), announced):
        raise UserError(
            f"{where} is truncated: {whole} of {max(len(pictures), announced)} pictures are whole; copy or prepare it again"
        )
    return Video(camera, size_px, pictures)


@dataclass(frozen=True)
class Schedule:
    """When the pictures of a looping file are due: picture m, counted over all loops, at start + offset + m / rate.

    All cameras of a run share `start_ns`, so that equal files agree to the nanosecond. Rounding goes up, so that the pictures
    of a 30 Hz file never fall just short of a 30 Hz turn (see `ViewControl`).
    """

    start_ns: int
    offset_ns: int
    rate_hz: float

    def t_ns(self, number: int) -> int:
        """Mid-exposure of picture `number` (0, 1, ...)."""
        return self.start_ns + self.offset_ns + math.ceil(number * _SECOND_NS / Fraction(self.rate_hz))

    def newest(self, now_ns: int) -> int:
        """Number of the newest picture that was exposed by `now_ns`; negative before the first."""
        return math.floor((now_ns - self.start_ns - self.offset_ns) * Fraction(self.rate_hz) / _SECOND_NS)


class Timing(Protocol):
    """When pictures are due, counted over all loops: see `Schedule`."""

    def t_ns(self, number: int) -> int:
        """Mid-exposure of picture `number` (0, 1, ...)."""

    def newest(self, now_ns: int) -> int:
        """Number of the newest picture that was exposed by `now_ns`; negative before the first."""


class VideoSource:
    """Plays a `Video` by its timing. A loop is a new epoch; who comes late gets the newest picture, never a queue."""

    def __init__(self, video: Video, schedule: Timing, clock: Clock) -> None:
        self._video = video
        self._schedule = schedule
        self._clock = clock
        self._last: int | None = None
        self._skipped = 0

    @property
    def skipped(self) -> int:
        """See `Source.skipped`."""
        return self._skipped

    @property
    def problem(self) -> None:
        """See `Source.problem`: a file has none once it is read."""
        return None

    def grab(self, timeout_s: float) -> JpegFrame | None:
        """See `Source.grab`."""
        now_ns = self._clock.now_ns()
        newest = self._schedule.newest(now_ns)
        # What was shown while the networks were loading was never there to be missed.
        wanted = max(0, newest) if self._last is None else self._last + 1
        if newest < wanted:
            due_ns = self._schedule.t_ns(wanted)
            self._clock.sleep_until(min(due_ns, now_ns + round(timeout_s * _SECOND_NS)))
            newest = self._schedule.newest(self._clock.now_ns())
            if newest < wanted:
                return None
        self._skipped += newest - wanted
        self._last = newest
        epoch, index = divmod(newest, len(self._video.pictures))
        return self._video.frame(epoch, index, self._schedule.t_ns(newest))

    def close(self) -> None:
        """The file is let go of with the last of its pictures."""
