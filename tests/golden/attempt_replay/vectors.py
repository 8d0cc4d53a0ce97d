"""Reads the vectors' JSON, in which what is not known of the standard is null."""

import json
from pathlib import Path

import numpy as np

from services.tablet.attempt_replay import UNKNOWN_MM, AttemptReplay

FOLDER = Path(__file__).parent
NAMES = ("jump", "extremes", "grey")
_NOWHERE = [UNKNOWN_MM] * 3


def load(name: str) -> AttemptReplay:
    """The replay that a JSON file describes."""
    said = json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))
    first, second, third, fourth = said["keyframes"]
    standard_mm = [[_NOWHERE if place is None else place for place in frame] for frame in said["standard_mm"]]
    return AttemptReplay(
        frame_us=said["frame_us"],
        keyframes=(first, second, third, fourth),
        out_of_range=said["out_of_range"],
        positions_mm=np.array(said["positions_mm"], np.int16),
        states=np.array(said["states"], np.uint8),
        colours=np.array(said["colours"], np.uint8),
        standard_mm=np.array(standard_mm, np.int16),
    )


def differences(replay: AttemptReplay, other: AttemptReplay) -> list[str]:
    """Names of the fields that are not equal."""
    return [
        field for field in AttemptReplay.__dataclass_fields__ if not np.array_equal(getattr(replay, field), getattr(other, field))
    ]
