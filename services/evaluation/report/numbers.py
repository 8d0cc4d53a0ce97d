"""Numbers and times as people of a language write them; the same digits as on the tablet's page."""

import html
from decimal import ROUND_HALF_UP, Context, Decimal
from typing import Final

from services.evaluation.report.words import Words

_UNITS: Final = {"deg": "°", "cm": " cm", "pct": " %", "m_s": " m/s", "s": " s", "deg_s": " °/s"}
_OF_HEIGHT: Final = "pct"
_EXACT: Final = Context(prec=400, rounding=ROUND_HALF_UP)
"""Every float has room in it."""
_DIGITS: Final = ((0.95, 0), (0.095, 1))
"""Sigmas from here on, and how many digits after the point then say something; two below."""


def unit(name: str) -> str:
    """As it stands behind a number, with its space."""
    return _UNITS.get(name, f" {name}" if name else "")


def whole_unit(name: str, words: Words) -> str:
    """The same with what it is of, where it does not say so itself."""
    return f"{unit(name)} {words.of_height}" if name == _OF_HEIGHT else unit(name)


def digits_of(sigma: float) -> int:
    """After the point: one of the uncertainty, at most two."""
    return next((digits for least, digits in _DIGITS if sigma >= least), 2)


def number(value: float, digits: int, words: Words) -> str:
    """With the language's decimal sign and a true minus; halves away from nought, as browsers have it; never "-0"."""
    rounded = Decimal(float(value)).quantize(Decimal(1).scaleb(-digits), context=_EXACT)
    return _written(f"{abs(rounded) if rounded.is_zero() else rounded:f}", words)


def estimate(value: float | None, sigma: float | None, name: str, words: Words) -> str:
    """ "62 ± 5°", or that it is not known."""
    if value is None or sigma is None:
        return words.not_known
    digits = digits_of(sigma)
    return f"{number(value, digits, words)} ± {number(sigma, digits, words)}{unit(name)}".replace(" ", "\u00a0")


def between(low: float | None, high: float | None, name: str, words: Words) -> str:
    """ "45 … 90°", or "≥ 45°"; empty without a bound. Bounds are what somebody has written, and stand here as they are."""
    ends = [None if bound is None else _written(f"{bound + 0.0:.6g}", words) for bound in (low, high)]
    behind = whole_unit(name, words)
    if ends[0] is not None and ends[1] is not None:
        return f"{ends[0]}\u2009…\u2009{ends[1]}{behind}"
    if ends[0] is not None:
        return f"≥\u00a0{ends[0]}{behind}"
    return "" if ends[1] is None else f"≤\u00a0{ends[1]}{behind}"


def _written(text: str, words: Words) -> str:
    return text.replace("-", "\u2212").replace(".", words.comma)


def clock(seconds: float) -> str:
    """Minutes and seconds, with hours where there are any."""
    minutes, rest = divmod(int(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"


def escaped(text: str) -> str:
    """A text for HTML, also within quotes."""
    return html.escape(text, quote=True)
