"""The folder in which a lesson is being rendered: what is there already, and what is still to be made.

Every file in it was written under another name first, so that one that is there is whole. A piece is half a second: a file of each
camera's pictures, which is removed once the camera's film is complete, and, last, one of what is true in them.
"""

import fcntl
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path

import msgspec

from edge.footage.transcode import write_jpegs
from edge.simulation.lesson.files import TRUTH_NAME, film_path
from edge.simulation.truth import truth_file
from edge.simulation.truth.truth import LessonTruth, joined_lesson
from models.errors import UserError

PART_SUFFIX = ".part"
JOB_NAME = "job.json"


class Job(msgspec.Struct, frozen=True):
    """What is rendered in a folder.

    Attributes:
        fingerprint: of plan and recipe.
        noisy: see `edge.simulation.rendering.film.Film`.
        quality: of the JPEG pictures, 1 to 100.
        cameras: their names, in order.
        size_px: (width, height) of the pictures of each.
        pictures: of each camera.
        per_piece: pictures of a piece, but for the last.
        rate_hz: pictures a second.
    """

    fingerprint: str
    noisy: bool
    quality: int
    cameras: tuple[str, ...]
    size_px: tuple[tuple[int, int], ...]
    pictures: int
    per_piece: int
    rate_hz: float

    @property
    def pieces(self) -> range:
        """Numbers of the pieces."""
        return range(-(-self.pictures // self.per_piece))

    def numbers(self, piece: int) -> range:
        """Numbers of the pictures in a piece."""
        return range(piece * self.per_piece, min((piece + 1) * self.per_piece, self.pictures))


def missing(folder: Path, job: Job) -> list[int]:
    """The pieces that are still to be rendered."""
    unfinished = [camera for camera in job.cameras if not film_path(folder, camera).is_file()]
    return [piece for piece in job.pieces if not all(path.is_file() for path in _piece_paths(folder, unfinished, piece))]


def keep_pictures(folder: Path, camera: str, piece: int, pictures: Sequence[bytes]) -> None:
    """Write the pictures of one camera in a piece."""
    write_whole(_pictures_path(folder, camera, piece), msgspec.msgpack.encode(pictures))


def keep_truth(folder: Path, piece: int, truth: LessonTruth) -> None:
    """Write what is true in a piece."""
    write_whole(_truth_path(folder, piece), truth_file.encode(truth))


def join_truth(folder: Path, job: Job) -> Path:
    """Make one file of what is true in all pieces."""
    path = folder / TRUTH_NAME
    pieces = [truth_file.read(_truth_path(folder, piece)) for piece in job.pieces]
    write_whole(path, truth_file.encode(joined_lesson(pieces)))
    for piece in job.pieces:
        _truth_path(folder, piece).unlink()
    return path


def join_film(folder: Path, job: Job, camera: str) -> Path:
    """Make a camera's film of its pieces, unless that was done, and remove them."""
    path = film_path(folder, camera)
    if not path.is_file():
        temporary = path.with_name(f"{path.name}{PART_SUFFIX}")
        try:
            size_px = job.size_px[job.cameras.index(camera)]
            write_jpegs(temporary, _pictures(folder, camera, job.pieces), size_px, Fraction(job.rate_hz).limit_denominator(1001))
            temporary.replace(path)
        finally:
            temporary.unlink(missing_ok=True)
    for piece in job.pieces:
        _pictures_path(folder, camera, piece).unlink(missing_ok=True)
    return path


def write_whole(path: Path, data: bytes) -> None:
    """Write a file that appears only when all of it is there; nothing of it stays if that fails."""
    temporary = path.with_name(f"{path.name}{PART_SUFFIX}")
    try:
        with temporary.open("wb") as file:
            file.write(data)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Make a folder and have it to oneself.

    Raises:
        UserError: another process has it.
    """
    folder.mkdir(parents=True, exist_ok=True)
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise UserError(f"{folder}: another process is rendering this lesson; wait until it is done, or end it") from error
        yield
    finally:
        os.close(descriptor)


def _pictures(folder: Path, camera: str, pieces: Sequence[int]) -> Iterator[bytes]:
    for piece in pieces:
        yield from msgspec.msgpack.decode(_pictures_path(folder, camera, piece).read_bytes(), type=list[bytes])


def _piece_paths(folder: Path, cameras: Sequence[str], piece: int) -> list[Path]:
    return [*(_pictures_path(folder, camera, piece) for camera in cameras), _truth_path(folder, piece)]


def _pictures_path(folder: Path, camera: str, piece: int) -> Path:
    return folder / f"{camera}.{piece:06d}.pictures"


def _truth_path(folder: Path, piece: int) -> Path:
    return folder / f"{piece:06d}.truth"
