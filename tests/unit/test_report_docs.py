"""docs/report.md says what the code writes."""

import re
from pathlib import Path

import msgspec

from services.evaluation.report import json_file
from services.evaluation.report.csv_file import COLUMNS
from services.evaluation.report.schema_docs import render
from tests.reported import attempt, sheet

PAGE = Path(__file__).parents[2] / "docs/report.md"


def test_the_page_about_reports_is_current() -> None:
    assert PAGE.read_text() == render(), "run `python -m services.evaluation.report.schema_docs > docs/report.md`"


def test_every_field_of_a_report_is_described() -> None:
    told = attempt(cue="no_knee_bend", cue_certainty=0.9, praise="elbow_out")
    document = msgspec.json.decode(json_file.encode(sheet(told).report))
    described = set(re.findall(r"^\| `(\w+)` \|", PAGE.read_text(), re.MULTILINE))

    def names(value: object) -> set[str]:
        inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
        return set(value if isinstance(value, dict) else ()).union(*map(names, inner))

    assert names(document) | set(COLUMNS) <= described
