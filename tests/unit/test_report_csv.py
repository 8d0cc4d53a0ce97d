"""The gradebook's file opens in a spreadsheet, computes nothing there, and has no number where nothing is known."""

import csv
import io
from dataclasses import replace
from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.messages.feedback import MeasureResult
from models.teaching.measure import Phase
from models.teaching.schema import Language
from services.evaluation.report import csv_file
from services.evaluation.report.csv_file import COLUMNS
from services.evaluation.report.document import Report
from services.evaluation.report.sheet import Tried, sheet_of
from tests.reported import FACTS, attempt, sheet
from tests.taught import shipped


def rows(report: Report) -> list[dict[str, str]]:
    file = io.StringIO(csv_file.encode(report).decode("utf-8-sig"), newline="")
    return list(csv.DictReader(file, delimiter=";" if report.language in {"de", "es"} else ","))


def reported(title: str) -> Report:
    """A lesson of such a title, by a pupil of such a code."""
    told = attempt(score=70.0, score_sigma=5.0)
    return sheet_of(replace(FACTS, title=title), [Tried(told, title or "-")], shipped().teachings, "en").report


def test_it_begins_with_a_byte_order_mark_and_its_lines_end_as_rfc_4180_wants() -> None:
    data = csv_file.encode(sheet(attempt(), attempt("squat"), language="zh").report)
    assert data.startswith(b"\xef\xbb\xbflesson,")
    lines = data.decode("utf-8-sig").split("\r\n")
    assert len(lines) == 4
    assert lines[-1] == ""
    assert "\n" not in data.decode().replace("\r\n", "")
    assert shipped().teachings["squat"].title.zh in lines[2]


def test_every_line_has_all_columns() -> None:
    report = sheet(attempt(), attempt("squat"), attempt("long_jump")).report
    table = list(csv.reader(io.StringIO(csv_file.encode(report).decode("utf-8-sig"), newline="")))
    measures = {(one.action, measure.name) for one in report.attempts for measure in one.measures}
    assert {len(line) for line in table} == {len(COLUMNS) + 3 * len(measures)}
    assert tuple(table[0][: len(COLUMNS)]) == COLUMNS
    assert len(set(table[0])) == len(table[0])


def test_a_number_has_its_sigma_in_a_column_of_its_own() -> None:
    measures = (
        MeasureResult("knee_bend", -12.25, 3.5, "deg", "poor", 45, 90),
        MeasureResult("hand_height", 0.0, 0.9, "pct", "fair"),
    )
    (row,) = rows(sheet(attempt(measures=measures, shown=("knee_bend", "hand_height"), score=70.0, score_sigma=5.5)).report)
    assert (row["score"], row["score_sigma"]) == ("70", "5.5")
    assert (
        row["basketball_shot_knee_bend_deg"],
        row["basketball_shot_knee_bend_deg_sigma"],
        row["basketball_shot_knee_bend_deg_verdict"],
    ) == ("-12.25", "3.5", "poor")
    assert (row["basketball_shot_hand_height_pct"], row["basketball_shot_hand_height_pct_sigma"]) == ("0", "0.9")
    assert float(row["duration_s"]) > 0
    assert float(row["duration_s_sigma"]) == pytest.approx(0.028, abs=1e-3)


def test_what_is_not_known_is_empty_and_never_nought() -> None:
    measures = (MeasureResult("knee_bend", None, None, "deg", "unknown", 45, 90),)
    told = attempt(measures=measures, shown=("knee_bend",), score=None, score_sigma=None, cue="", cue_certainty=0.0, praise="")
    (row,) = rows(sheet(told).report)
    names = (
        "basketball_shot_knee_bend_deg",
        "basketball_shot_knee_bend_deg_sigma",
        "basketball_shot_knee_bend_deg_verdict",
        "score",
        "score_sigma",
        "cue",
        "cue_certainty",
        "praise",
        "pupil",
    )
    assert {row[name] for name in names} == {""}


