"""What can be read as a file that a person named: one that lies on a disk, and ends.

A pipe would be waited for without end, and a device such as `/dev/zero` read until the memory is full. The errors are such as
opening the file could raise, so that whoever reads it tells them with the others. Pure: who reads brings what the disk says.
"""

import errno
import os
import stat
from typing import Final

MOST_TEXT_BYTES: Final = 10_000_000
"""Of what people write, or have written for them: a site, a calibration, a plan, what is taught. A hundred times what any needs."""


def require_regular(found: os.stat_result) -> None:
    """Raise OSError for a pipe, a socket or a device; opening a folder says by itself what it is."""
    if not stat.S_ISREG(found.st_mode) and not stat.S_ISDIR(found.st_mode):
        raise OSError(errno.EINVAL, "it is a pipe or a device, and no file")


def require_text(found: os.stat_result) -> None:
    """The same, and for a file that is larger than a text of ours can be."""
    require_regular(found)
    if found.st_size > MOST_TEXT_BYTES:
        size_mb, most_mb = found.st_size / 1e6, MOST_TEXT_BYTES / 1e6
        raise OSError(errno.EFBIG, f"it has {size_mb:.0f} MB, and such a file at most {most_mb:.0f}")
