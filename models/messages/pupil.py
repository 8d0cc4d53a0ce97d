"""Who is up, and whose an attempt was: codes, which only the teacher can tie to a child. No message holds a name.

A code is short, has at most two letters in a row, and two only where two digits follow, so that no first name is one, not with a
digit either (EMMA2, JO2). Nor does a spreadsheet take one for a date (7-2), a number with an exponent (1E5, 7E-12) or another
pupil (07 and 7). Codes were freer once, and lessons hold those of their day: messages take both, but whoever takes a code from a
person takes only what `read_code` says.

The turn goes tablet -> evaluation, which puts the code that was in force when an attempt began into its `Feedback`. Of two turns
the later one counts, whoever tells of it and however often; so a turn may be told again after a process was started again. A
correction goes beside: it names the attempt, and what was said on the day stays as it was.
"""

import re
from collections.abc import Reversible
from typing import Annotated, Final

import msgspec
from msgspec import Meta

NOBODY: Final = ""
"""In the place of a code: no pupil is named."""
LONGEST: Final = 8
MOST_CORRECTIONS: Final = 64
CODE: Final = "(?:0|[1-9][0-9]*|[0-9]+[A-Z]|[A-Z]-?[0-9]+|[A-Z]{2}-[0-9]{2,}|[0-9]+[A-DF-Z]-[0-9]+)"
"""A code as a regular expression: 7, 7B, B12 or B-12, AB-12, 7B-12. `services/tablet/web/src/state/pupils.ts` has the same."""
EVER: Final = "([A-Z][A-Z-]*)?[0-9][A-Z0-9-]*"
"""All that has ever been one, with at least one digit."""
RULE: Final = f"a code is a number, also with a letter: 7, 7B, B12, AB-12 or 7B-12, at most {LONGEST} characters; no names are kept"

PupilCodeOrNone = Annotated[str, Meta(pattern=rf"^({EVER})?\Z", max_length=LONGEST)]
"""A code, also of an older lesson, or empty for nobody."""
Count = Annotated[int, Meta(ge=0, le=2**63 - 1)]
"""A time in nanoseconds, or a number that counts."""


def read_code(typed: str) -> str:
    """A code as a person types it, also in small letters, or with zeros before a number; ValueError says what a code is."""
    code = re.sub(r"\A0+(?=[0-9]+\Z)", "", _capitals(typed))
    if len(code) > LONGEST or not re.fullmatch(CODE, code):
        raise ValueError(f"'{typed}' is no pupil's code: {RULE}")
    return code


def spellings(typed: str) -> tuple[str, ...]:
    """How a lesson may hold the code that a person types: as it is typed, if that has ever been one, then as it is read today.

    Raises:
        ValueError: it has never been one; the reason says what a code is.
    """
    before = _capitals(typed)
    once = (before,) if len(before) <= LONGEST and re.fullmatch(EVER, before) else ()
    try:
        return tuple(dict.fromkeys((*once, read_code(typed))))
    except ValueError:
        if not once:
            raise
        return once


def _capitals(typed: str) -> str:
    """Empty if it has other letters than a code may have."""
    code = typed.strip()
    return code.upper() if code.isascii() else ""


class PupilTurn(msgspec.Struct, frozen=True):
    """Who is up from now on (tablet -> evaluation).

    Attributes:
        pupil: the code; `NOBODY` for nobody who is named.
        t_ns: CLOCK_MONOTONIC when a tablet said so.
    """

    pupil: PupilCodeOrNone
    t_ns: Count


class PupilCorrection(msgspec.Struct, frozen=True):
    """Whose an attempt was, other than was said when it ended.

    Attributes:
        attempt: `Feedback.id`.
        pupil: the code; `NOBODY` for nobody who is named.
    """

    attempt: Count
    pupil: PupilCodeOrNone


class PupilCorrections(msgspec.Struct, frozen=True):
    """All that was corrected of the newest attempts (tablet -> fusion, for its log), so that none is lost with an earlier message.

    Attributes:
        corrections: of attempts that no later message names, they stay.
    """

    corrections: Annotated[tuple[PupilCorrection, ...], Meta(max_length=MOST_CORRECTIONS)]


def pupil_at(turns: Reversible[PupilTurn], t_ns: int) -> str:
    """Who was up at an instant of CLOCK_MONOTONIC: the code of the latest turn until then; `NOBODY` before the first.

    Args:
        turns: in the order of their times.
        t_ns: the instant.
    """
    return next((turn.pupil for turn in reversed(turns) if turn.t_ns <= t_ns), NOBODY)
