"""A report as CSV, for the gradebook: a line an attempt, RFC 4180, UTF-8 with a byte order mark.

A spreadsheet takes a text that begins like a formula for one, and runs it ("CSV injection", OWASP): such texts get an apostrophe in
front, which spreadsheets know as the sign of a text. Numbers stay numbers. What is not known is an empty cell.
"""

import csv
import datetime as dt
import io
from collections.abc import Sequence
from typing import Final

from services.evaluation.report.document import Attempt, Measure, Report

_BOM: Final = "\ufeff"
_FORMULA: Final = tuple("=+-@\uff1d\uff0b\uff0d\uff20")
"""Formulas begin with one of these, narrow or wide."""
COLUMNS: Final = (
    *(
        "lesson",
        "lesson_title",
        "day",
        "time",
        "attempt",
        "pupil",
        "action",
        "action_title",
        "handed",
        "duration_s",
        "duration_s_sigma",
    ),
    *("score", "score_sigma", "praise", "cue", "cue_certainty"),
)
"""What every report has; after them come three for each measure that was shown, in the lesson's order."""
_SQRT_2: Final = 2**0.5


def encode(report: Report) -> bytes:
    """The file. Of the measures those that the tablet shows; JSON has all."""
    shown = dict.fromkeys(
        (measure.name, measure.unit) for attempt in report.attempts for measure in attempt.measures if measure.shown
    )
    head = list(COLUMNS)
    for name, unit in shown:
        head += [f"{name}_{unit}", f"{name}_{unit}_sigma", f"{name}_{unit}_verdict"]
    file = io.StringIO(newline="")
    writer = csv.writer(file, lineterminator="\r\n")
    writer.writerow([_cell(name) for name in head])
    for attempt in report.attempts:
        writer.writerow([*_about(report, attempt), *_measured(attempt, list(shown))])
    return (_BOM + file.getvalue()).encode()


def _about(report: Report, attempt: Attempt) -> list[str]:
    times, begun = attempt.keyframes_s, dt.datetime.fromisoformat(attempt.begun)
    return [
        _cell(report.lesson.name),
        _cell(report.lesson.title),
        f"{begun:%Y-%m-%d}",
        f"{begun:%H:%M:%S}",
        str(attempt.number),
        _cell(attempt.pupil or ""),
        _cell(attempt.action),
        _cell(attempt.title or ""),
        _cell(attempt.handed),
        _number(times.end - times.start),
        _number(times.sigma * _SQRT_2),
        _number(attempt.score),
        _number(attempt.score_sigma),
        _cell("" if attempt.praise is None else attempt.praise.text or attempt.praise.point),
        _cell("" if attempt.cue is None else attempt.cue.text or attempt.cue.fault),
        _number(None if attempt.cue is None else attempt.cue.certainty),
    ]


def _measured(attempt: Attempt, names: Sequence[tuple[str, str]]) -> list[str]:
    measures = {(measure.name, measure.unit): measure for measure in attempt.measures if measure.shown}
    return [cell for name in names for cell in _cells(measures.get(name))]


def _cells(measure: Measure | None) -> list[str]:
    if measure is None:
        return ["", "", ""]
    return [_number(measure.value), _number(measure.sigma), "" if measure.verdict == "unknown" else _cell(measure.verdict)]


def _number(value: float | None) -> str:
    """With a point, and without what no measure tells."""
    return "" if value is None else f"{round(value, 3) + 0.0:.3f}".rstrip("0").rstrip(".")


def _cell(text: str) -> str:
    """A text that no spreadsheet computes."""
    # What is not printed may be skipped before a formula, and a line's end within a cell breaks many a reader.
    line = " ".join(text.split())
    plain = "".join(character for character in line if character.isprintable())
    return f"'{plain}" if plain.lstrip().startswith(_FORMULA) else plain
