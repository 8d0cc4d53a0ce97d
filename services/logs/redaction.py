"""What is taken out of logs and site files before they leave a box.

- Values of keys that name a secret (`secrets_in_text.SECRET_KEYS`, anywhere in the key: `api_token`, `apiToken`): `[secret]`.
- The user and password of an address: `rtsp://[secret]@10.0.0.7/1`. Secrets that are told in a text: `password=[secret]`,
  `Authorization: [secret]`, `Bearer [secret]`.
- Numbers in a row (more than `MOST_NUMBERS`), as of keypoints that a traceback quotes, nested as they may be: `[12 numbers]`.
- Words and quoted bytes of more than `LONGEST_WORD` characters, as of pictures that were turned into text: `[3000 characters]`.
- Of a line of the log that was torn: its ends, if they may belong to something secret: `[cut off]`.
- Comments of the site file: it is written anew from its values.

Names of the school, the cameras and the machine's folders and addresses stay: without them nobody could help.
"""

import re
from typing import Any

from services.logs.secrets_in_text import SECRET, names_secret, without_secrets

MOST_NUMBERS = 8
LONGEST_WORD = 256
CUT_OFF = "[cut off]"

# Possessive, so that no text takes longer than its length.
_NUMBER = r"[-+]?(?:\d++(?:\.\d*+)?|\.\d++)(?:[eE][-+]?\d++)?"
_NUMBERS = re.compile(rf"(?<![\w.])(?:{_NUMBER}[,;\[\]()\s]++){{{MOST_NUMBERS},}}+(?:{_NUMBER})?")
_WORD = re.compile(rf"[\w+/=-]{{{LONGEST_WORD + 1},}}")
_BYTES = re.compile(rf"\bb(?:'(?:[^'\\]|\\.){{{LONGEST_WORD + 1},}}+'?|\"(?:[^\"\\]|\\.){{{LONGEST_WORD + 1},}}+\"?)", re.DOTALL)
_NEXT_FIELD = re.compile(r',\s*+"\w++"\s*+:')
_ADDRESS_AT_END = re.compile(r"(?<=://)[^\s'\"]*$")


def redacted(value: Any, key: str = "") -> Any:
    """A JSON or TOML value without what has to stay; `key` is its name."""
    if names_secret(key):
        return SECRET
    if isinstance(value, dict):
        return {redacted_text(name): _measured(item) or redacted(item, name) for name, item in value.items()}
    if isinstance(value, list):
        count = _numbers_in(value)
        return f"[{count} numbers]" if count > MOST_NUMBERS else [_measured(item) or redacted(item) for item in value]
    return redacted_text(value) if isinstance(value, str) else value


def redacted_text(text: str) -> str:
    """A text without what has to stay."""
    text = _NUMBERS.sub(_counted, without_secrets(text))
    text = _BYTES.sub(lambda found: f"[{len(found[0])} characters]", text)
    return _WORD.sub(lambda found: f"[{len(found[0])} characters]", text)


def redacted_remains(text: str) -> str:
    """What is left of a line of the log that was torn, without what has to stay: nobody knows what its ends belonged to."""
    if not text.startswith("{"):
        whole = _NEXT_FIELD.search(text)
        text = CUT_OFF + (text[whole.start() :] if whole is not None else "")
    return redacted_text(_ADDRESS_AT_END.sub(CUT_OFF, text))


def _numbers_in(values: list[Any]) -> int:
    return sum(_numbers_in(item) if isinstance(item, list) else isinstance(item, int | float) for item in values)


def _measured(value: Any) -> str:
    """What stands for a table of nothing but numbers in lists, as joints by name; empty if it is something else."""
    if not isinstance(value, dict) or not value or not all(isinstance(item, list) for item in value.values()):
        return ""
    count = _numbers_in(list(value.values()))
    return f"[{count} numbers]" if count > MOST_NUMBERS else ""


def _counted(numbers: re.Match[str]) -> str:
    gap = " " if numbers[0][-1].isspace() else ""
    return f"[{len(re.findall(_NUMBER, numbers[0]))} numbers]{gap}"
