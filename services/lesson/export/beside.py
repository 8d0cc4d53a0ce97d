"""What a format has no place for, as a JSON file beside it: whose motion it is, the keyframes, and what is not known but held."""

import json
from collections.abc import Mapping

from models.arrays import Bool
from services.lesson.export.holding import spans
from services.lesson.export.take import Take

SUFFIX = ".json"


def encode(take: Take, held: Mapping[str, Bool]) -> bytes:
    """The file.

    Args:
        take: the motion.
        held: (T,) of each joint or coordinate, where it is not known and keeps its last value; empty for formats with holes.
    """
    frames = {name: [[first + 1, last + 1] for first, last in spans(flags)] for name, flags in held.items() if flags.any()}
    return (json.dumps(take.about() | {"held_frames": frames}, indent=2, ensure_ascii=False) + "\n").encode()
