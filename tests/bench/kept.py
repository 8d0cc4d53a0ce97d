"""What benchmarks keep in the data folder because it takes long to make: a file that is there is whole."""

import io
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from edge.simulation.rendering.pieces import write_whole
from models.arrays import Float
from models.errors import UserError


def keep(path: Path, data: bytes) -> None:
    """Write a file, its folder too; nothing of it stays if that fails.

    Raises:
        UserError: the disk is full, or the folder cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, data)
    except OSError as error:
        raise UserError(
            f"{path} cannot be written ({error.strerror}); make room on its disk, or correct its folder's rights"
        ) from error


def keep_arrays(path: Path, arrays: Mapping[str, Float]) -> None:
    """Write arrays by their names, as .npz. Raises as `keep`."""
    file = io.BytesIO()
    np.savez_compressed(file, allow_pickle=False, **arrays)
    keep(path, file.getvalue())
