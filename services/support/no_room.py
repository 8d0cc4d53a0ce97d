"""Errors of a disk that has no room: what helps is to make some, and neither other rights nor another disk."""

import errno
import os

_CODES = (errno.ENOSPC, errno.EDQUOT)
WORDS = frozenset(map(os.strerror, _CODES))
"""As people and logs have them."""


def is_no_room(error: OSError) -> bool:
    """Whether the disk is full, or what this user may have of it."""
    return error.errno in _CODES
