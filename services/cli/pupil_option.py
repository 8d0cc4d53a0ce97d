"""`--pupil`: a pupil's code as people type it on the command line."""

from collections.abc import Callable
from typing import TypeVar

from models.errors import UserError
from models.messages.pupil import read_code, spellings
from services.evaluation.report.sheet import NOBODY as NOBODY_ON_PAPER

Read = TypeVar("Read")


def written(typed: str) -> str:
    """A code that is put into a file; UserError says what a code is."""
    return _read(read_code, typed, "")


def sought(typed: str) -> tuple[str, ...]:
    """The codes by which a lesson may hold the attempts that are asked for, the likeliest first; UserError as above."""
    if typed == NOBODY_ON_PAPER:
        return (typed,)
    return _read(spellings, typed, f"; {NOBODY_ON_PAPER} stands for nobody")


def _read(read: Callable[[str], Read], typed: str, nobody: str) -> Read:
    try:
        return read(typed)
    except ValueError as error:
        raise UserError(f"--pupil: {error}{nobody}") from error
