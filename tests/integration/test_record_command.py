"""`kinebox record` and `kinebox lessons` as people type them, with a real recorder on real sockets."""

import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest

from models.config.site import LessonsConfig
from services.cli.duration import clock
from services.lesson.layout import PART_SUFFIX
from services.lesson.lesson_file import LessonWriter
from tests.integration.fusion_room import SITE
from tests.integration.test_recorder_process import ROOT, Box
from tests.integration.waiting import until
from tests.synthetic.gym import Gym
from tests.synthetic.gym_lesson import gym_header

pytestmark = pytest.mark.slow

RECORDER_STARTS_LATE_S = 8.0
"""After the others, as in a box whose first pictures are slow."""
COMMAND = (sys.executable, "-m", "services.cli.main")


def kinebox(*words: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run([*COMMAND, *words], capture_output=True, text=True, cwd=ROOT, timeout=100, check=False, input="")


def record(box: Box, *words: str) -> "subprocess.CompletedProcess[str]":
    return kinebox("record", "--site", str(box.site), "--data", str(box.data), *words)


def refusal(result: "subprocess.CompletedProcess[str]") -> str:
    assert result.returncode == 2, result.stdout + result.stderr
    assert result.stdout == ""
    assert result.stderr.count("\n") == 1
    return result.stderr.removeprefix("kinebox: ")


def test_a_lesson_is_recorded_for_as_long_as_was_said_listed_checked_and_removed(tmp_path: Path) -> None:
    with Box(tmp_path, LessonsConfig()).running() as box, box.recorder():
        done = record(box, "--title", "7b, throwing", "--for", "2s")
        assert done.returncode == 0, done.stderr
        (file,) = box.lessons.glob("*.mcap")
        assert done.stdout.splitlines()[0] == f"recording {file.stem} for 0:02"
        told = done.stdout.splitlines()[1]
        assert "no lesson is being recorded" in refusal(record(box, "--stop"))
    assert file.stem.endswith("-7b-throwing")
    (listed,) = json.loads(kinebox("lessons", "--data", str(box.data), "--json").stdout)
    assert (listed["lesson"], listed["title"], listed["state"], listed["gaps"]) == (file.stem, "7b, throwing", "finished", 0)
    assert (listed["file"], listed["bytes"]) == (str(file), file.stat().st_size)
    assert listed["seconds"] > 1
    assert told == f"recorded {file}, {clock(listed['seconds'])}", "it is as long when it ends as it is in the list"
    assert file.stem in kinebox("lessons", "--data", str(box.data), "--site", str(box.site)).stdout
    by_name = kinebox("replay", "nonsense", "--check", "--data", str(box.data))
    assert "no lesson 'nonsense' in" in refusal(by_name)
    checked = kinebox("replay", str(file), "--check", "--data", str(ROOT / "build"))  # where kernels are compiled already
    assert checked.returncode == 0, checked.stderr
    assert "are equal bit for bit" in checked.stdout

    asked = kinebox("lessons", "delete", file.stem, "--data", str(box.data))
    assert asked.returncode != 0, "nobody answered the question"
    assert file.is_file()
    assert kinebox("lessons", "delete", file.stem, "--data", str(box.data), "--yes").stdout == f"removed {file}\n"
    assert not file.exists()
    assert json.loads(kinebox("lessons", "--data", str(box.data), "--json").stdout) == []
    assert "lists what there is" in refusal(kinebox("lessons", "delete", file.stem, "--data", str(box.data), "--yes"))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_lesson_and_says_where_it_is(tmp_path: Path, number: signal.Signals) -> None:
    with Box(tmp_path, LessonsConfig()).running() as box, box.recorder() as recorder:
        words = [*COMMAND, "record", "--site", str(box.site), "--data", str(box.data)]
        # Whatever runs the tests may have left SIGINT ignored, and children inherit that.
        before = signal.signal(signal.SIGINT, signal.default_int_handler)
        with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT) as process:
            signal.signal(signal.SIGINT, before)
            box.wait_recorded(recorder.pid, parts=2)
            process.send_signal(number)
            out, errors = process.communicate(timeout=60)
        assert (process.returncode, errors) == (0, "")
        (file,) = box.lessons.glob("*.mcap")
        assert f"recorded {file}, 0:0" in out


