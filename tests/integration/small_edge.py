"""The real process of a camera on a real video, with networks that cost nothing; or, by order, that are too slow.

`data/orders/edge-NAME` may hold "slow": then every pose takes a quarter of a second.
"""

import os
import time
from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path

import numpy as np

from edge import process
from edge.footage.transcode import write_motion_jpeg
from edge.library import Library
from models.arrays import UInt8
from models.process import ProcessContext
from tests.fake_networks import FakeDetector, FakeEstimate, FakePose
from tests.small_video import spot_picture

SIZE_PX = (640, 480)
SLOW_S = 0.25


class SlowPose(FakePose):
    def estimate(self, crop_rgb: UInt8) -> FakeEstimate:
        time.sleep(SLOW_S)
        return super().estimate(crop_rgb)


def main(context: ProcessContext) -> None:
    starts = context.data / "starts" / context.name
    starts.parent.mkdir(exist_ok=True)
    with starts.open("a") as file:
        file.write(f"{os.getpid()} {context.start_ns}\n")
    order = context.data / "orders" / context.name
    pose = SlowPose() if order.is_file() and order.read_text() == "slow" else FakePose()

    def open_library(context: ProcessContext) -> Library:  # noqa: ARG001 - as the real one is called
        return Library(lambda _: pose, FakeDetector, "thunder")

    process.open_library = open_library
    process.main(context)


def write_film(path: Path) -> None:
    """Two seconds of a spot that walks."""
    places = (np.array((200.0 + 4 * k, 240.0)) for k in range(60))
    _write(path, (spot_picture(place, 12.0, SIZE_PX) for place in places))


def write_black_film(path: Path) -> None:
    """Two seconds of a covered lens, with a sensor's noise."""
    random = np.random.default_rng(1)
    _write(path, (random.integers(0, 12, (SIZE_PX[1], SIZE_PX[0], 3)).astype(np.uint8) for _ in range(60)))


def _write(path: Path, pictures: Iterable[UInt8]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    write_motion_jpeg(path, pictures, Fraction(30))
