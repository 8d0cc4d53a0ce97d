"""`kinebox simulate` for real: rendered, the same again, found again, gone on with after a kill, refused on a full disk, played."""

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import msgspec
import numpy as np
import pytest
import tomlkit

from edge.cameras.video import load_video
from edge.footage.index import INDEX_NAME, Index
from edge.simulation.command import simulation
from edge.simulation.lesson.attempts import read_attempts
from edge.simulation.lesson.files import ATTEMPTS_NAME, FOLDER, PLAN_NAME, RIG_NAME, SITE_NAME, TRUTH_NAME, film_path
from edge.simulation.lesson.plan import Plan, encode_plan
from edge.simulation.lesson.presets import tiny
from edge.simulation.truth import truth_file
from models.camera.rig import decode_rig
from models.errors import USER_ERROR_CODE
from tests.installed import ROOT, require_graphics, require_networks
from tests.integration.waiting import until
from tests.lifeline import bound
from tests.ports import free_port
from tests.system.test_box import Box

pytestmark = [pytest.mark.slow, pytest.mark.timeout(300), pytest.mark.rendering]

CONTENT = {"cam01.avi", "cam02.avi", PLAN_NAME, RIG_NAME, SITE_NAME, TRUTH_NAME, ATTEMPTS_NAME, INDEX_NAME}


def command(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "services.cli.main", "simulate", *map(str, arguments)]


