"""Names of files are bytes, and those that are not UTF-8 fit into no list, message or log as they are."""

import os


def readable(name: str) -> str:
    r"""A name or path as text, with bytes that are not UTF-8 as "\xfc"."""
    return os.fsencode(name).decode("utf-8", "backslashreplace")


def is_readable(name: str) -> bool:
    """Whether a name or path is text as it is."""
    return readable(name) == name
