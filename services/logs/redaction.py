"""What is taken out of logs and site files before they leave a box.

- Values of keys that name a secret (`SECRET_KEYS`, anywhere in the key: `api_token` is one): `[secret]`.
- The user and password of an address: `rtsp://[secret]@10.0.0.7/1`. Secrets that are told in a text: `password=[secret]`.
- Numbers in a row (more than `MOST_NUMBERS`), as of keypoints that a traceback quotes: `[12 numbers]`.
- Words of more than `LONGEST_WORD` characters, as of pictures that were turned into text: `[3000 characters]`.
- Comments of the site file: it is written anew from its values.

Names of the school, the cameras and the machine's folders and addresses stay: without them nobody could help.
"""

import re
from typing import Any

SECRET_KEYS = ("password", "passwd", "passphrase", "secret", "token", "credential", "api_key", "private_key", "pin", "psk")
MOST_NUMBERS = 8
LONGEST_WORD = 256

_SECRET = "[secret]"  # noqa: S105 - what stands in for one
_KEYS = "|".join(SECRET_KEYS)
_SECRET_KEY = re.compile(rf"(?:^|[_.-])(?:{_KEYS})s?(?:$|[_.-])", re.IGNORECASE)
_IN_ADDRESS = re.compile(r"(?<=://)[^\s'\"]{0,300}@")
_IN_TEXT = re.compile(rf"((?<![A-Za-z0-9])(?:{_KEYS})s?['\"]?\s*[=:]\s*)(\"[^\"]*\"|'[^']*'|[^\s,;&'\"]+)", re.IGNORECASE)
# Possessive, so that no text takes longer than its length.
_NUMBER = r"[-+]?(?:\d++(?:\.\d*+)?|\.\d++)(?:[eE][-+]?\d++)?"
_NUMBERS = re.compile(rf"(?<![\w.])(?:{_NUMBER}[,;\[\]()\s]++){{{MOST_NUMBERS},}}+(?:{_NUMBER})?")
_WORD = re.compile(rf"[\w+/=-]{{{LONGEST_WORD + 1},}}")


def redacted(value: Any, key: str = "") -> Any:
    """A JSON or TOML value without what has to stay; `key` is its name."""
    if _SECRET_KEY.search(key):
        return _SECRET
    if isinstance(value, dict):
        return {name: redacted(item, name) for name, item in value.items()}
    if isinstance(value, list):
        if len(value) > MOST_NUMBERS and all(isinstance(item, int | float) for item in value):
            return f"[{len(value)} numbers]"
        return [redacted(item) for item in value]
    return redacted_text(value) if isinstance(value, str) else value


def redacted_text(text: str) -> str:
    """A text without what has to stay."""
    text = _IN_ADDRESS.sub(f"{_SECRET}@", text)
    text = _IN_TEXT.sub(rf"\g<1>{_SECRET}", text)
    text = _NUMBERS.sub(_counted, text)
    return _WORD.sub(lambda found: f"[{len(found[0])} characters]", text)


def _counted(numbers: re.Match[str]) -> str:
    gap = " " if numbers[0][-1].isspace() else ""
    return f"[{len(re.findall(_NUMBER, numbers[0]))} numbers]{gap}"