def simulate(*arguments: object) -> "subprocess.CompletedProcess[str]":
    environment = os.environ | {"NUMBA_CACHE_DIR": str(ROOT / "build/kernels")}
    return subprocess.run(command(*arguments), cwd=ROOT, env=environment, capture_output=True, text=True, timeout=240, check=False)


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data folder with the tiny lesson in it, and the kernels that were compiled before."""
    require_graphics()
    folder = new_data(tmp_path_factory.mktemp("simulated"))
    done = simulate("tiny", "--data", folder)
    assert done.returncode == 0, done.stderr
    return folder


def new_data(folder: Path) -> Path:
    data = folder / "data"
    data.mkdir()
    kernels = ROOT / "build/kernels"
    if kernels.is_dir():
        (data / "kernels").symlink_to(kernels)
    return data


def lesson_of(data: Path) -> Path:
    (folder,) = (path for path in (data / FOLDER).iterdir() if path.suffix != ".part")
    return folder


def plan_file(folder: Path, plan: Plan) -> Path:
    path = folder / "my.toml"
    path.write_bytes(encode_plan(plan))
    return path


def test_a_lesson_has_everything_that_playing_and_measuring_it_takes(data: Path) -> None:
    folder = lesson_of(data)
    assert {path.name for path in folder.iterdir()} == CONTENT
    rig = decode_rig((folder / RIG_NAME).read_bytes(), RIG_NAME)
    truth = truth_file.read(folder / TRUTH_NAME)
    assert rig.names == tuple(truth.cameras) == ("cam01", "cam02")
    assert read_attempts(folder / ATTEMPTS_NAME) == {"pupil": ()}
    for camera in rig:
        video = load_video(film_path(folder, camera.name), camera.name)
        assert (len(video.pictures), video.size_px) == (30, camera.size_px)
        assert truth.cameras[camera.name].times_s == pytest.approx(np.arange(30) / 30)
        pictures = [video.frame(0, index, 0).image().astype(float) for index in (0, 29)]
        assert all(picture.std() > 10 for picture in pictures), "something is to be seen"
        nose = truth.cameras[camera.name].coco_px[0, 0, 0]
        assert np.linalg.norm(nose - camera.project(truth.cameras[camera.name].coco_exposed_m[0, 0, 0].astype(float))) < 0.05


def test_what_was_rendered_is_found_again_and_a_damaged_lesson_is_rendered_anew_to_the_same_bytes(
    data: Path, tmp_path: Path
) -> None:
    own = new_data(tmp_path)
    shutil.copytree(data / FOLDER, own / FOLDER)
    folder = lesson_of(own)
    before = {name: (folder / name).read_bytes() for name in CONTENT - {SITE_NAME, INDEX_NAME}}
    again = simulate("tiny", "--data", own)
    assert again.stdout.startswith(f"was rendered before: {folder}")
    film_path(folder, "cam02").write_bytes(b"damage")
    anew = simulate("tiny", "--data", own)
    assert (anew.returncode, anew.stdout.split(":")[0]) == (0, "rendered")
    assert {name: (folder / name).read_bytes() for name in before} == before


def test_another_seed_is_another_lesson_beside_it_with_other_pictures(data: Path, tmp_path: Path) -> None:
    plan = msgspec.structs.replace(tiny(length_s=0.2), seed=2)
    done = simulate(plan_file(tmp_path, plan), "--data", data, "--out", tmp_path / "other")
    assert done.returncode == 0, done.stderr
    pictures = [
        load_video(film_path(folder, "cam01"), "cam01").frame(0, 0, 0).image() for folder in (lesson_of(data), tmp_path / "other")
    ]
    assert np.abs(pictures[0].astype(int) - pictures[1]).mean() > 5
    assert f"play it: kinebox run --site {tmp_path / 'other' / SITE_NAME} --data {data}" in done.stdout


def pieces(data: Path) -> list[Path]:
    return list(data.glob(f"{FOLDER}/*.part/*.truth"))


def begin(plan: Path, data: Path) -> "subprocess.Popen[str]":
    """Render until there are some pieces."""
    environment = os.environ | {"NUMBA_CACHE_DIR": str(ROOT / "build/kernels")}
    pipe = subprocess.PIPE
    process = subprocess.Popen(bound(command(plan, "--data", data)), cwd=ROOT, env=environment, stderr=pipe, text=True)
    until(lambda: len(pieces(data)) >= 2 or process.poll() is not None, "some pieces", 200)
    assert process.poll() is None
    return process


def require_whole(folder: Path, pictures: int) -> None:
    index = Index.read(folder)
    assert index is not None
    assert index.damaged(folder) == []
    assert {path.name for path in folder.iterdir()} == CONTENT
    for name, truth in truth_file.read(folder / TRUTH_NAME).cameras.items():
        assert truth.times_s == pytest.approx(np.arange(pictures) / 30)
        assert len(load_video(film_path(folder, name), name).pictures) == pictures


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT])
def test_a_rendering_that_is_ended_leaves_nothing_that_is_taken_for_whole_and_goes_on_later(number: int, tmp_path: Path) -> None:
    require_graphics()
    own = new_data(tmp_path)
    plan = plan_file(tmp_path, tiny(length_s=4.0))
    process = begin(plan, own)
    process.send_signal(number)
    process.communicate()
    assert [path.suffix for path in (own / FOLDER).iterdir()] == [".part"]
    done = simulate(plan, "--data", own)
    assert (done.returncode, done.stderr) == (0, "")
    require_whole(lesson_of(own), 120)


def test_a_disk_that_fills_up_is_said_in_one_line_and_the_same_command_goes_on_once_there_is_room(tmp_path: Path) -> None:
    require_graphics()
    with small_disk(tmp_path / "disk", 40) as disk:
        own = new_data(disk)
        plan = plan_file(tmp_path, tiny(length_s=4.0))
        process = begin(plan, own)
        with suppress(OSError), (disk / "filler").open("wb") as filler:
            while True:
                filler.write(bytes(4096))
                filler.flush()
        _, said = process.communicate()
        assert process.returncode == USER_ERROR_CODE
        assert len(said.splitlines()) == 1
        assert "its disk is full; make room or name a folder on another disk" in said
        assert [path.suffix for path in (own / FOLDER).iterdir()] == [".part"]
        assert not list(own.glob(f"{FOLDER}/*.part/*.part")), "nothing is half written"
        (disk / "filler").unlink()
        assert simulate(plan, "--data", own).returncode == 0
        require_whole(lesson_of(own), 120)


def test_too_little_room_is_said_before_anything_is_rendered(tmp_path: Path) -> None:
    require_graphics()
    with small_disk(tmp_path / "disk", 4) as disk:
        done = simulate("tiny", "--data", ROOT / "build", "--out", disk / "lesson")
    assert done.returncode == USER_ERROR_CODE
    assert "MB are free, and this lesson may need" in done.stderr


@contextmanager
def small_disk(folder: Path, size_mb: int) -> Iterator[Path]:
    """A file system in memory."""
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", f"size={size_mb}m", "kinebox-lesson", str(folder)]
    if subprocess.run(mount, check=False, capture_output=True).returncode:
        pytest.skip("no file system can be mounted here")
    try:
        yield folder
    finally:
        subprocess.run(["umount", "--lazy", str(folder)], check=True)


def test_a_folder_that_cannot_be_written_is_named(data: Path, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    done = simulate("tiny", "--data", data, "--out", tmp_path / "file" / "lesson")
    assert done.returncode == USER_ERROR_CODE
    assert f"{tmp_path / 'file' / 'lesson.part'} cannot be written (Not a directory)" in done.stderr


def test_a_folder_that_holds_something_else_is_left_alone(data: Path, tmp_path: Path) -> None:
    (tmp_path / "diary.txt").write_text("dear diary")
    done = simulate("tiny", "--data", data, "--out", tmp_path)
    assert done.returncode == USER_ERROR_CODE
    assert f"{tmp_path} is there already and is no rendered lesson; name another folder" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["diary.txt"]


def test_a_machine_that_cannot_render_says_what_to_install(tmp_path: Path) -> None:
    (tmp_path / "moderngl.py").write_text("raise ImportError('not here')\n")
    environment = os.environ | {"PYTHONPATH": f"{tmp_path}{os.pathsep}{ROOT}"}
    arguments = command("tiny", "--data", new_data(tmp_path))
    done = subprocess.run(arguments, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == USER_ERROR_CODE
    assert done.stderr.strip().endswith("`.venv/bin/pip install 'moderngl>=5.12'`")
    assert len(done.stderr.strip().splitlines()) == 1


def test_the_plans_that_come_with_kinebox_are_listed() -> None:
    done = simulate("--list")
    assert [line.split()[0] for line in done.stdout.splitlines()] == [plan.name for plan in simulation.plans()]


def test_a_rendered_lesson_plays_in_the_box(data: Path, tmp_path: Path) -> None:
    require_networks()
    folder, port = lesson_of(data), free_port()
    site = tomlkit.parse((folder / SITE_NAME).read_text())
    site["calibration"] = str(folder / RIG_NAME)
    site["bus"] = {"endpoint": f"tcp/127.0.0.1:{free_port()}"}
    site["tablet"] = {"host": "127.0.0.1", "port": port}
    (tmp_path / "site.toml").write_text(tomlkit.dumps(site))
    run = [sys.executable, "-m", "services.cli.main", "run", "--site", str(tmp_path / "site.toml"), "--data", str(ROOT / "build")]
    with (tmp_path / "output").open("wb") as output:
        process = subprocess.Popen(bound(run), cwd=ROOT, stdout=output, stderr=output)
    box = Box(process, port, tmp_path)
    try:
        until(lambda: box.answers() or process.poll() is not None, "the page's server", 120)
        assert process.poll() is None, (tmp_path / "output").read_text()
        until(lambda: all(_shows(box, camera) for camera in ("cam01", "cam02")), "pictures of both cameras", 120)
    finally:
        process.terminate()
        process.wait()


def _shows(box: Box, camera: str) -> bool:
    rate_hz = box.camera(camera)["source_hz"]
    return isinstance(rate_hz, float) and rate_hz > 20
