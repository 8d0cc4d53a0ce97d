"""A process that makes the films of the shipped lesson: `python -m edge.simulation.shipped.worker FOLDER`, started by `install`."""

import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np

from edge.footage.transcode import encode_jpeg, write_jpegs
from edge.simulation.lesson.files import VIDEO_SUFFIX, film_path
from edge.simulation.lesson.plan import Plan, read_plan
from edge.simulation.picture.sensor import Sensor
from edge.simulation.rendering.film import sensor_of
from edge.simulation.rendering.render_lesson import JPEG_QUALITY
from edge.simulation.rendering.workers import serve_pieces
from edge.simulation.shipped.install import SOURCE, cameras
from models.arrays import Float32, UInt8
from models.errors import UserError


def main() -> int:
    """Make the films of the cameras whose numbers are asked for on standard input; returns the exit code."""
    cv2.setNumThreads(1)
    folder = Path(sys.argv[1])

    def do(number: int, step_done: Callable[[], None]) -> None:
        camera = cameras()[number]
        plan = read_plan(SOURCE, camera)
        make_film(SOURCE / f"{camera}{VIDEO_SUFFIX}", film_path(folder, camera), plan, camera)
        step_done()

    return serve_pieces(do)


def make_film(video: Path, target: Path, plan: Plan, camera: str) -> int:
    """Add a camera's noise to a video without it, and write that as Motion JPEG to `target`, which appears only when it is whole.

    Returns:
        The number of pictures.

    Raises:
        UserError: the video cannot be read.
    """
    part = target.with_name(f"{target.name}.part")
    try:
        with av.open(str(video)) as source:
            stream = source.streams.video[0]
            size_px = (stream.width, stream.height)
            jpegs = (encode_jpeg(picture, JPEG_QUALITY) for picture in _noisy(source, sensor_of(plan, camera)))
            count = write_jpegs(part, jpegs, size_px, Fraction(stream.average_rate or 30))
    except (av.FFmpegError, IndexError) as error:
        part.unlink(missing_ok=True)
        raise UserError(f"simulated lesson: {video} cannot be read ({error}); put it back (git checkout {video})") from error
    part.replace(target)
    return count


def _noisy(source: av.container.InputContainer, sensor: Sensor) -> Iterator[UInt8]:
    # What the sensor does but for its noise is in the picture already.
    noise = replace(sensor, exposure=1.0, vignetting=0.0, white_balance=(1.0, 1.0, 1.0))
    linear = linear_light()
    for number, frame in enumerate(source.decode(video=0)):
        picture = cv2.cvtColor(frame.to_ndarray(), cv2.COLOR_YUV2RGB_I420)
        yield noise.develop(linear[picture], number)


def linear_light() -> Float32:
    """(256,) linear light of each sRGB level (IEC 61966-2-1)."""
    level = np.arange(256) / 255
    return np.where(level <= 0.04045, level / 12.92, ((level + 0.055) / 1.055) ** 2.4).astype(np.float32)


if __name__ == "__main__":
    sys.exit(main())
