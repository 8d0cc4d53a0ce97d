"""Schema of the files in `actions/`: what a teacher looks for in an action, and what he says.

One TOML file an action. docs/teaching.md explains it to teachers. Reading is strict: a wrong key, word or number is one line that
names the file and the key, never a cue that silently is not given.
"""

import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import PurePath
from typing import Annotated, Final, Literal, Protocol, get_args

import msgspec
from msgspec import UNSET, Meta

from models.errors import UserError
from models.teaching.measure import Measure, Table

VERSION: Final = 1
Language = Literal["en", "zh", "de", "es"]

_Name = Annotated[str, Meta(pattern=r"^[a-z][a-z0-9_]{0,39}\Z")]
_LONGEST: Final = 90
_Words = Annotated[str, Meta(min_length=2, max_length=_LONGEST)]
_Number = Annotated[float, Meta(ge=-1e4, le=1e4)]
_Tolerance = Annotated[float, Meta(ge=0.5, le=50)]

ShownUnit = Literal["deg", "cm", "pct", "m_s", "s", "deg_s"]
"""What pages and reports have a word for."""


class Text(Table, frozen=True, kw_only=True):
    """The same words in every language of the page."""

    en: Annotated[_Words, Meta(description="English")]
    zh: Annotated[_Words, Meta(description="Chinese")]
    de: Annotated[_Words, Meta(description="German")]
    es: Annotated[_Words, Meta(description="Spanish")]

    def __post_init__(self) -> None:
        for name in self.__struct_fields__:
            value = getattr(self, name)
            if value != value.strip() or "\n" in value:
                raise ValueError(f"the {name} text is one line without spaces at its ends")

    def of(self, language: Language) -> str:
        """In one language."""
        return str(getattr(self, language))


class Shown(Measure, frozen=True, kw_only=True):
    """A measure that the page shows after each attempt."""

    name: Annotated[_Name, Meta(description="for files")]
    title: Annotated[Text, Meta(description="for people")]
    unit: Annotated[ShownUnit, Meta(description="as the measure has it")]
    good: Annotated[tuple[_Number, _Number], Meta(description="from where to where it is good")]

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.good[0] >= self.good[1]:
            raise ValueError("`good` goes from a smaller number to a larger one")


class Evidence(Measure, frozen=True, kw_only=True):
    """By what a fault is known: a measure, with what it is when done well and what it is when clearly wrong."""

    good: Annotated[_Number, Meta(description="its value when all is well")]
    fault: Annotated[_Number, Meta(description="its value when a teacher would correct it at once")]
    weight: Annotated[float, Meta(gt=0, le=10, description="how much it counts beside the other evidence")] = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.good == self.fault:
            raise ValueError("`good` and `fault` are the same number; a fault is known by a difference")


class Fault(Table, frozen=True, kw_only=True):
    """Something that a teacher would correct."""

    name: Annotated[_Name, Meta(description="for files; unique in the action")]
    importance: Annotated[float, Meta(ge=0.1, le=5, description="of two faults, the more important one is corrected first")]
    cue: Annotated[Text, Meta(description="what to do, in a few friendly words")]
    praise: Annotated[Text, Meta(description="what is said when just this was good")]
    either_way: Annotated[bool, Meta(description="whether the opposite is a mistake, too, and no praise")] = False
    evidence: Annotated[tuple[Evidence, ...], Meta(min_length=1, max_length=8, description="by what it is known")]


class Tolerance(Table, frozen=True, kw_only=True):
    """How far a joint may be from the standard, in percent of the pupil's stature, before it is yellow; red is twice that."""

    head: _Tolerance = 5.5
    shoulder: _Tolerance = 5.5
    elbow: _Tolerance = 5.5
    wrist: _Tolerance = 7.0
    hip: _Tolerance = 5.0
    knee: _Tolerance = 6.5
    ankle: _Tolerance = 6.0


class Teaching(Table, frozen=True, kw_only=True):
    """All about one action."""

    version: Annotated[int, Meta(description="version of this schema")]
    action: Annotated[_Name, Meta(description="the action; the file has its name")]
    title: Annotated[Text, Meta(description="for people")]
    shown: Annotated[tuple[Shown, ...], Meta(min_length=1, max_length=3, description="measures that the page shows")]
    fault: Annotated[tuple[Fault, ...], Meta(min_length=1, max_length=20, description="what is looked for")]
    tolerance: Annotated[Tolerance, Meta(description="of the colours")] = Tolerance()

    def measures(self) -> Iterator[tuple[str, Measure]]:
        """Every measure with its key in the file."""
        for shown in self.shown:
            yield f"shown '{shown.name}'", shown
        for fault in self.fault:
            for number, evidence in enumerate(fault.evidence):
                yield f"fault '{fault.name}', evidence {number + 1}", evidence


class Measurable(Protocol):
    """A signal or a function."""

    @property
    def unit(self) -> str:
        """Of its values."""


