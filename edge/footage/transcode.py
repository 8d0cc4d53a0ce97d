"""A video as it was published becomes a file in which every picture stands alone, as a UVC camera's MJPG stream does.

So the edge grabs every picture for nothing and decodes only those that it looks at.
"""

import io
from collections.abc import Iterable, Iterator
from fractions import Fraction
from itertools import chain
from pathlib import Path
from typing import cast

import av
import cv2
import numpy as np

from models.arrays import UInt8
from models.errors import UserError

SIZE_PX = (720, 1270)
"""(width, height): 1088x1920, the pictures that were calibrated, at 720 px width."""
JPEG_QUALITY = 90
BAR_LEVEL = 40.0
"""Mean grey level under which an edge row belongs to a black bar; the bars measure 1-12, the pictures above 75."""


def transcode(source: bytes, target: Path, camera: str, *, fitted: bool) -> int:
    """Write the video file `source` as Motion JPEG of `SIZE_PX` to `target`, which appears only when it is complete.

    Two of the first footage's videos were published at 1080 px width: the calibrated 1088x1920 scaled to fit, with black bars of
    7 px above and below. Where videos are `fitted` so, the bars are cut off before scaling, which undoes that: one calibrated
    pixel is the same size everywhere.

    Returns:
        The number of pictures.

    Raises:
        UserError: the file is no video that can be read.
    """
    part = target.with_name(f"{target.name}.part")
    try:
        with av.open(io.BytesIO(source), "r") as video:
            rate = Fraction(video.streams.video[0].average_rate or 60)
            count = write_motion_jpeg(part, _scaled(video, fitted=fitted), rate)
    except (av.FFmpegError, IndexError) as error:
        part.unlink(missing_ok=True)
        raise UserError(f"footage: {camera}: its video cannot be read ({error}); fetch it again") from error
    part.replace(target)
    return count


def _scaled(video: av.container.InputContainer, *, fitted: bool) -> Iterator[UInt8]:
    rows: slice | None = None if fitted else slice(None)
    for frame in video.decode(video=0):
        picture = cast(UInt8, frame.to_ndarray(format="bgr24"))
        rows = rows or picture_rows(picture)
        yield cast(UInt8, cv2.resize(picture[rows], SIZE_PX, interpolation=cv2.INTER_AREA))


def write_motion_jpeg(path: Path, pictures: Iterable[UInt8], rate_hz: Fraction) -> int:
    """Write BGR pictures (h, w, 3), all of one size, as an AVI file of JPEG pictures; returns their number.

    Raises:
        IndexError: there are none.
    """
    rest = iter(pictures)
    first = next(rest, None)
    if first is None:
        raise IndexError("a video has at least one picture")
    height, width = first.shape[:2]
    return write_jpegs(path, map(encode_jpeg, chain((first,), rest)), (width, height), rate_hz)


def write_jpegs(path: Path, pictures: Iterable[bytes], size_px: tuple[int, int], rate_hz: Fraction) -> int:
    """Write JPEG pictures of one size, (width, height), as an AVI file; returns their number."""
    count = 0
    with av.open(str(path), "w", format="avi") as sink:
        stream = sink.add_stream("mjpeg", rate=rate_hz)
        stream.pix_fmt = "yuvj420p"
        stream.width, stream.height = size_px
        for count, picture in enumerate(pictures, start=1):
            packet = av.Packet(picture)
            packet.stream, packet.time_base, packet.is_keyframe = stream, 1 / rate_hz, True
            packet.pts = packet.dts = count - 1
            packet.duration = 1
            sink.mux(packet)
    return count


def picture_rows(picture: UInt8) -> slice:
    """The rows of a picture (h, w, 3) between black bars above and below."""
    bright = np.flatnonzero(picture.mean(axis=(1, 2)) > BAR_LEVEL)
    return slice(int(bright[0]), int(bright[-1]) + 1)


def encode_jpeg(picture: UInt8, quality: int = JPEG_QUALITY) -> bytes:
    """A BGR picture (h, w, 3) as baseline JPEG with 4:2:0 chroma."""
    options = [cv2.IMWRITE_JPEG_QUALITY, quality, cv2.IMWRITE_JPEG_SAMPLING_FACTOR, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_420]
    return cv2.imencode(".jpg", picture, options)[1].tobytes()
