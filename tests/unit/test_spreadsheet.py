"""What stands in the gradebook's file is what the spreadsheet shows: no text becomes a date, another number or another pupil."""

import csv
import io
import json
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.messages.pupil import CODE, EVER, LONGEST
from services.evaluation.report import csv_file
from services.evaluation.report.spreadsheet import kept
from tests.installed import ROOT
from tests.reported import attempt, sheet

CASES = json.loads((ROOT / "tests/golden/pupil_codes/codes.json").read_text())
DATES = (
    *("7-2", "07", "7-12", "1-12-24", "1/2", "7.2", "7.", "2026-11-23", "2026-11-23 10:05:12", "23.11.2026", "10:30", "7 a"),
    *("JAN7", "MAR-7", "7mar", "May 7", "7. Mai", "7. Dez. 2026", "7 de mayo", "März 2026", "7月2日", "2026年11月"),
    *("7:00 pm", "1E5", "2e10", "7E-12", "1,5", "50 %", "(7)", "1 234", "123456789012", "\u0667-\u0662", "12 am", "3 p.m."),
)
TEXTS = (
    *("7b", "8A", "7 b, throwing", "Judo 3", "7B-12", "AB-12", "P07", "A-1", "7E", "E5", "7", "0", "12345678", "2026-11-20-7b"),
    *(
        "2026-11-20-1005",
        "2026-11-20-1005-2",
        "May",
        "de",
        "",
        "Klasse 7 im Mai",
        "Marathon 7",
        "学生 7",
        "April-Sprünge 2",
        "DE-12",
    ),
)


def pupils(*codes: str) -> list[str]:
    """As the gradebook has them, of one attempt each."""
    data = csv_file.encode(sheet(*((attempt(), code) for code in codes)).report)
    return [row["pupil"] for row in csv.DictReader(io.StringIO(data.decode("utf-8-sig"), newline=""))]


@pytest.mark.parametrize("text", DATES)
def test_what_looks_like_a_date_a_time_or_another_number_stays_a_text(text: str) -> None:
    assert kept(text) == f"'{text}"


@pytest.mark.parametrize("text", TEXTS)
def test_what_every_spreadsheet_keeps_is_left_as_it_is(text: str) -> None:
    assert kept(text) == text


def test_pupils_of_a_lesson_with_older_codes_stay_apart() -> None:
    assert pupils("07", "7", "7-2", "7-12", "1E5", "EMMA2") == ["'07", "7", "'7-2", "'7-12", "'1E5", "EMMA2"]


def test_every_code_that_is_taken_today_stands_in_the_gradebook_as_it_is() -> None:
    codes = list(dict.fromkeys(case["code"] for case in CASES if case["code"] is not None))
    assert pupils(*codes) == codes


@given(st.from_regex(rf"\A{CODE}\Z").filter(lambda code: len(code) <= LONGEST))
def test_no_code_that_is_taken_today_needs_an_apostrophe(code: str) -> None:
    assert kept(code) == code


@given(st.one_of(st.from_regex(rf"\A{EVER}\Z"), st.from_regex(r"\A([0-9]{1,4}-[0-9]{1,4}|[0-9]{1,4}E-?[0-9]{1,3}|0[0-9]{1,7})\Z")))
def test_whatever_has_ever_been_a_code_is_no_date_no_exponent_and_no_other_pupil_in_the_gradebook(code: str) -> None:
    cell = kept(code)
    assert cell in {code, f"'{code}"}
    assert re.fullmatch(r"\d+-\d+|\d+-\d+-\d+|0\d+|\d+E-?\d+", cell) is None