def test_a_signal_ends_who_stays_with_a_lesson_whose_box_has_ended(tmp_path: Path) -> None:
    box = Box(tmp_path, LessonsConfig())
    words = [*COMMAND, "record", "--site", str(box.site), "--data", str(box.data), "--for", "5m"]
    with box.running(), box.recorder() as recorder:
        process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT)
        box.wait_recorded(recorder.pid, parts=2)
        recorder.terminate()  # as the box ends it
        recorder.wait()
    with process:
        process.send_signal(signal.SIGTERM)
        _, errors = process.communicate(timeout=60)
    (file,) = box.lessons.glob("*.mcap")
    assert process.returncode == 2
    assert f"no box is at {box.room.endpoint} any more" in errors
    assert f"The lesson is in {file}" in errors


def test_a_box_that_runs_another_site_is_named_and_so_is_the_one_that_was_meant(tmp_path: Path) -> None:
    with Box(tmp_path, LessonsConfig()).running() as box, box.recorder():
        meant = tmp_path / "meant.toml"
        meant.write_text(box.site.read_text().replace(f'name = "{SITE.name}"', 'name = "Sports hall"', 1))
        done = kinebox("record", "--site", str(meant), "--data", str(box.data), "--for", "1s")
        assert done.returncode == 0, done.stderr
        assert f"runs the site '{SITE.name}', and not 'Sports hall', which --site names" in done.stderr
        begun = kinebox("record", "--site", str(meant), "--data", str(tmp_path), "--detach")
        assert f"keeps its lessons elsewhere than in {tmp_path / 'lessons'}" in begun.stderr
        ended = record(box, "--stop")
        assert (ended.returncode, ended.stderr) == (0, "")


def test_a_lesson_is_begun_and_left_seen_to_run_and_ended_from_elsewhere(tmp_path: Path) -> None:
    with Box(tmp_path, LessonsConfig()).running() as box, box.recorder():
        begun = record(box, "--detach")
        assert begun.returncode == 0, begun.stderr
        assert begun.stdout.endswith("; 'kinebox record --stop' ends it\n")
        assert "is being recorded already" in refusal(record(box))
        (part,) = box.lessons.glob(f"*{PART_SUFFIX}")
        lesson = part.name.removesuffix(PART_SUFFIX)
        assert "is not finished" in refusal(kinebox("lessons", "delete", lesson, "--data", str(box.data), "--yes"))
        assert record(box, "--stop").stdout.startswith(f"recorded {box.lessons / lesson}.mcap")
        until(lambda: not part.exists(), "the lesson to be finished")


def test_of_two_lessons_that_are_asked_for_at_once_the_second_is_refused_and_ends_nothing(tmp_path: Path) -> None:
    with Box(tmp_path, LessonsConfig()).running() as box, box.recorder(), ThreadPoolExecutor() as together:
        short, long = together.map(lambda length: record(box, "--for", length), ("2s", "4s"))
    first, second = (short, long) if long.returncode else (long, short)
    assert "is being recorded already" in refusal(second)
    assert first.returncode == 0, first.stderr
    assert "somebody else" not in first.stdout


def test_a_lesson_asked_for_before_the_recorder_has_started_is_recorded_once_it_has(tmp_path: Path) -> None:
    with Box(tmp_path, LessonsConfig()).running() as box:
        words = [*COMMAND, "record", "--site", str(box.site), "--data", str(box.data), "--for", "1s"]
        with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT) as process:
            time.sleep(RECORDER_STARTS_LATE_S)
            with box.recorder():
                out, errors = process.communicate(timeout=60)
        assert process.returncode == 0, errors
        assert "\nrecorded " in out


def test_a_lesson_whose_file_was_removed_is_not_said_to_be_recorded(tmp_path: Path) -> None:
    with Box(tmp_path, LessonsConfig()).running() as box, box.recorder() as recorder:
        assert record(box, "--detach").returncode == 0
        box.wait_recorded(recorder.pid, parts=2)
        (part,) = box.lessons.glob(f"*{PART_SUFFIX}")
        part.unlink()
        assert "ended: its file was removed, renamed or replaced" in refusal(record(box, "--stop"))
        words = [*COMMAND, "record", "--site", str(box.site), "--data", str(box.data), "--for", "1m"]
        with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT) as process:
            box.wait_recorded(recorder.pid, parts=2)
            shutil.rmtree(box.lessons)
            out, errors = process.communicate(timeout=60)
        assert process.returncode == 2
        assert "ended: its file was removed, renamed or replaced" in errors
        assert "recorded " not in out
        again = record(box, "--for", "1s")
        assert again.returncode == 0, again.stderr
        assert len(list(box.lessons.glob("*.mcap"))) == 1


