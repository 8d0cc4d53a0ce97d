"""Numbers and times as people of a language write them; the same digits as on the tablet's page."""

import html
from typing import Final

from services.evaluation.report.words import Words

_UNITS: Final = {"deg": "°", "cm": " cm", "pct": " %", "m_s": " m/s", "s": " s", "deg_s": " °/s"}
_DIGITS: Final = ((0.95, 0), (0.095, 1))
"""Sigmas from here on, and how many digits after the point then say something; two below."""


def unit(name: str) -> str:
    """As it stands behind a number, with its space."""
    return _UNITS.get(name, f" {name}" if name else "")


def digits_of(sigma: float) -> int:
    """After the point: one of the uncertainty, at most two."""
    return next((digits for least, digits in _DIGITS if sigma >= least), 2)


def number(value: float, digits: int, words: Words) -> str:
    """With the language's decimal sign and a true minus; never "-0"."""
    text = f"{round(value, digits) + 0.0:.{digits}f}"
    return text.replace("-", "\u2212").replace(".", words.comma)


def estimate(value: float | None, sigma: float | None, name: str, words: Words) -> str:
    """ "62 ± 5°", or that it is not known."""
    if value is None or sigma is None:
        return words.not_known
    digits = digits_of(sigma)
    return f"{number(value, digits, words)} ± {number(sigma, digits, words)}{unit(name)}".replace(" ", "\u00a0")


def between(low: float | None, high: float | None, name: str, words: Words) -> str:
    """ "45 … 90°", or "≥ 45°"; empty without a bound."""
    ends = [None if bound is None else number(bound, 0 if bound == round(bound) else 1, words) for bound in (low, high)]
    if ends[0] is not None and ends[1] is not None:
        return f"{ends[0]}\u2009…\u2009{ends[1]}{unit(name)}"
    if ends[0] is not None:
        return f"≥\u00a0{ends[0]}{unit(name)}"
    return "" if ends[1] is None else f"≤\u00a0{ends[1]}{unit(name)}"


def clock(seconds: float) -> str:
    """Minutes and seconds, with hours where there are any."""
    minutes, rest = divmod(int(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"


def escaped(text: str) -> str:
    """A text for HTML, also within quotes."""
    return html.escape(text, quote=True)
