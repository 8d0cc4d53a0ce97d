"""Which marker or joint of another program is which of our 17 points.

A name is a side and a part, in any order and writing: LKnee, left_knee, mixamorig:LeftLeg, Pupil01:L.Knee. Parts come in families,
since the same word means different joints: Mixamo's LeftShoulder is the collar bone, SMPL's the shoulder.
"""

import re
from collections.abc import Mapping, Sequence
from typing import Final

from models.skeleton import coco

_ANATOMICAL: Final = {part: part for part in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")}
_RIGGED: Final = {"arm": "shoulder", "forearm": "elbow", "hand": "wrist", "upleg": "hip", "leg": "knee", "foot": "ankle"}
_CHARACTER: Final = {
    "upperarm": "shoulder",
    "forearm": "elbow",
    "lowerarm": "elbow",
    "hand": "wrist",
    "thigh": "hip",
    "upperleg": "hip",
    "shin": "knee",
    "calf": "knee",
    "lowerleg": "knee",
    "foot": "ankle",
}
FAMILIES: Final[tuple[Mapping[str, str], ...]] = (_ANATOMICAL, _RIGGED, _CHARACTER)
"""What each calls the six joints of a side. The first family counts of which a file has all."""
_FACE: Final = {"eye": "eye", "ear": "ear"}
_NOSE: Final = "nose"
_PARTS: Final = frozenset({*_FACE, *(part for family in FAMILIES for part in family)})
NEEDED: Final = coco.NAMES[coco.INDEX["left_shoulder"] :]
"""Without these a motion cannot be compared; nose, eyes and ears may be missing, and are unknown then."""

_SIDES: Final = {"left": "left", "l": "left", "right": "right", "r": "right"}
_WORDS: Final = re.compile(r"[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+|\d+")


class NamesError(ValueError):
    """Why names are not those of a person, in words that go on after the name of the file."""


def points_of(names: Sequence[str]) -> dict[int, int]:
    """The place among `names` of each of our points that is there.

    Raises:
        NamesError: one of `NEEDED` is missing, or two names mean the same point.
    """
    parts = [_side_and_part(name) for name in names]
    places = max((_places(parts, family) for family in FAMILIES), key=lambda found: sum(name in found for name in NEEDED))
    missing = [name.replace("_", " ") for name in NEEDED if name not in places]
    if missing:
        told = ", ".join(missing) if len(missing) < len(NEEDED) else "shoulders, elbows, wrists, hips, knees and ankles"
        raise NamesError(f"has no {told}; name them as docs/exports.md says, for example LShoulder or left_shoulder")
    for name, (first, *others) in places.items():
        if others:
            told = f"'{names[first]}' and '{names[others[0]]}'"
            raise NamesError(f"says twice where the {name.replace('_', ' ')} is, as {told}; rename one of them")
    return {coco.INDEX[name]: found[0] for name, found in places.items()}


def _places(parts: Sequence[tuple[str, str]], family: Mapping[str, str]) -> dict[str, list[int]]:
    """Where each of our points is named."""
    known = {**family, **_FACE}
    places: dict[str, list[int]] = {}
    for place, (side, part) in enumerate(parts):
        name = part if part == _NOSE and not side else f"{side}_{known.get(part, '')}"
        if name in coco.INDEX:
            places.setdefault(name, []).append(place)
    return places


def _side_and_part(name: str) -> tuple[str, str]:
    """("left", "knee") of LKnee, of L.Knee, of knee_l and of LKNEE; an empty side if there is none."""
    words = [word.lower() for word in _WORDS.findall(name.rpartition(":")[2])]
    for index in (0, len(words) - 1):
        if len(words) > 1 and words[index] in _SIDES:
            return _SIDES[words[index]], "".join(words[:index] + words[index + 1 :])
    alone = "".join(words)
    return (_SIDES[alone[0]], alone[1:]) if alone[:1] in _SIDES and alone[1:] in _PARTS else ("", alone)
