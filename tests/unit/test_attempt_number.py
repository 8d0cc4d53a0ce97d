"""Who names an attempt that there is not is told what else could count, where there is anything else."""

from pathlib import Path

import pytest

from models.errors import UserError
from services.cli.attempt_number import require_attempt
from services.evaluation.report.document import Source


@pytest.mark.parametrize(
    ("source", "again", "others"),
    [
        ("recorded", False, r" \(with --again, those that are found anew count\)"),
        ("evaluated", True, r" \(without --again, those of the day count\)"),
        ("evaluated", False, ""),
    ],
    ids=["those of the day", "those of now", "those of now, as there are none of the day"],
)
def test_the_attempts_that_there_are_are_named_and_which_others_could_be(source: Source, again: bool, others: str) -> None:
    with pytest.raises(UserError, match=rf"^lesson a\.mcap has no attempt 9; it has 1-2{others}$"):
        require_attempt([1, 2], 9, Path("a.mcap"), "leave out --attempt", source, again=again)
