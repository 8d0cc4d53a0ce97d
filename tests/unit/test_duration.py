"""Lengths of time, as people write and read them."""

import pytest

from models.errors import UserError
from services.cli.duration import clock, parse_duration


@pytest.mark.parametrize(("text", "seconds"), [("45m", 2700), ("90s", 90), ("1h30m", 5400), (" 2h ", 7200), ("1h2m3s", 3723)])
def test_a_length_is_read_as_it_is_written(text: str, seconds: float) -> None:
    assert parse_duration(text, "--for") == seconds


@pytest.mark.parametrize("text", ["", "45", "m", "-5m", "0s", "1.5h", "30m1h", "45 minutes", "5m5m", "99999999s"])
def test_what_is_no_length_is_refused_with_an_example(text: str) -> None:
    with pytest.raises(UserError, match=r"--for: '.*' is no length of time; write it as 45m"):
        parse_duration(text, "--for")


@pytest.mark.parametrize(("seconds", "text"), [(0, "0:00"), (59.9, "0:59"), (723, "12:03"), (3725, "1:02:05")])
def test_a_clock_shows_hours_only_where_there_are_any(seconds: float, text: str) -> None:
    assert clock(seconds) == text
