"""Text that somebody else wrote, for a terminal. It needs nothing but Python: errors are printed with it."""


def printable(text: str | bytes) -> str:
    """A text that does nothing to a terminal and stays on its line."""
    whole = text.decode(errors="backslashreplace") if isinstance(text, bytes) else text
    if whole.isprintable():
        return whole
    return "".join(each if each.isprintable() or each == "\t" else each.encode("unicode_escape").decode() for each in whole)
