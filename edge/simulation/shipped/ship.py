"""Render and compress the lesson that comes with KineBox: `python -m edge.simulation.shipped.ship --data build`.

The films are AV1, which of the codecs in PyAV's wheels gives the smallest files and has a fast decoder. Its size is the
repository's for ever: it is made again only for a reason.
"""

import argparse
import shutil
import sys
from fractions import Fraction
from pathlib import Path
from typing import cast

import av
import cv2
import numpy as np

from edge.cameras.video import load_video
from edge.simulation.lesson.files import (
    ATTEMPTS_NAME,
    FOLDER,
    PLAN_NAME,
    RIG_NAME,
    SHIPPED,
    SITE_NAME,
    TRUTH_NAME,
    VIDEO_SUFFIX,
    film_path,
)
from edge.simulation.lesson.plan import read_plan
from edge.simulation.lesson.presets import six_actions
from edge.simulation.lesson.site_of_lesson import site_of
from edge.simulation.rendering.render_lesson import Look, render_lesson
from edge.simulation.shipped.install import SOURCE

SITE = Path("deploy/sites/simulated")
TITLE = "Simulated lesson"
CODEC = "libsvtav1"
_SITE_HEAD = b"# The site that runs without any camera: the simulated lesson that comes with KineBox (docs/simulation.md).\n"
_LOOK = Look(noisy=False, quality=97)
_MOST_BYTES = 10_000_000


def ship(data: Path, crf: int, speed: int) -> int:
    """Make the files anew; returns how many bytes they have."""
    folder = data / FOLDER / "to-ship"
    render_lesson(six_actions(), folder, _progress, _LOOK)
    return pack(folder, crf, speed)


def pack(folder: Path, crf: int, speed: int) -> int:
    """Put a lesson that was rendered without noise where it is shipped from; returns how many bytes that has."""
    names = sorted(path.stem for path in folder.glob("*.avi"))
    rate_hz = read_plan(folder, names[0]).rate_hz
    shutil.rmtree(SOURCE, ignore_errors=True)
    SOURCE.mkdir()
    for name in names:
        compress(film_path(folder, name), SOURCE / f"{name}{VIDEO_SUFFIX}", rate_hz, crf, speed)
    for name in (PLAN_NAME, TRUTH_NAME, ATTEMPTS_NAME):
        shutil.copy(folder / name, SOURCE / name)
    SITE.mkdir(exist_ok=True)
    shutil.copy(folder / RIG_NAME, SITE / RIG_NAME)
    (SITE / SITE_NAME).write_bytes(_SITE_HEAD + site_of(TITLE, names, f"{FOLDER}/{SHIPPED}", RIG_NAME))
    return sum(path.stat().st_size for path in SOURCE.iterdir())


def compress(film: Path, target: Path, rate_hz: float, crf: int, speed: int) -> None:
    """A Motion JPEG film as AV1 in Matroska, one key frame at its beginning."""
    video = load_video(film, film.stem)
    with av.open(str(target), "w", format="matroska", options={"fflags": "+bitexact"}) as sink:
        stream = cast(av.VideoStream, sink.add_stream(CODEC, rate=Fraction(rate_hz).limit_denominator(1001)))
        stream.width, stream.height = video.size_px
        stream.pix_fmt = "yuv420p"
        stream.options = {"crf": str(crf), "preset": str(speed), "g": "100000", "svtav1-params": "lp=2"}
        for index in range(len(video.pictures)):
            picture = cv2.imdecode(np.frombuffer(video.pictures[index], np.uint8), cv2.IMREAD_COLOR)
            # FFmpeg's own conversion rounds chroma down, which tints all that is grey.
            planes = cv2.cvtColor(np.asarray(picture), cv2.COLOR_BGR2YUV_I420)
            frame = av.VideoFrame.from_ndarray(np.asarray(planes, np.uint8), format="yuv420p")
            frame.pts = index
            sink.mux(stream.encode(frame))
        sink.mux(stream.encode())


def _progress(done: int, total: int, remaining_s: float | None) -> None:
    if done % 40 == 0:
        sys.stderr.write(f"{done} of {total} pictures, {remaining_s or 0:.0f} s left\n")


def main() -> int:
    """Command line; returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m edge.simulation.shipped.ship", description=__doc__)
    parser.add_argument("--data", type=Path, default=Path("build"), help="data folder (default: build)")
    parser.add_argument("--crf", type=int, default=21, help="quality of AV1: less is better and larger")
    parser.add_argument("--speed", type=int, default=6, help="of the encoder, 0 to 13: less is smaller")
    options = parser.parse_args()
    size = ship(options.data, options.crf, options.speed)
    sys.stderr.write(f"{size / 1e6:.2f} MB in {SOURCE}\n")
    return 0 if size <= _MOST_BYTES else 1


if __name__ == "__main__":
    sys.exit(main())
