"""What a format has no place for, as a JSON file beside it: whose motion it is, the keyframes, and what is not known but held."""

import json
from collections.abc import Mapping

from models.arrays import Bool
from services.lesson.export.holding import told
from services.lesson.export.take import Take

SUFFIX = ".json"


def encode(take: Take, held: Mapping[str, Bool]) -> bytes:
    """The file.

    Args:
        take: the motion.
        held: (T,) of each joint or coordinate, where it is not known and keeps its last value; empty for formats with holes.
    """
    return (json.dumps(take.about() | {"held_frames": told(held)}, indent=2, ensure_ascii=False) + "\n").encode()
