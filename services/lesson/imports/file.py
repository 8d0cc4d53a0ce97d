"""A motion file of another program, by its name."""

from collections.abc import Callable
from pathlib import Path
from typing import Final

import numpy as np

from models.errors import UserError
from models.regular_file import require_regular
from services.evaluation.track import Track
from services.lesson.imports import bvh, c3d, trc
from services.lesson.readable_names import readable

READERS: Final[dict[str, Callable[[bytes, str], Track]]] = {".trc": trc.decode, ".c3d": c3d.decode, ".bvh": bvh.decode}
MOST_BYTES: Final = 500_000_000


def read_motion(file: Path, unit: str | None = None) -> Track:
    """The track of a TRC, C3D or BVH file.

    Args:
        file: of the motion.
        unit: of a BVH file, which says none: one of `bvh.UNITS_M`; None for the one that follows from its legs.

    Raises:
        UserError: it cannot be read; the reason names the file and says what to do.
    """
    name = readable(str(file))
    decode = READERS.get(file.suffix.lower())
    if decode is None:
        raise UserError(f"{name} is of no kind that can be imported; name a file that ends with {', '.join(READERS)}")
    if unit is not None and decode is not bvh.decode:
        raise UserError(f"--unit is for BVH files, which say none; {name} says its own; leave --unit out")
    try:
        found = file.stat()
        require_regular(found)
        if found.st_size > MOST_BYTES:
            raise UserError(f"{name} is larger than {MOST_BYTES / 1e6:.0f} MB; export the attempt alone")
        data = file.read_bytes()
    except FileNotFoundError as error:
        raise UserError(f"{name} does not exist; correct the name") from error
    except OSError as error:
        raise UserError(f"{name} cannot be read: {error.strerror}; correct its path or its permissions") from error
    # A number without measure makes a place that is refused as nowhere in a gym; numpy's own lines about it are for nobody.
    with np.errstate(over="ignore", invalid="ignore"):
        return decode(data, name) if unit is None else bvh.decode(data, name, unit)
