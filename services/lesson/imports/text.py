"""Lines of a text file from another program."""

from models.errors import UserError


def lines_of(data: bytes, source: str, kind: str) -> list[str]:
    """The lines of a text that was written to its end.

    Raises:
        UserError: it is no text, or its last line has no end, as if the file were cut off there.
    """
    if b"\0" in data:
        raise UserError(f"{source} is no {kind} file; name one, or export it again")
    text = data.decode("utf-8-sig", "replace").replace("\r\n", "\n").replace("\r", "\n")
    if not text.endswith("\n"):
        raise UserError(
            f"{source} is cut off: its last line has no end; copy or export it again (or add an empty line if it is whole)"
        )
    return text.split("\n")[:-1]
