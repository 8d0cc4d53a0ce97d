"""Writes the page about reports from the schema: `python -m services.evaluation.report.schema_docs > docs/report.md`."""

import json
import sys
from collections.abc import Iterator
from typing import Any, Final

import msgspec

from services.evaluation.report.csv_file import COLUMNS
from services.evaluation.report.document import VERSION, Report

_OPENING: Final = """\
# Reports

In what follows, `kinebox` is `.venv/bin/kinebox` of the folder in which `make run` was typed.

    kinebox report LESSON --out report.html                       # the page to print
    kinebox report LESSON --format csv --out 7b.csv               # for the gradebook
    kinebox report LESSON --format json                           # for programs; without --out it goes to stdout
    kinebox report LESSON --language de --pupil 7

LESSON is a name from `kinebox lessons`, or any file. A report says what the tablet said on the day, attempt by attempt, from the
lesson's file. A lesson that holds no attempts, because it is older than the evaluation or the evaluation was not at work, is
evaluated now from its recorded motion, some milliseconds a frame; `--again` does that with any lesson, after the school has
changed what it teaches. What was chosen on the tablet is not known then: attempts are recognised, unless the site file says what
pupils do.

Titles and texts come from the teaching files ([teaching](teaching.md)) of the site that the lesson's file names, or of `--site`;
the language from there, too, unless `--language` says `en`, `zh`, `de` or `es`. Days and times are in the time zone of the
machine that reports; a lesson's file does not hold that of the gym.

Exit code 2 with one line if the lesson cannot be read, holds no motion or no attempt, if there is no such format, language or
pupil, or if the file is there already or cannot be written. Then nothing is written: a report is there as a whole or not at all.

**Nothing is made up.** Every number stands with its sigma, one standard deviation. What was not seen well enough is `null` in
JSON, an empty cell in CSV, grey, hollow or "not known" on paper, and never 0.

**Pupils.** Attempts carry the code of who was up when they began, as it was chosen on the tablet and corrected since
([pupils](pupils.md)); reports are grouped by it and know no names. On the page each pupil begins a new sheet, on which nobody else
is. Where nobody was named it is `null` in JSON, empty in CSV, `--pupil -` on the command line.

## The page

![A page](pictures/report.png)

HTML for A4, one file without scripts and without anything from elsewhere; every browser prints it. For each pupil: how often what
was tried, the mean score, what was to be corrected most often, and the score of each attempt in the order of the lesson. For each
attempt:

- the score, what was good, and the one thing to correct; without one, what that means: that nothing was wrong is said only where
  every fault was judged, none is likely and no number is poor; else nothing was sure enough, or not enough was seen;
- the measures that the tablet shows, with what is good;
- the pupil at the four keyframes, the standard behind him as a shadow: seen from the side that leads, or from the front where the
  movement goes aside, or the difference does when something is to be corrected. How far a joint is off is shown by pattern and
  colour alike: plain is as it should be, dots a little off, stripes off; hollow with a dashed edge is not sure, what was not seen
  is not drawn. Feet and hands are never drawn, for nobody measures them. This says how surely a joint was near the standard, the
  score how well it was done as far as it was seen: [teaching](teaching.md#how-one-thing-is-chosen). Below stands how long after
  the start that was; in grey that it is not known where hips or half of the joints were not seen around the keyframe or the start;
- two angles over time, first what the cue is about, then what the tablet shows; heights, distances and speeds have no curve. The
  black line is the pupil, the dashed one the standard along the alignment. The band is as wide as a teacher's patience: half of
  the way from `good` to `fault` in the teaching file, where a cue begins; half of the range that is good, where only that is
  known; never less than 10 degrees. Where the angle is less sure than the band is wide, there is no line but hatching. How sure
  it is elsewhere stands below, by the landmark errors of [accuracy](accuracy.md) and a noise of 10 mm a joint, which is its usual
  size; a recorded attempt has no covariances. An angle that goes round is drawn in the turn that is nearest to the standard; where
  it goes further than half a turn from it, the line ends and goes on at the other edge.

The mean score's sigma is the mean of the attempts' sigmas: the errors of one pupil are alike, and more attempts make it no surer.
Where nobody was named there is no mean score: those attempts are of several pupils, and it would be taken for somebody's.

## CSV

UTF-8 with a byte order mark, a line an attempt. In English and Chinese it is as RFC 4180 has it, with a decimal point; in a German
or Spanish report cells are parted by semicolons and numbers have a decimal comma, as spreadsheets there expect: `--language`
chooses. A text that a spreadsheet would take for a formula (it begins with `=`, `+`, `-` or `@`), a date, a time or another number
(`7-2`, `07`, `1E5`; no [code](pupils.md) of today) has an apostrophe in front; from a file, spreadsheets show it.

"""
_AFTER_COLUMNS: Final = """
Then for each measure that the tablet shows in one of the attempts, `ACTION_NAME_UNIT`, `ACTION_NAME_UNIT_sigma` and
`ACTION_NAME_UNIT_verdict`, such as `squat_trunk_deg`; empty where an attempt is at another action. What two actions call the same
is measured otherwise, so each has columns of its own. `pct` is per cent of the pupil's height.

"""
_MEANINGS: Final = {
    "lesson": "as `kinebox lessons` lists it",
    "lesson_title": "what people call it",
    "day": "of the attempt, in the time zone of the machine that reports",
    "time": "likewise",
    "attempt": "counts the lesson's attempts from 1; stays the same with `--pupil`",
    "pupil": "code; empty if nobody was named",
    "action": "its name",
    "action_title": "in the report's language",
    "by": "how the action is known: `recognised` by the box, which may be wrong, or `chosen` by a person",
    "handed": "the side that leads",
    "duration_s": "from start to end, seconds; empty where either was not seen",
    "duration_s_sigma": "of that",
    "score": "0 to 100",
    "score_sigma": "of that",
    "praise": "what was good, in the report's language",
    "cue": "what to correct, likewise",
    "cue_certainty": "how likely it is that this fault was made, 0 to 1",
    "silence": "what an empty `cue` means: `fine` nothing was wrong, `unsure` nothing that is sure enough to correct, `unseen` too "
    "little was seen",
    "source": "`recorded`: as the tablet said on the day; `evaluated`: the recorded motion was evaluated again",
}
_KINDS: Final = {"string": "text", "integer": "whole number", "number": "number", "boolean": "true or false"}


