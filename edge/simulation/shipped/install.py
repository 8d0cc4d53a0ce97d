"""Install the lesson that comes with KineBox: `python -m edge.simulation.shipped.install --data build`.

It was rendered once (`python -m edge.simulation.shipped.ship`) without the sensors' noise, which no codec can make small, and is in
the repository as video. Here each picture gets its noise, the same as in any other installation, and becomes a JPEG picture of its
own, as a camera sends them. A second call only compares hashes: nothing heavy is imported.
"""

import argparse
import shutil
import sys
from pathlib import Path

from edge.footage.index import INDEX_NAME, Index, sha256
from edge.simulation.lesson.files import FOLDER, SHIPPED, VIDEO_SUFFIX, film_path
from models.errors import UserError

SOURCE = Path(__file__).parent / SHIPPED
_RECIPE = "1"
"""Raise it when noise or JPEG quality change."""
_PROCESSES = 2


def cameras() -> list[str]:
    """Names of the lesson's cameras."""
    return sorted(path.stem for path in SOURCE.glob(f"*{VIDEO_SUFFIX}"))


def is_installed(data: Path) -> bool:
    """Whether `data` holds this version of the lesson, whole and unchanged."""
    folder = data / FOLDER / SHIPPED
    index = Index.read(folder)
    return index is not None and index.recipe == _recipe() and not index.damaged(folder)


def install(data: Path) -> Path:
    """Put the lesson into the data folder unless it is there already, and return its folder.

    Raises:
        UserError: a video of it cannot be read.
    """
    folder = data / FOLDER / SHIPPED
    if is_installed(data):
        (folder / INDEX_NAME).touch()  # make compares times
        return folder
    from edge.simulation.rendering.workers import do_pieces  # noqa: PLC0415 - as above

    folder.mkdir(parents=True, exist_ok=True)
    (folder / INDEX_NAME).unlink(missing_ok=True)
    names = cameras()
    for stale in folder.iterdir():
        stale.unlink()
    sys.stderr.write(f"Preparing the simulated lesson, {len(names)} cameras (about a minute) ...\n")
    do_pieces([sys.executable, "-m", "edge.simulation.shipped.worker", str(folder)], range(len(names)), _PROCESSES, lambda: None)
    others = [Path(shutil.copy(path, folder)) for path in sorted(SOURCE.iterdir()) if path.suffix != VIDEO_SUFFIX]
    Index.of(_recipe(), [*others, *(film_path(folder, name) for name in names)]).write(folder)
    return folder


def _recipe() -> str:
    return " ".join((_RECIPE, *(sha256(path)[:16] for path in sorted(SOURCE.iterdir()))))


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m edge.simulation.shipped.install", description="Install the built-in simulated lesson."
    )
    parser.add_argument("--data", type=Path, default=Path("build"), help="data folder (default: build)")
    options = parser.parse_args(arguments)
    try:
        install(options.data)
    except UserError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    except OSError as error:
        sys.stderr.write(
            f"simulated lesson: {error}; correct the rights of the data folder and its files, or make room on its disk\n"
        )
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
