"""Processes that render: what they keep is whole, what goes wrong in one is said, and none outlives who started it."""

import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import msgspec
import numpy as np
import psutil
import pytest

from edge.cameras.video import load_video
from edge.footage.transcode import encode_jpeg
from edge.simulation.lesson.files import TRUTH_NAME, film_path
from edge.simulation.picture.shutter import Shutter
from edge.simulation.rendering.pieces import Job, alone_in, join_film, join_truth, keep_pictures, keep_truth, missing, write_whole
from edge.simulation.rendering.workers import do_pieces
from edge.simulation.truth.truth import LessonTruth
from models.errors import UserError
from tests.small_video import SIZE_PX, plain_picture

WORKER = """
import os, pathlib, sys, time
from edge.simulation.rendering.workers import serve_pieces
from models.errors import UserError
def do(piece, step_done):
    for _ in range(3):
        step_done()
    if piece == 66:
        raise UserError("piece 66 cannot be made; do without it")
    if piece == 77:
        os._exit(9)
    if piece == 78:
        os.kill(os.getpid(), 9)
    if piece == 88:
        raise ArithmeticError("a defect of ours")
    if piece == 99:
        while True:
            time.sleep(0.01)
            step_done()
    pathlib.Path(sys.argv[1], str(piece)).touch()
sys.exit(serve_pieces(do))
"""
TRUTH = LessonTruth("abc", ("pupil",), np.zeros((1, 16)), np.zeros((1, 24, 3)), Shutter(), {}, {})
JOB = Job("abc", noisy=True, quality=85, cameras=("cam01",), size_px=(SIZE_PX,), pictures=7, per_piece=3, rate_hz=30.0)


def command(folder: Path) -> list[str]:
    return [sys.executable, "-c", WORKER, str(folder)]


def test_every_piece_is_done_once_and_every_step_is_told(tmp_path: Path) -> None:
    steps = []
    do_pieces(command(tmp_path), range(7), 2, lambda: steps.append(1))
    assert {path.name for path in tmp_path.iterdir()} == {str(piece) for piece in range(7)}
    assert len(steps) == 21


@pytest.mark.parametrize(
    ("piece", "error", "said"),
    [
        (66, UserError, "^piece 66 cannot be made; do without it$"),
        (77, RuntimeError, "code 9"),
        (78, UserError, r"^a process at work was ended \(SIGKILL\).* memory is full: .* the same command goes on"),
        (88, RuntimeError, "ArithmeticError: a defect of ours"),
    ],
)
def test_what_goes_wrong_in_a_worker_is_said_and_the_others_end(
    piece: int, error: type[Exception], said: str, tmp_path: Path
) -> None:
    with pytest.raises(error, match=said):
        do_pieces(command(tmp_path), [99, piece], 2, lambda: None)
    assert not _workers(tmp_path)


def test_workers_end_by_themselves_when_who_started_them_is_killed(tmp_path: Path) -> None:
    code = (
        "import sys; from edge.simulation.rendering import workers; workers.do_pieces(eval(sys.argv[1]), [99, 99], 2, lambda: None)"
    )
    parent = subprocess.Popen([sys.executable, "-c", code, repr(command(tmp_path))])
    _wait_until(lambda: len(_workers(tmp_path)) == 2)
    parent.kill()
    parent.wait()
    _wait_until(lambda: not _workers(tmp_path))


def _workers(folder: Path) -> list[psutil.Process]:
    found = []
    for process in psutil.process_iter():
        with suppress(psutil.NoSuchProcess):
            line = process.cmdline()
            if line and line[-1] == str(folder) and WORKER in line:
                found.append(process)
    return found


def _wait_until(condition: object) -> None:
    end_s = time.monotonic() + 60
    while not condition():  # type: ignore[operator]
        assert time.monotonic() < end_s
        time.sleep(0.05)


def picture(number: int) -> bytes:
    return encode_jpeg(plain_picture(20 * number))


def keep(folder: Path, piece: int) -> None:
    keep_pictures(folder, "cam01", piece, [picture(number) for number in JOB.numbers(piece)])
    keep_truth(folder, piece, TRUTH)


def test_what_is_missing_is_known_by_what_is_there_whole(tmp_path: Path) -> None:
    assert missing(tmp_path, JOB) == [0, 1, 2]
    keep(tmp_path, 1)
    keep_pictures(tmp_path, "cam01", 0, [])
    (tmp_path / "cam01.000002.pictures.part").write_bytes(b"half")
    keep_truth(tmp_path, 2, TRUTH)
    assert missing(tmp_path, JOB) == [0, 2]


def test_pieces_become_one_film_and_go(tmp_path: Path) -> None:
    for piece in JOB.pieces:
        keep(tmp_path, piece)
    film = load_video(join_film(tmp_path, JOB, "cam01"), "cam01")
    assert [film.pictures[number] for number in range(7)] == [picture(number) for number in range(7)]
    assert missing(tmp_path, JOB) == [], "a film needs no pictures any more"
    assert join_film(tmp_path, JOB, "cam01") == film_path(tmp_path, "cam01"), "once more does nothing"
    assert join_truth(tmp_path, JOB) == tmp_path / TRUTH_NAME
    assert {path.name for path in tmp_path.iterdir()} == {"cam01.avi", TRUTH_NAME}


def test_a_file_that_cannot_be_written_whole_is_not_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(OSError, match="No space"):
        write_whole(tmp_path / "a", b"data")
    assert list(tmp_path.iterdir()) == []


def test_two_cannot_render_into_one_folder(tmp_path: Path) -> None:
    part = tmp_path / "lesson.part"
    with alone_in(part), pytest.raises(UserError, match=r"lesson\.part: another process is rendering"), alone_in(part):
        pass
    with alone_in(part):
        assert list(tmp_path.iterdir()) == [part]


def test_a_job_of_another_shape_is_another_job() -> None:
    assert msgspec.json.decode(msgspec.json.encode(JOB), type=Job) == JOB
    assert msgspec.structs.replace(JOB, quality=90) != JOB