def render() -> str:
    """The page."""
    definitions: dict[str, Any] = msgspec.json.schema(Report)["$defs"]
    columns = [f"| `{name}` | {_MEANINGS[name]} |" for name in COLUMNS]
    lines = (
        *("| column | meaning |", "| --- | --- |", *columns),
        _AFTER_COLUMNS.rstrip("\n"),
        f"\n## JSON, version {VERSION}\n",
        "The number of the version changes when a field is gone or means something else; new fields may come without.\n",
        *_object(Report.__name__, definitions, set()),
        "This page is written from the schema by `.venv/bin/python -m services.evaluation.report.schema_docs`; "
        "a test keeps it current.\n",
    )
    return _OPENING + "\n".join(lines)


def _object(name: str, definitions: dict[str, Any], done: set[str]) -> Iterator[str]:
    """A table of an object's fields, then the objects in it, each once."""
    if name in done:
        return
    done.add(name)
    schema = definitions[name]
    yield f"### {name}\n"
    yield f"{schema['description']}\n"
    yield "| field | value | meaning |"
    yield "| --- | --- | --- |"
    for key, field in schema["properties"].items():
        yield f"| `{key}` | {_value(field)} | {field['description']} |"
    yield ""
    for field in schema["properties"].values():
        for inner in _named(field):
            yield from _object(inner, definitions, done)


def _value(field: dict[str, Any]) -> str:
    if "anyOf" in field:
        return " or ".join(_value(one) for one in field["anyOf"])
    if "$ref" in field:
        name = _name(field)
        return f"[{name}](#{name.lower()})"
    if "enum" in field:
        return ", ".join(f"`{json.dumps(value)}`" for value in field["enum"])
    if field["type"] == "array":
        return f"list of {_value(field['items'])}"
    return "`null`" if field["type"] == "null" else _KINDS[field["type"]]


def _named(field: dict[str, Any]) -> Iterator[str]:
    if "$ref" in field:
        yield _name(field)
    for one in (*field.get("anyOf", ()), *([field["items"]] if "items" in field else [])):
        yield from _named(one)


def _name(reference: dict[str, Any]) -> str:
    return str(reference["$ref"].rsplit("/", 1)[1])


if __name__ == "__main__":
    sys.stdout.write(render())
