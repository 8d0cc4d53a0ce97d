"""Ordinary video files as a lesson's pictures: decoded as they come, since such a film does not fit into memory."""

import heapq
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import cast

import av
import cv2

from models.arrays import UInt8
from models.errors import UserError
from tests.bench.reconstruct.lesson import START_NS


@dataclass(frozen=True, eq=False)
class DecodedFrame:
    """A picture of a film. See `edge.cameras.source.Frame`."""

    camera: str
    index: int
    t_mid_ns: int
    size_px: tuple[int, int]
    picture: UInt8
    epoch: int = 0

    def image(self, reduction: int = 1) -> UInt8:
        """The picture as RGB, reduced by the mean of its pixels."""
        if reduction == 1:
            return self.picture
        size = (-(-self.size_px[0] // reduction), -(-self.size_px[1] // reduction))
        return cast(UInt8, cv2.resize(self.picture, size, interpolation=cv2.INTER_AREA))


@dataclass(frozen=True)
class Film:
    """A video file of one camera.

    Attributes:
        camera: its name.
        path: the file.
        size_px: width and height.
        rate_hz: pictures a second.
        first: number of the picture that is the lesson's beginning.
        count: pictures from there on.
    """

    camera: str
    path: Path
    size_px: tuple[int, int]
    rate_hz: float
    first: int
    count: int

    def frames(self) -> Iterator[DecodedFrame]:
        """Every picture, in order.

        Raises:
            UserError: the file ends early or cannot be decoded.
        """
        done = 0
        try:
            with av.open(str(self.path)) as container:
                for number, picture in enumerate(container.decode(video=0)):
                    if number < self.first:
                        continue
                    if done == self.count:
                        return
                    t_ns = START_NS + int(-(-done * 1_000_000_000 // self.rate_hz))
                    yield DecodedFrame(self.camera, done, t_ns, self.size_px, cast(UInt8, picture.to_ndarray(format="rgb24")))
                    done += 1
        except (av.FFmpegError, OSError) as error:
            raise UserError(f"{self.path} cannot be decoded ({error}); copy it again") from error
        if done < self.count:
            raise UserError(f"{self.path} has {self.first + done} pictures, the annotation goes on to {self.first + self.count}")


def frames_of(films: Mapping[str, Film], cameras: Sequence[str]) -> Iterator[DecodedFrame]:
    """The pictures of some films in the order of their time."""
    return iter(heapq.merge(*(films[name].frames() for name in cameras), key=lambda frame: frame.t_mid_ns))


def open_film(path: Path, camera: str, rate_hz: float, first: int = 0, count: int | None = None) -> Film:
    """A video file.

    Raises:
        UserError: it is missing, or no video.
    """
    if not path.is_file():
        raise UserError(f"{path} is missing: the film of camera '{camera}'")
    try:
        with av.open(str(path)) as container:
            if not container.streams.video:
                raise UserError(f"{path} contains no video")
            stream = container.streams.video[0]
            size_px, announced = (stream.width, stream.height), stream.frames
    except (av.FFmpegError, OSError) as error:
        raise UserError(f"{path} is no video that can be read ({error}); copy it again") from error
    there = (announced or 10**9) - first
    return Film(camera, path, size_px, rate_hz, first, there if count is None else min(count, there))


def opener(films: Mapping[str, Film]) -> "partial[Iterator[DecodedFrame]]":
    """`Lesson.frames` of some films."""
    return partial(frames_of, films)