@dataclass(frozen=True)
class Vocabulary:
    """What measures may be made of.

    Attributes:
        signals: by the names that `signal` may have.
        functions: by the names that `function` may have.
    """

    signals: Mapping[str, Measurable]
    functions: Mapping[str, Measurable]


class _Versioned(msgspec.Struct):
    version: int


def decode_teaching(data: bytes, origin: str, vocabulary: Vocabulary | None) -> Teaching:
    """Read one file.

    Args:
        data: TOML text.
        origin: the file's name, for error messages; without its ending it must be the action's name.
        vocabulary: signals and functions that there are; None for whoever only shows the words.

    Raises:
        UserError: not TOML, another version, a key, word or number that cannot be, a text that is missing in a language, a name
            that occurs twice. One line that names the file and the key, and says what to do.
    """
    where = f"teaching file {origin}"
    try:
        version = msgspec.toml.decode(data, type=_Versioned).version
        if version != VERSION:
            raise UserError(f"{where}: `version` is {version}, this KineBox reads {VERSION}; take the file of this version")
        teaching = msgspec.toml.decode(data, type=Teaching)
    except msgspec.ValidationError as error:
        raise UserError(f"{where}: {_plain(str(error), data)}; correct it, docs/teaching.md explains every key") from error
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError, ValueError) as error:
        problem = " ".join(str(error).split())
        raise UserError(
            f"{where}: {problem}; it is no TOML there, look for a quote, bracket or equals sign that is missing"
        ) from error
    if PurePath(origin).stem != teaching.action:
        raise UserError(f"{where}: `action` is '{teaching.action}'; name the file {teaching.action}.toml, or correct `action`")
    _check_names(teaching, where)
    if vocabulary is not None:
        for key, measure in teaching.measures():
            _check_measure(measure, f"{where}: {key}", vocabulary)
    return teaching


def _check_names(teaching: Teaching, where: str) -> None:
    for kind, names in (("shown", [one.name for one in teaching.shown]), ("fault", [one.name for one in teaching.fault])):
        for name in names:
            if names.count(name) > 1:
                raise UserError(f"{where}: {kind} '{name}' occurs twice; give one of them another name, or delete it")


def _check_measure(measure: Measure, where: str, vocabulary: Vocabulary) -> None:
    for kind, name, known in (("signal", measure.signal, vocabulary.signals), ("function", measure.function, vocabulary.functions)):
        if name is not UNSET and name not in known:
            raise UserError(f"{where}: there is no {kind} '{name}'; docs/measures.md has all, {_nearest(name, known)}")
    if isinstance(measure, Shown):
        _check_unit(measure, where, vocabulary)


def _check_unit(shown: Shown, where: str, vocabulary: Vocabulary) -> None:
    if shown.signal is not UNSET:
        name, unit = shown.signal, "s" if shown.take.startswith("time_") else vocabulary.signals[shown.signal].unit
    else:
        name = str(shown.function)
        unit = vocabulary.functions[name].unit
    if unit not in get_args(ShownUnit):
        raise UserError(f"{where}: {name} is in {unit}, for which the page has no word; show another measure")
    if shown.unit != unit:
        raise UserError(f"{where}: `unit` is {shown.unit}, but {name} is in {unit}; write unit = '{unit}'")


def _nearest(name: str, known: Collection[str]) -> str:
    import difflib  # noqa: PLC0415 - only who misspells needs it

    near = difflib.get_close_matches(name, known, 3, 0.4)
    return f"such as {', '.join(near)}" if near else "correct its name"


_PLACE: Final = re.compile(r"^(?P<what>.*) - at `\$(?P<path>[^`]*)`$", re.DOTALL)
_PLAINER: Final = (
    (r"^Object missing required field (`\w+`)$", r"\1 is missing; add it"),
    (r"^Object contains unknown field (`\w+`)$", r"there is no key \1"),
    (r"^Invalid enum value ('.*')$", r"\1 is none of the words that may stand here"),
)
_INDEX: Final = re.compile(r"\.(fault|shown)\[(\d+)\]")


def _plain(message: str, data: bytes) -> str:
    """What msgspec found, with the name of the fault or measure in place of its number."""
    found = _PLACE.match(message)
    what, path = (found["what"], found["path"]) if found else (message, "")
    for pattern, plain in _PLAINER:
        what = re.sub(pattern, plain, what)
    names = _names(data)
    for kind, number in _INDEX.findall(path):
        name = names.get((kind, int(number)), str(int(number) + 1))
        path = path.replace(f".{kind}[{number}]", f", {kind} '{name}'", 1)
    path = re.sub(r"\[(\d+)\]", lambda one: f" {int(one[1]) + 1}", path.lstrip("., ")).replace(".", ", ")
    return f"{path}: {what}" if path else what


def _names(data: bytes) -> Mapping[tuple[str, int], str]:
    """Of what is listed, by kind and number, as far as it has any."""
    document = msgspec.toml.decode(data)
    return {
        (kind, number): one["name"]
        for kind in ("fault", "shown")
        for number, one in enumerate(document.get(kind, []))
        if isinstance(one, dict) and isinstance(one.get("name"), str)
    }
