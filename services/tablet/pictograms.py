"""Writes the little figures that stand for the actions on the page: the library's own motions, at their most telling moment.

Run `python -m services.tablet.pictograms` when an action was added; a test finds one that is missing.
"""

import json
from importlib.resources import files
from pathlib import Path
from typing import Any, Final

import numpy as np

import models.body
from models.arrays import Float
from models.body import SMALL
from models.body.file import decode
from models.motions.motion import Attempt
from models.motions.perform import perform
from models.motions.performance import Performance
from models.motions.subject import Subject
from models.skeleton import coco

FILE: Final = Path(__file__).parent / "web" / "src" / "ui" / "pictograms.json"
GRID: Final = 48
"""The figures are drawn on a square of so many units, y down."""

_MARGIN = 5.0
_SHOWN: Final = {
    "basketball_shot": ("peak", 0.0, 50.0),
    "badminton_clear": ("exertion", 0.0, 0.0),
    "volleyball_spike": ("peak", 0.0, 0.0),
    "soccer_kick": ("exertion", 0.3, 0.0),
    "long_jump": ("peak", -0.1, 0.0),
    "forward_roll": ("exertion", 0.25, 0.0),
    "squat": ("peak", 0.0, 0.0),
    "star_jump": ("peak", 0.0, 90.0),
    "run": ("peak", 0.0, 0.0),
    "cartwheel": ("peak", 0.0, 65.0),
}
"""Of each action: after which keyframe, how far from there towards the next (or, negative, the one before), and from which side
it is seen, in degrees about the vertical from the pupil's right."""
_ARMS: Final = (("shoulder", "elbow", "wrist"), ("hip", "knee", "ankle"))
_BALL_M: Final = {"basketball": 0.12, "volleyball": 0.105, "football": 0.11}


def pictogram(action: str) -> dict[str, Any]:
    """Strokes of near and far limbs and the trunk, each a list of x, y; the head's middle and radius; a ball, if there is one."""
    model = decode(files(models.body).joinpath(SMALL).read_bytes(), SMALL)
    subject = Subject(model.shaped(np.zeros(model.shape_count)), 11.0, "female")
    motion = perform(Performance(action), subject)
    keyframe, share, azimuth_deg = _SHOWN[action]
    t_s = _moment_s(motion.attempts[0], keyframe, share)
    seen = _seen_from(azimuth_deg, subject.body.coco_m(motion.pose_at(t_s))[: coco.COUNT])
    point = {name: seen[index] for name, index in coco.INDEX.items()}
    middle = {part: (point[f"left_{part}"] + point[f"right_{part}"]) / 2 for part in ("shoulder", "hip", "ear")}
    balls = [
        (_seen_from(azimuth_deg, thing.translations_m[round(t_s * 240)][None])[0], _BALL_M[thing.kind])
        for thing in motion.things
        if thing.kind in _BALL_M
    ]
    ends = np.array([*seen, *(place + side * radius for place, radius in balls for side in (-1, 1))])
    low, high = ends.min(axis=0), ends.max(axis=0)
    scale = min((GRID - 2 * _MARGIN) / float((high - low).max()), (GRID - 2 * _MARGIN) / 1.1)

    def placed(*places: Float) -> list[list[float]]:
        drawn = (np.array(places) - (low + high) / 2) * scale * (1, -1) + GRID / 2
        return [[round(float(x), 1), round(float(y), 1)] for x, y in drawn]

    return {
        "far": [placed(*(point[f"left_{joint}"] for joint in limb)) for limb in _ARMS],
        "near": [placed(*(point[f"right_{joint}"] for joint in limb)) for limb in _ARMS],
        "trunk": placed(middle["shoulder"], middle["hip"]),
        "head": [*placed(middle["ear"])[0], round(0.13 * scale, 1)],
        "balls": [[*placed(place)[0], round(radius * scale, 1)] for place, radius in balls],
    }


def _moment_s(attempt: Attempt, keyframe: str, share: float) -> float:
    moments_s = (attempt.start_s, attempt.exertion_s, attempt.peak_s, attempt.end_s)
    number = ("start", "exertion", "peak", "end").index(keyframe)
    other = number + (1 if share > 0 else -1)
    return float(moments_s[number] + abs(share) * (moments_s[other] - moments_s[number]))


def _seen_from(azimuth_deg: float, places_m: Float) -> Float:
    """(N, 2) to the right and up."""
    turn = np.radians(azimuth_deg)
    return np.stack((places_m[:, 0] * np.cos(turn) + places_m[:, 1] * np.sin(turn), places_m[:, 2]), axis=1)


if __name__ == "__main__":
    FILE.write_text(json.dumps({action: pictogram(action) for action in _SHOWN}) + "\n", encoding="utf-8")
