"""Lengths of time as people write them: 45m, 90s, 1h30m."""

import re

from models.errors import UserError

_FORM = re.compile(r"(?=\d)(?:(?P<h>\d{1,3})h)?(?:(?P<m>\d{1,5})m)?(?:(?P<s>\d{1,6})s)?")
_SECONDS = {"h": 3600.0, "m": 60.0, "s": 1.0}


def parse_duration(text: str, option: str) -> float:
    """Seconds.

    Args:
        text: hours, minutes and seconds, each a whole number with its letter, in this order.
        option: whose value it is, for the error.

    Raises:
        UserError: it is no such length, or none at all.
    """
    match = _FORM.fullmatch(text.strip())
    seconds = sum(_SECONDS[unit] * int(number) for unit, number in match.groupdict("0").items()) if match else 0.0
    if seconds <= 0:
        raise UserError(f"{option}: '{text}' is no length of time; write it as 45m, 90s or 1h30m")
    return seconds


def clock(seconds: float) -> str:
    """Minutes and seconds, with hours where there are any: "12:03", "1:02:05"."""
    minutes, rest = divmod(int(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"