def test_a_lesson_that_cannot_be_finished_is_not_said_to_be_recorded(tmp_path: Path) -> None:
    with Box(tmp_path, LessonsConfig()).running() as box, box.recorder() as recorder:
        assert record(box, "--detach").returncode == 0
        box.wait_recorded(recorder.pid, parts=2)
        (part,) = box.lessons.glob(f"*{PART_SUFFIX}")
        # Part by part there is room until it is to be finished: the summary is larger than what is left.
        resource.prlimit(recorder.pid, resource.RLIMIT_FSIZE, (part.stat().st_size, resource.RLIM_INFINITY))
        assert "ended: File too large" in refusal(record(box, "--stop"))


def test_without_a_box_or_without_its_recorder_there_is_one_line(tmp_path: Path) -> None:
    box = Box(tmp_path, LessonsConfig())
    assert "no box runs at tcp/127.0.0.1:" in refusal(record(box))
    with box.running():
        assert "the box's recorder is not heard" in refusal(record(box))


def test_a_box_that_hangs_is_told_from_one_that_does_not_run(tmp_path: Path) -> None:
    box = Box(tmp_path, LessonsConfig())
    command = [sys.executable, "-m", "tests.integration.bus_member", "router", box.room.endpoint, "gym/alive/fusion"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=ROOT) as router:
        try:
            assert router.stdout is not None
            assert router.stdout.readline() == "ready\n"
            router.send_signal(signal.SIGSTOP)
            assert f"the box at {box.room.endpoint} does not answer" in refusal(record(box))
        finally:
            router.kill()


def test_a_disk_too_full_is_told_with_the_key_that_says_how_full(tmp_path: Path) -> None:
    with Box(tmp_path, LessonsConfig(least_free_mb=1_000_000)).running() as box, box.recorder():
        assert "lessons.least_free_mb is 1000000" in refusal(record(box))
        assert not list(box.lessons.glob("*.mcap*"))


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("--for", "3"), "--for: '3' is no length of time"),
        (("--title", "x" * 81), "--title: a title has at most 80 characters"),
        (("--title", os.fsdecode(b"\xff")), "--title: it holds bytes that are not UTF-8"),
        (("--stop", "--detach"), "--stop goes with no other option"),
        (("--detach", "--for", "3m"), "--detach does not go with --for"),
    ],
)
def test_what_makes_no_sense_is_refused_before_anybody_is_asked(tmp_path: Path, words: tuple[str, ...], line: str) -> None:
    assert line in refusal(record(Box(tmp_path, LessonsConfig()), *words))


def test_the_list_tells_what_is_wrong_with_a_lesson(tmp_path: Path) -> None:
    folder = tmp_path / "lessons"
    assert f"no lesson in {folder};" in kinebox("lessons", "--data", os.path.relpath(tmp_path, ROOT)).stdout
    nowhere = tmp_path / "nowhere"
    assert f"there is no data folder {nowhere}; name the box's with --data" in refusal(kinebox("lessons", "--data", str(nowhere)))
    folder.mkdir()
    LessonWriter.create(folder, "empty", gym_header(Gym(), title="nothing")).finish()
    (folder / "foreign.mcap").write_bytes(b"no lesson")
    listed = kinebox("lessons", "--data", str(tmp_path))
    assert listed.returncode == 0
    assert [line.split()[0] for line in listed.stdout.splitlines()[1:]] == ["foreign", "empty"]
    assert "damaged" in listed.stdout
    assert "foreign: " in listed.stderr


def test_one_name_that_is_no_text_and_one_impossible_date_leave_the_list_whole(tmp_path: Path) -> None:
    folder = tmp_path / os.fsdecode(b"\xe4") / "lessons"
    folder.mkdir(parents=True)
    LessonWriter.create(folder, "good", gym_header(Gym())).finish()
    LessonWriter.create(folder, os.fsdecode(b"t\xfcrnen"), gym_header(Gym())).finish()
    LessonWriter.create(folder, "late", replace(gym_header(Gym()), started_ns=10**30)).finish()
    listed = kinebox("lessons", "--data", str(folder.parent))
    assert listed.returncode == 0, listed.stderr
    states = {line.split()[0]: "damaged" in line for line in listed.stdout.splitlines()[1:]}
    assert states == {"good": False, "t\\xfcrnen": True, "late": True}
    assert "the name of lesson t\\xfcrnen is not UTF-8; rename the file" in listed.stderr
    told = json.loads(kinebox("lessons", "--data", str(folder.parent), "--json").stdout)
    assert {row["lesson"] for row in told} == set(states)
    removed = kinebox("lessons", "delete", os.fsdecode(b"t\xfcrnen"), "--data", str(folder.parent), "--yes")
    assert removed.returncode == 0, removed.stderr
    assert len(list(folder.glob("*.mcap"))) == 2
