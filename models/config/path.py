"""What can be the path of a file or folder, as far as that can be said without a disk."""

from models.errors import UserError

_LONGEST_PART = 255
_LONGEST = 4095
"""In bytes, as on every Linux."""


def require_path(text: str, key: str) -> None:
    """Raise UserError if no disk could have it: the file system would not even look.

    Args:
        text: the path.
        key: of the site file, for the message.
    """
    if "\0" in text:
        raise UserError(f"{key} is no path: it holds the character NUL; correct it")
    if any(len(part.encode()) > _LONGEST_PART for part in text.split("/")) or len(text.encode()) > _LONGEST:
        raise UserError(
            f"{key} is no path: a name in it has at most {_LONGEST_PART} bytes, and the whole at most {_LONGEST}; shorten it"
        )
