"""Finds secrets that a text tells: values behind keys, in headers and in addresses. In doubt it takes too much. Pure.

A value ends where its quotes or brackets close, or with its word if it has none; one that never closes goes on to the end,
since the line was torn. Of a pass phrase of several words without quotes only the first word is known to be one.
"""

import re

SECRET_KEYS = (
    *("password", "passwd", "passphrase", "pass", "pwd", "pw", "pin", "psk"),
    *("secret", "token", "credential", "api_?key", "private_?key", "access_?key", "authorization", "bearer", "cookie"),
)
"""As regular expressions."""
SECRET = "[secret]"  # noqa: S105 - what stands in for one

_PARTS = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])|[-.\s]+")
_NAMES_SECRET = re.compile(rf"(?:^|_)(?:{'|'.join(SECRET_KEYS)})s?\d*(?:$|_)", re.IGNORECASE)
# Possessive, so that no text takes longer than its length. A text within a text has backslashes before its quotes.
# What joins a key and its value: a sign; or a space, behind which is a quote, or before which is an option of a command line.
_KEY = re.compile(
    r"(?<![\w.-])(?:((--)?(?:(?:api|private|access)\s)?[\w.-]++)"
    r"(?:\\*+['\"]?\s*+(?:=>|:=|[=:])\s*+|\s++(?=\\*+['\"])|(?(2)\s++(?!--)|(?!)))|bearer\s++)",
    re.IGNORECASE,
)
_QUOTE = re.compile(r"[bBrRuUfF]{0,2}(\\*+)(['\"])")
_BACKSLASHES_AND_QUOTE = {quote: re.compile(rf"(\\*+){quote}") for quote in "'\""}
_IN_ADDRESS = re.compile(r"(?<=://)[^\s'\"]{0,300}@")
_HEADERS = ("authorization", "cookie")
_ENDS_WORD = re.compile(r"['\"](?=[\s,;:\])}]|$)|\\+['\"](?=[\s,;:\])}]|$)|\s")
_BRACKETS = re.compile(r"[\[\](){}]|\\*['\"]")


def names_secret(key: str) -> bool:
    """Whether a value of that name must not be told: "wifi_password", "apiToken", "X-Api-Key"."""
    return _NAMES_SECRET.search(_PARTS.sub("_", key)) is not None


def without_secrets(text: str) -> str:
    """The text with `SECRET` in the place of each."""
    text = _IN_ADDRESS.sub(f"{SECRET}@", text)
    kept, done = [], 0
    while (key := _KEY.search(text, done)) is not None:
        end = _value_end(text, key) if key[1] is None or names_secret(key[1]) else key.end()
        kept += [text[done : key.end()], SECRET if end > key.end() else ""]
        done = end
    return "".join(kept) + text[done:]


def _value_end(text: str, key: re.Match[str]) -> int:
    begin = key.end()
    if (quote := _QUOTE.match(text, begin)) is not None:
        return _quoted_end(text, quote)
    if text[begin : begin + 1] in ("[", "{", "("):
        return _bracketed_end(text, begin)
    if key[1] is not None and key[1].lower().endswith(_HEADERS):
        return begin + len(text[begin:].partition("\n")[0])
    ends = _ENDS_WORD.search(text, begin)
    word = text[begin : len(text) if ends is None else ends.start()]
    return begin + len(word.rstrip(",;&)]}"))


def _quoted_end(text: str, opening: re.Match[str]) -> int:
    """Behind the quote that closes; quotes within have more backslashes than those at the ends."""
    escapes = len(opening[1])
    for quote in _BACKSLASHES_AND_QUOTE[opening[2]].finditer(text, opening.end()):
        before = len(quote[1])
        # A single quote may stand in a text within a text without a backslash; then an even number of them escapes it, too.
        if before <= escapes or (escapes == 0 and before % 2 == 0 and opening[2] == '"'):
            return quote.end()
    return len(text)


def _bracketed_end(text: str, begin: int) -> int:
    depth, at = 0, begin
    while (found := _BRACKETS.search(text, at)) is not None:
        at = found.end()
        if (quote := _QUOTE.match(text, found.start())) is not None:
            at = _quoted_end(text, quote)
            continue
        depth += 1 if found[0] in "[({" else -1
        if depth == 0:
            return at
    return len(text)
