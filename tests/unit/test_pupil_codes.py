"""Codes of pupils: what is one, that no name is one, and who was up when."""

import json
import re
from itertools import product
from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from models.messages.pupil import CODE, EVER, LONGEST, NOBODY, RULE, PupilTurn, pupil_at, read_code, spellings
from services.tablet.messages import Turn
from tests.installed import ROOT

CASES: list[dict[str, Any]] = json.loads((ROOT / "tests/golden/pupil_codes/codes.json").read_text())
CODES = [case["code"] for case in CASES if case["code"] is not None]
NAMES = (
    *("Anna", "Emma", "Leon", "Mia", "Max", "Ben", "Tim", "Eva", "Ida", "Kim", "Noa", "Wei", "Lucia", "Jos\u00e9", "Christopher"),
    *("Jo", "Bo", "Al", "Ed", "Li", "Yu", "An", "Ty"),
    *("L-Meier", "Max-B", "AnnaB"),
)
OLDER = ("07", "7-12", "1E5", "EMMA2", "P-07", "ABCDEF99", "7B12", "MAR-7")
"""Codes that were taken once, and that lessons hold."""


@pytest.mark.parametrize("case", CASES, ids=lambda case: repr(case["typed"]))
def test_a_code_is_read_as_people_type_it(case: dict[str, Any]) -> None:
    """`services/tablet/web/tests/pupils.test.ts` reads the same table."""
    if case["code"] is None:
        with pytest.raises(ValueError, match=re.escape(f"'{case['typed']}' is no pupil's code: {RULE}")):
            read_code(case["typed"])
    else:
        assert read_code(case["typed"]) == case["code"]
        assert read_code(case["code"]) == case["code"], "a code is its own"


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("digit", ["1", "2", "9"])
def test_no_first_name_is_a_code_with_a_digit_before_behind_or_within_it_either(name: str, digit: str) -> None:
    within = [name[:place] + digit + name[place:] for place in range(len(name) + 1)]
    for typed in (name, *within, f"{name}-{digit}", f"{digit}-{name}", f"{name} {digit}", f"{name}{digit}{digit}"):
        for written in (typed, typed.upper(), typed.lower()):
            with pytest.raises(ValueError, match="no names are kept"):
                read_code(written)


def test_no_name_of_three_letters_is_a_code_also_if_a_letter_of_it_is_written_as_a_digit() -> None:
    for letters in product("AEIMT", repeat=3):
        for place in range(3):
            written = "".join("0" if number == place else letter for number, letter in enumerate(letters))
            assert re.fullmatch(CODE, written) is None


@given(st.from_regex(rf"\A{CODE}\Z").filter(lambda code: len(code) <= LONGEST))
def test_whatever_is_a_code_is_none_that_a_spreadsheet_changes(code: str) -> None:
    assert re.fullmatch(r"\d+-\d+|0\d+|\d+E-?\d+|[-+=@].*|.*[A-Z]{3}.*", code) is None
    assert re.fullmatch(EVER, code), "a KineBox of before reads it in a lesson"
    assert read_code(code.lower()) == code
    assert msgspec.convert({"pupil": code, "t_ns": 1}, PupilTurn).pupil == code


@pytest.mark.parametrize("case", CASES, ids=lambda case: repr(case["typed"]))
def test_a_tablet_may_only_say_what_is_a_code(case: dict[str, Any]) -> None:
    if case["code"] is not None:
        assert Turn(type="turn", pupil=case["code"]).pupil == case["code"]
    if case["code"] != case["typed"]:
        with pytest.raises(ValidationError, match="pupil"):
            Turn(type="turn", pupil=case["typed"])


@pytest.mark.parametrize("code", [*CODES, *OLDER, NOBODY])
def test_a_lesson_may_hold_every_code_that_has_ever_been_one(code: str) -> None:
    assert msgspec.convert({"pupil": code, "t_ns": 1}, PupilTurn).pupil == code


@pytest.mark.parametrize(
    "code", [*("ANNA", "B", "-", "-7", "7 B", "123456789", "ABCDEFGH9", "7\n", "7.", "\u00c47", "\u0667", "7\u200b", "=1"),
             *("b12", " 7", None, 7)]
)  # fmt: skip
def test_what_has_never_been_a_code_is_in_no_message(code: object) -> None:
    with pytest.raises(msgspec.ValidationError, match="pupil"):
        msgspec.convert({"pupil": code, "t_ns": 1}, PupilTurn)


@pytest.mark.parametrize(
    ("typed", "held"),
    [
        *(("07", ("07", "7")), ("7", ("7",)), (" b12", ("B12",)), ("7-12", ("7-12",)), ("emma2", ("EMMA2",))),
        ("000000007", ("7",)),
    ],
)
def test_a_pupil_of_an_older_lesson_is_asked_for_as_the_code_was_then(typed: str, held: tuple[str, ...]) -> None:
    assert spellings(typed) == held


@pytest.mark.parametrize("typed", ["Anna", "", "-7", "EMMANUEL2", "\u01317"])
def test_for_what_has_never_been_a_code_nobody_looks(typed: str) -> None:
    with pytest.raises(ValueError, match="is no pupil's code"):
        spellings(typed)


@pytest.mark.parametrize("t_ns", [-1, 2**63])
def test_a_turn_at_a_time_that_no_clock_gives_is_refused(t_ns: int) -> None:
    with pytest.raises(msgspec.ValidationError, match="t_ns"):
        msgspec.convert({"pupil": "7", "t_ns": t_ns}, PupilTurn)


def test_who_was_up_is_the_one_of_the_latest_turn_until_then() -> None:
    turns = [PupilTurn("7", 100), PupilTurn("8", 200), PupilTurn(NOBODY, 300)]
    assert [pupil_at(turns, t_ns) for t_ns in (99, 100, 199, 200, 299, 300, 10**18)] == ["", "7", "7", "8", "8", "", ""]
    assert pupil_at([], 5) == NOBODY
