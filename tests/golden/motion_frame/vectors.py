"""Reads and writes the vectors' JSON."""

import json
from pathlib import Path

import numpy as np

from services.tablet.motion_frame import MotionFrame

FOLDER = Path(__file__).parent
NAMES = ("walking", "extremes", "nobody")


def load(name: str) -> MotionFrame:
    """The frame that a JSON file describes. Times are strings there: JavaScript's numbers hold 53 bits."""
    said = json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))
    return MotionFrame(
        kind=said["kind"],
        sequence=said["sequence"],
        epoch=said["epoch"],
        t_ns=int(said["t_ns"]),
        t_newest_ns=int(said["t_newest_ns"]),
        server_latency_us=said["server_latency_us"],
        out_of_range=said["out_of_range"],
        positions_mm=np.array(said["positions_mm"], np.int16),
        sigma_mm=np.array(said["sigma_mm"], np.uint16),
        states=np.array(said["states"], np.uint8),
        views=np.array(said["views"], np.uint8),
    )


def differences(frame: MotionFrame, other: MotionFrame) -> list[str]:
    """Names of the fields that are not equal."""
    return [field for field in MotionFrame.__dataclass_fields__ if not np.array_equal(getattr(frame, field), getattr(other, field))]
