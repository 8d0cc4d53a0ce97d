"""A report as CSV, for the gradebook: a line an attempt, cells quoted as RFC 4180 has it, UTF-8 with a byte order mark.

Where people write a decimal comma, spreadsheets expect it in the file, and a semicolon in the place of RFC 4180's comma. Numbers
are numbers, and texts stay texts (`services.evaluation.report.spreadsheet`). What is not known is an empty cell.
"""

import csv
import datetime as dt
import io
from collections.abc import Sequence
from typing import Final

from services.evaluation.report.document import Attempt, Measure, Report
from services.evaluation.report.spreadsheet import kept
from services.evaluation.report.words import WORDS

_BOM: Final = "\ufeff"
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
        "by",
        "handed",
        "duration_s",
        "duration_s_sigma",
    ),
    *("score", "score_sigma", "praise", "cue", "cue_certainty", "silence", "source"),
)
"""What every report has; after them come three for each measure that was shown, in the lesson's order."""
_SQRT_2: Final = 2**0.5


def encode(report: Report) -> bytes:
    """The file. Of the measures those that the tablet shows; JSON has all."""
    shown = dict.fromkeys(_column(attempt, one) for attempt in report.attempts for one in attempt.measures if one.shown)
    head = list(COLUMNS)
    for column in shown:
        head += [column, f"{column}_sigma", f"{column}_verdict"]
    comma = WORDS[report.language].comma
    file = io.StringIO(newline="")
    writer = csv.writer(file, delimiter=";" if comma == "," else ",", lineterminator="\r\n")
    writer.writerow([kept(name) for name in head])
    for attempt in report.attempts:
        writer.writerow([*_about(report, attempt, comma), *_measured(attempt, list(shown), comma)])
    return (_BOM + file.getvalue()).encode()


def _column(attempt: Attempt, measure: Measure) -> str:
    """With the action: what another one calls the same is measured otherwise."""
    return f"{attempt.action}_{measure.name}_{measure.unit}"


def _about(report: Report, attempt: Attempt, comma: str) -> list[str]:
    times, begun = attempt.keyframes_s, dt.datetime.fromisoformat(attempt.begun)
    timed = {"start", "end"}.isdisjoint(times.unseen)
    return [
        kept(report.lesson.name),
        kept(report.lesson.title),
        f"{begun:%Y-%m-%d}",
        f"{begun:%H:%M:%S}",
        str(attempt.number),
        kept(attempt.pupil or ""),
        kept(attempt.action),
        kept(attempt.title or ""),
        kept(attempt.by),
        kept(attempt.handed),
        _number(times.end - times.start if timed else None, comma),
        _number(times.sigma * _SQRT_2 if timed else None, comma),
        _number(attempt.score, comma),
        _number(attempt.score_sigma, comma),
        kept("" if attempt.praise is None else attempt.praise.text or attempt.praise.point),
        kept("" if attempt.cue is None else attempt.cue.text or attempt.cue.fault),
        _number(None if attempt.cue is None else attempt.cue.certainty, comma),
        kept(attempt.silence or ""),
        kept(report.source),
    ]


def _measured(attempt: Attempt, columns: Sequence[str], comma: str) -> list[str]:
    measures = {_column(attempt, measure): measure for measure in attempt.measures if measure.shown}
    return [cell for column in columns for cell in _cells(measures.get(column), comma)]


def _cells(measure: Measure | None, comma: str) -> list[str]:
    if measure is None:
        return ["", "", ""]
    verdict = "" if measure.verdict == "unknown" else kept(measure.verdict)
    return [_number(measure.value, comma), _number(measure.sigma, comma), verdict]


def _number(value: float | None, comma: str) -> str:
    """Without what no measure tells."""
    return "" if value is None else f"{round(value, 3) + 0.0:.3f}".rstrip("0").rstrip(".").replace(".", comma)