@pytest.mark.parametrize("unseen", [("start",), ("end",)])
def test_the_length_of_an_attempt_whose_start_or_end_nobody_saw_is_not_known(unseen: tuple[Phase, ...]) -> None:
    (row,) = rows(sheet(attempt(keyframes_unseen=unseen)).report)
    assert (row["duration_s"], row["duration_s_sigma"]) == ("", "")


def test_an_empty_cue_says_what_it_means() -> None:
    silent: dict[str, Any] = {"cue": "", "cue_certainty": 0.0, "praise": ""}
    told = (
        attempt(cue="no_knee_bend", cue_certainty=0.9, praise=""),
        attempt(**silent, score=90.0, score_sigma=3.0),
        attempt(**silent, score=None, score_sigma=None),
    )
    assert [row["silence"] for row in rows(sheet(*told).report)] == ["", "unsure", "unseen"]


def test_measures_of_other_actions_are_empty() -> None:
    shot, squat = rows(sheet(attempt(), attempt("squat")).report)
    assert shot["basketball_shot_knee_bend_deg"] != ""
    assert squat["basketball_shot_knee_bend_deg"] == shot["squat_knee_bend_deg"] == ""
    assert squat["squat_knee_bend_deg"] != ""
    only_squat = [name for name in squat if squat[name] and not shot[name] and name.endswith("_sigma")]
    assert only_squat != []


@pytest.mark.parametrize("language", ["de", "es"])
def test_a_german_or_spanish_spreadsheet_opens_it_in_columns_and_with_its_numbers(language: Language) -> None:
    measures = (MeasureResult("knee_bend", -12.25, 3.5, "deg", "poor", 45, 90),)
    told = attempt(measures=measures, shown=("knee_bend",), score=70.5, score_sigma=5.25)
    report = sheet_of(replace(FACTS, title="7b; Würfe, weit"), [Tried(told)], shipped().teachings, language).report
    (row,) = rows(report)
    assert (row["score"], row["score_sigma"], row["basketball_shot_knee_bend_deg"]) == ("70,5", "5,25", "-12,25")
    assert row["lesson_title"] == "7b; Würfe, weit"
    assert b"70.5" not in csv_file.encode(report)


def test_it_says_how_the_action_is_known_and_where_the_attempts_are_from() -> None:
    report = sheet(attempt(by="recognised"), attempt(by="chosen")).report
    assert [(row["by"], row["source"]) for row in rows(report)] == [("recognised", "recorded"), ("chosen", "recorded")]


FORMULAS = (
    *('=HYPERLINK("http://x","y")', "+1+1", "-1+1", "@SUM(A1)", "\t=1+1", " =1+1"),
    *("\u200b=1+1", "\uff1d1+1", "\r\n=1"),
)


@pytest.mark.parametrize("text", FORMULAS)
def test_no_text_is_a_formula(text: str) -> None:
    (row,) = rows(reported(text))
    assert row["lesson_title"].startswith("'")
    assert row["pupil"].startswith("'")


@given(st.text(max_size=40))
def test_whatever_people_call_things_the_file_is_read_back_in_whole_lines(text: str) -> None:
    (row,) = rows(reported(text.encode("utf-8", "replace").decode()))
    assert None not in row
    assert row["lesson"] == FACTS.name
    assert row["score"] == "70"
    assert not row["lesson_title"].lstrip().startswith(("=", "+", "-", "@"))


def test_quotes_commas_and_umlauts_survive() -> None:
    (row,) = rows(reported('7b, "Würfe"'))
    assert row["lesson_title"] == row["pupil"] == '7b, "Würfe"'


def test_only_shown_measures_are_in_it_and_json_has_all() -> None:
    told = attempt()
    (row,) = rows(sheet(msgspec.structs.replace(told, shown=told.shown[:1])).report)
    assert [name for name in row if name.endswith("_verdict")] == ["basketball_shot_knee_bend_deg_verdict"]
