"""Reading BVH: skeletons of any program, with y up. A joint's place follows from the rotations of all that carry it."""

import re
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from models.arrays import Float
from models.errors import UserError
from models.motions.rotations import about, through
from models.skeleton import coco
from services.evaluation.track import Track
from services.lesson.export.axes import FIGURES
from services.lesson.imports.names import NamesError, points_of
from services.lesson.imports.points import NamedPoints, require_size, track_of_points
from services.lesson.imports.text import lines_of

UNITS_M: Final = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "cmu": 0.0254 / 0.45}
"""BVH says none: it is the one that makes a leg as long as a leg. The library of CMU is in 1/0.45 inches, as its ASF files say."""
_LEG_M: Final = (0.45, 1.1)
"""Thigh and shank of people of 1.0 to 2.2 m; so narrow that only some inches can be taken for CMU's unit."""
_AXES: Final = {"X": 0, "Y": 1, "Z": 2}
_CHANNEL: Final = re.compile(r"([XYZ])(position|rotation)", re.IGNORECASE)
_DEEPEST: Final = 200


@dataclass
class _Joint:
    name: str
    parent: int
    offset: Float = field(default_factory=lambda: np.zeros(3))
    channels: list[tuple[int, bool]] = field(default_factory=list)
    """Axis, and whether it is a rotation."""


class _Words:
    """The words of the head behind its first line, each with its line, read one after the other."""

    def __init__(self, lines: list[str], source: str) -> None:
        self._words = [(number, word) for number, line in enumerate(lines, start=2) for word in line.split()]
        self._at = 0
        self._source = source

    def next(self) -> str:
        if self._at == len(self._words):
            raise UserError(f"{self._source} is cut off in its hierarchy; copy or export it again")
        self._at += 1
        return self._words[self._at - 1][1]

    def number(self) -> float:
        word = self.next()
        try:
            value = float(word)
        except ValueError:
            value = np.nan
        if not np.isfinite(value):
            raise self.wrong(f"'{word}' stands where a number belongs")
        return value

    def expect(self, word: str) -> None:
        found = self.next()
        if found.upper() != word:
            raise self.wrong(f"'{found}' stands where {word} belongs")

    def wrong(self, what: str) -> UserError:
        return UserError(f"{self._source}, line {self._words[self._at - 1][0]}: {what}; correct it or export it again")


def decode(data: bytes, source: str, unit: str | None = None) -> Track:
    """The track of a file.

    Args:
        data: its content.
        source: its name, for errors.
        unit: one of `UNITS_M`, for a file whose unit does not follow from the length of its legs.

    Raises:
        UserError: it is no BVH, cut off, holds what is no number, `unit` makes it no person, or without one none or two do, or see
            `track_of_points`.
    """
    lines = lines_of(data, source, "BVH")
    if not lines or lines[0].strip().upper() != "HIERARCHY":
        raise UserError(f"{source} is no BVH file: it does not begin with HIERARCHY; name one, or export it again")
    motion = next((index for index, line in enumerate(lines) if line.strip().upper() == "MOTION"), None)
    if motion is None:
        raise UserError(f"{source} has no MOTION: it is cut off, or a skeleton alone; copy or export it again")
    joints = _hierarchy(_Words(lines[1:motion], source))
    frames, step_s = _motion_head(lines[motion + 1 : motion + 3], source)
    require_size(source, frames, 1 / step_s)
    values = _table(lines, motion + 3, sum(len(joint.channels) for joint in joints), source)
    if len(values) != frames:
        raise UserError(f"{source} has {len(values)} frames and says that it has {frames}; it is cut off; copy or export it again")
    names = [joint.name for joint in joints]
    places = _places(joints, values)
    rate_hz = float(f"{1 / step_s:.6g}")
    return track_of_points(NamedPoints(source, names, places, _unit_m(names, joints, source, unit), rate_hz), FIGURES)


def _hierarchy(words: _Words) -> list[_Joint]:
    words.expect("ROOT")
    joints: list[_Joint] = []
    _joint(words, joints, -1, 0)
    return joints


