"""Texts as every spreadsheet keeps them.

A text that begins like a formula is taken for one, and run ("CSV injection", OWASP). One that looks like a date, a time or a number
is taken for that: pupil 7-2, as lessons of before may have, becomes the 7th of February, 1E5 becomes 100000, and 07 pupil 7. Such
texts get an apostrophe in front. Spreadsheets show it when it comes from a file, but nothing else keeps a text in all of them, and
readable for programs. Plain whole numbers stay what they are, for they look the same as numbers.
"""

import re
from typing import Final

_FORMULA: Final = tuple("=+-@\uff1d\uff0b\uff0d\uff20")
"""Formulas begin with one of these, narrow or wide."""
_PLAIN: Final = re.compile(r"0|[1-9][0-9]{0,10}")
"""A whole number that is shown as it is; with more digits it would have an exponent."""
_EXPONENT: Final = re.compile(r"\d+([.,]\d*)?e[+-]?\d+", re.IGNORECASE)
_NOON: Final = re.compile(r"\d+(:\d+)*(\s+[ap]|\s*[ap]\.?m\.?)", re.IGNORECASE)
"""A time before or after it."""
_DATE: Final = 3
"""So many numbers has one at most; a time beside it has colons."""
_IN_DATES: Final = frozenset(
    (
        *("january", "february", "march", "april", "may", "june", "july", "august", "september", "october", "november", "december"),
        *("jan", "feb", "mar", "apr", "jun", "jul", "aug", "sep", "sept", "oct", "nov", "dec"),
        *("januar", "jänner", "februar", "märz", "mai", "juni", "juli", "oktober", "dezember", "mär", "mrz", "okt", "dez"),
        *("enero", "febrero", "marzo", "abril", "mayo", "junio", "julio", "agosto", "septiembre", "setiembre", "octubre"),
        *("noviembre", "diciembre", "ene", "abr", "ago", "dic", "de"),
        *"年月日号时分秒",
    )
)
"""Words that stand in them, in the languages of reports."""


def kept(text: str) -> str:
    """A text in one line, with an apostrophe in front if a spreadsheet would make something else of it."""
    # What is not printed may be skipped before a formula, and a line's end within a cell breaks many a reader.
    line = " ".join(text.split())
    plain = "".join(character for character in line if character.isprintable())
    return f"'{plain}" if plain.lstrip().startswith(_FORMULA) or _is_like_a_number(plain.strip()) else plain


def _is_like_a_number(text: str) -> bool:
    if _PLAIN.fullmatch(text):
        return False
    if _EXPONENT.fullmatch(text) or _NOON.fullmatch(text):
        return True
    numbers, words = re.findall(r"\d+", text), re.findall(r"[^\W\d_]+", text.casefold())
    # Alone, the Spanish "of" makes no date: DE-12 is a pupil.
    of_a_date = _IN_DATES.issuperset(words) and set(words) != {"de"}
    return len(numbers) > 0 and (len(numbers) <= _DATE or ":" in text) and of_a_date
