"""The report: plain lines for a technician, or JSON for a program."""

import json
import textwrap
from dataclasses import asdict
from itertools import groupby

from services.doctor.finding import Examined, Finding, Level
from services.logs.printable import printable

_WIDTH = 110
_LABEL = 11
_TITLES: dict[Level, str] = {"fault": "FAULT", "warning": "WARNING"}


def as_text(examined: Examined) -> str:
    """Findings first, the worst on top, then what was looked at."""
    parts = [_summary(examined), *map(_finding, examined.findings), _facts(examined)]
    return "\n\n".join(part for part in parts if part) + "\n"


def as_json(examined: Examined) -> str:
    """An object with `good`, `findings` and `facts`."""
    findings, facts = (list(map(asdict, entries)) for entries in (examined.findings, examined.facts))
    for finding in findings:
        del finding["cause"]  # The others that came from it are left out already.
    return json.dumps({"good": not findings, "findings": findings, "facts": facts}, indent=2, ensure_ascii=False) + "\n"


def _summary(examined: Examined) -> str:
    if not examined.findings:
        return "Everything is good."
    counts = {level: sum(1 for _ in group) for level, group in groupby(examined.findings, key=lambda finding: finding.level)}
    words = [f"{count} {level}{'' if count == 1 else 's'}" for level, count in counts.items()]
    return f"Found: {' and '.join(words)}, the worst first."


def _finding(finding: Finding) -> str:
    lines = (
        (_TITLES[finding.level], _sentence(finding.what)),
        ("  known by", finding.known_by),
        ("  do", finding.remedy),
    )
    return "\n".join(_row(label, words, _LABEL) for label, words in lines)


def _facts(examined: Examined) -> str:
    if not examined.facts:
        return ""
    width = max(len(fact.where) for fact in examined.facts) + 4
    return "\n".join(["Looked at", *(_row(f"  {fact.where}", fact.words, width) for fact in examined.facts)])


def _row(label: str, words: str, width: int) -> str:
    # Paths and commands are to be copied: they are never cut, however long.
    wrapped = textwrap.wrap(printable(words), _WIDTH - width, break_long_words=False, break_on_hyphens=False) or [""]
    return "\n".join(f"{label if number == 0 else '':{width}}{line}" for number, line in enumerate(wrapped))


def _sentence(words: str) -> str:
    """With a capital letter, unless it begins with a name of something."""
    first = words.split(" ", 1)[0]
    return words if not first.isalpha() or not first.islower() else words[0].upper() + words[1:]