def _joint(words: _Words, joints: list[_Joint], parent: int, depth: int) -> None:
    """One joint and all that hangs on it, from its name on."""
    if depth > _DEEPEST:
        raise words.wrong("no body has so many joints in a row")
    joint, index = _Joint(words.next(), parent), len(joints)
    joints.append(joint)
    words.expect("{")
    while (word := words.next().upper()) != "}":
        if word == "OFFSET":
            joint.offset = np.array([words.number() for _ in range(3)])
        elif word == "CHANNELS":
            joint.channels = [_channel(words) for _ in range(int(words.number()))]
        elif word == "JOINT":
            _joint(words, joints, index, depth + 1)
        elif word == "END":
            for expected in ("SITE", "{", "OFFSET"):
                words.expect(expected)
            for _ in range(3):
                words.number()
            words.expect("}")
        else:
            raise words.wrong(f"'{word}' stands where OFFSET, CHANNELS, JOINT, End Site or }} belongs")


def _channel(words: _Words) -> tuple[int, bool]:
    word = words.next()
    found = _CHANNEL.fullmatch(word)
    if found is None:
        raise words.wrong(f"'{word}' is no channel")
    return _AXES[found[1].upper()], found[2].lower() == "rotation"


def _motion_head(lines: list[str], source: str) -> tuple[int, float]:
    found = re.fullmatch(r"\s*Frames:\s*(\d{1,9})\s*\n\s*Frame\s+Time:\s*(\S+)\s*", "\n".join(lines), re.IGNORECASE)
    try:
        step_s = float(found[2]) if found else 0.0
    except ValueError:
        step_s = 0.0
    if found is None or not 0 < step_s < np.inf:
        raise UserError(f"{source} does not say its frames and frame time behind MOTION; export it again")
    return int(found[1]), step_s


def _table(lines: list[str], start: int, columns: int, source: str) -> Float:
    """(T, columns) of the motion's rows."""
    rows = []
    for number, line in enumerate(lines[start:], start=start + 1):
        texts = line.split()
        if not texts:
            continue
        if len(texts) != columns:
            raise UserError(f"{source}, line {number}: {len(texts)} values and {columns} channels; copy or export it again")
        try:
            rows.append([float(text) for text in texts])
        except ValueError as error:
            raise UserError(f"{source}, line {number}: a value is no number; correct it or export it again") from error
        if not np.isfinite(rows[-1]).all():
            raise UserError(f"{source}, line {number}: a value is not finite; correct it or export it again")
    return np.array(rows).reshape(len(rows), columns)


def _places(joints: list[_Joint], values: Float) -> Float:
    """(T, joints, 3) in the file's unit and world."""
    turns: list[Float] = []
    places: list[Float] = []
    column = 0
    for joint in joints:
        turn = np.broadcast_to(np.eye(3), (len(values), 3, 3))
        shift = np.broadcast_to(joint.offset, (len(values), 3)).copy()
        if any(not rotates for _, rotates in joint.channels):
            shift[:] = 0.0  # positions stand in the offset's place
        for axis, rotates in joint.channels:
            if rotates:
                turn = turn @ about(axis, np.deg2rad(values[:, column]))
            else:
                shift[:, axis] = values[:, column]
            column += 1
        if joint.parent >= 0:
            shift = places[joint.parent] + through(turns[joint.parent], shift)
            turn = turns[joint.parent] @ turn
        turns.append(turn)
        places.append(shift)
    return np.stack(places, axis=1)


def _unit_m(names: list[str], joints: list[_Joint], source: str, unit: str | None) -> float:
    try:
        places = points_of(names)
    except NamesError as error:
        raise UserError(f"{source} {error}") from error

    leg = float(sum(np.linalg.norm(joints[places[coco.INDEX[name]]].offset) for name in ("left_knee", "left_ankle")))
    possible = [name for name, unit_m in UNITS_M.items() if _LEG_M[0] <= leg * unit_m <= _LEG_M[1]]
    if unit is not None:
        if unit not in UNITS_M:
            raise UserError(f"there is no unit '{unit}'; choose one of {', '.join(UNITS_M)}")
        if unit not in possible:
            raise UserError(
                f"{source}: in the unit '{unit}' a leg is {leg * UNITS_M[unit]:.2g} m long, that of nobody; correct --unit"
            )
        return UNITS_M[unit]
    if len(possible) == 1:
        return UNITS_M[possible[0]]
    if possible:
        raise UserError(f"{source}: a leg is {leg:.3g} long, and the unit may be {' or '.join(possible)}; say it with --unit")
    raise UserError(f"{source}: a leg is {leg:.3g} long, in no unit that of a person; export it in centimetres")
