"""What the doctor tells: findings and facts."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from models.errors import UserError

Level = Literal["fault", "warning"]
"""A fault keeps the box, or a part of it, from working; with a warning it works less well than it should, or soon will not."""

_LEVELS: tuple[Level, ...] = ("fault", "warning")


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong.

    Attributes:
        level: how bad it is.
        where: the part: "disk", "camera 'cam01'", "fusion".
        what: what is wrong, in one line.
        known_by: what was looked at to know it.
        remedy: what to do.
        cause: what it comes from, where others may come from the same; only one of those is told. Empty where there is none.
    """

    level: Level
    where: str
    what: str
    known_by: str
    remedy: str
    cause: str = ""


@dataclass(frozen=True)
class Fact:
    """One thing that was looked at and is as it should be."""

    where: str
    words: str


@dataclass(frozen=True)
class Examined:
    """What an examination of one part gave."""

    findings: tuple[Finding, ...] = ()
    facts: tuple[Fact, ...] = ()

    @classmethod
    def join(cls, parts: Iterable["Examined"]) -> "Examined":
        """Everything, the worst first and otherwise in the order in which it was found; of what has one cause, the first then."""
        together = list(parts)
        ordered = sorted((each for part in together for each in part.findings), key=lambda each: _LEVELS.index(each.level))
        findings: dict[Finding | str, Finding] = {}
        for finding in ordered:
            findings.setdefault(finding.cause or finding, finding)
        return cls(tuple(findings.values()), tuple(fact for part in together for fact in part.facts))


def fault_of(where: str, error: UserError | str, known_by: str) -> Finding:
    """The finding for an error for people, whose line ends with what to do after its last semicolon."""
    line = " ".join(str(error).split())
    what, found, remedy = line.rpartition("; ")
    return Finding("fault", where, *((what, known_by, remedy) if found else (line, known_by, "correct it")))
