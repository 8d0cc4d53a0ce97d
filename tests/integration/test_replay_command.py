"""`kinebox replay` as people type it: the same bits in every process, and whatever is not so is said with its cause."""

import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import msgspec
import pytest

from models.messages import codec
from models.messages.lesson import Entry, FusionLog
from models.messages.motion import Motion
from services.lesson import lesson_header, origin
from services.lesson.layout import PART_SUFFIX
from services.lesson.lesson_file import LessonWriter
from services.lesson.recovery import reopen
from services.tablet.page import PAGE
from tests.installed import ROOT
from tests.ports import free_port
from tests.synthetic.gym import T0_NS, Gym
from tests.synthetic.gym_lesson import gym_header, write_gym_lesson
from tests.synthetic.lesson_log import entries, parts

pytestmark = pytest.mark.slow

GYM = Gym(seconds=3.0, seed=3)


def run(*words: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run([sys.executable, *words], capture_output=True, text=True, cwd=ROOT, timeout=110, check=False)


def check(file: Path) -> "subprocess.CompletedProcess[str]":
    return run("-m", "services.cli.main", "replay", str(file), "--check", "--data", str(ROOT / "build"))


def test_what_one_process_recorded_others_replay_to_the_same_bits(tmp_path: Path) -> None:
    recorded = run("-m", "tests.synthetic.gym_lesson", str(tmp_path), "4.0")
    assert recorded.returncode == 0, recorded.stderr
    file = tmp_path / "lesson.mcap"
    bits = {run("-m", "tests.integration.replayed_bits", str(file)).stdout for _ in range(3)}
    assert len(bits) == 1
    motions, _ = bits.pop().split()
    assert int(motions) > 200
    checked = check(file)
    assert checked.returncode == 0, checked.stdout + checked.stderr
    assert checked.stderr == ""
    assert "motions are equal bit for bit (1 segment" in checked.stdout


def altered(log: list[Entry], number: int) -> tuple[list[Entry], Motion]:
    """The log with one bit of its motion of that number changed."""
    index = [i for i, entry in enumerate(log) if entry.kind == "motion"][number]
    motion = codec.decode(log[index].payload, Motion)
    joints = motion.joints_m.copy()
    joints.view("u4")[5, 1] ^= 1
    payload = codec.encode(msgspec.structs.replace(motion, joints_m=joints))
    return [*log[:index], Entry("motion", log[index].t_ns, payload), *log[index + 1 :]], motion


def write_altered(folder: Path, **header: str) -> tuple[Path, Motion]:
    log, motion = altered(list(entries(GYM.events(), GYM.rig)), 50)
    writer = LessonWriter.create(folder, "lesson", gym_header(GYM, **header))
    for part in parts(log, T0_NS):
        writer.append(part)
    return writer.finish(), motion


@pytest.mark.parametrize("parts", [0, 1], ids=["no part", "a part without entries"])
@pytest.mark.parametrize("words", [("--check",), ("--once",), ()])
def test_a_lesson_in_which_nothing_was_recorded_is_refused(tmp_path: Path, parts: int, words: tuple[str, ...]) -> None:
    writer = LessonWriter.create(tmp_path, "empty", gym_header(GYM))
    for sequence in range(parts):
        writer.append(FusionLog(T0_NS, sequence, ()))
    file = writer.finish()
    port = str(free_port())
    refused = run("-m", "services.cli.main", "replay", str(file), "--data", str(tmp_path), "--port", port, *words)
    assert (refused.returncode, refused.stdout) == (2, "")
    assert f"lesson {file} is empty" in refused.stderr
    assert "kinebox lessons delete empty" in refused.stderr


@pytest.mark.parametrize("host", ["192.168..5", "nosuch.invalid", "192.0.2.99"])
def test_a_page_s_address_that_is_none_is_not_blamed_on_its_port(tmp_path: Path, host: str) -> None:
    file, _ = write_altered(tmp_path)
    refused = run("-m", "services.cli.main", "replay", str(file), "--data", str(tmp_path), "--host", host)
    assert (refused.returncode, refused.stdout) == (2, "")
    assert f"the page cannot be shown at {host}, which is no address of this machine (" in refused.stderr
    assert refused.stderr.endswith("; name another with --host\n")


def test_a_lesson_that_ended_before_its_first_motion_is_not_said_to_be_equal(tmp_path: Path) -> None:
    log = [entry for entry in entries(GYM.events(), GYM.rig) if entry.kind != "motion"][:3]
    writer = LessonWriter.create(tmp_path, "short", gym_header(GYM))
    for part in parts(log, T0_NS):
        writer.append(part)
    checked = check(writer.finish())
    assert (checked.returncode, checked.stdout) == (2, "")
    assert "holds no motion that could be compared" in checked.stderr


def test_one_bit_of_one_motion_is_found_and_the_motion_is_named(tmp_path: Path) -> None:
    file, motion = write_altered(tmp_path)
    checked = check(file)
    assert checked.returncode == 1
    assert f"the first that is not: number {motion.sequence} of segment 1, 0:0" in checked.stdout
    assert "joints_m differs, joints by up to" in checked.stdout
    assert "machine and versions are the same, so the file was altered" in checked.stdout


def test_another_version_and_machine_are_told_first_and_named_as_the_cause(tmp_path: Path) -> None:
    told = origin.machine().replace("numba ", "numba 0.0.")
    file, _ = write_altered(tmp_path, machine=told, kinebox="0.0.9")
    checked = check(file)
    assert checked.returncode == 1
    first, second = checked.stderr.splitlines()
    assert first.startswith("note: recorded with KineBox 0.0.9, this is ")
    assert second.startswith("note: recorded with numba 0.0.")
    assert "likely cause: recorded with KineBox 0.0.9" in checked.stdout


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_gym_lesson(tmp_path_factory.mktemp("good"), GYM)


def truncated(data: bytes) -> bytes:
    return data[: len(data) // 2]


def flipped(data: bytes) -> bytes:
    middle = len(data) // 2
    return data[:middle] + bytes((data[middle] ^ 0x10,)) + data[middle + 1 :]


def foreign(data: bytes) -> bytes:
    return b"PK\x03\x04" + data[4:]


def empty(folder: Path, name: str = "lesson", **changes: str) -> Path:
    """A lesson in which nothing was recorded."""
    return LessonWriter.create(folder, name, replace(gym_header(GYM), **changes)).finish()  # type: ignore[arg-type]


def refused(file: Path, *words: str) -> str:
    """The one line with which the command refuses a file."""
    result = run("-m", "services.cli.main", "replay", str(file), *words, "--data", str(ROOT / "build"))
    assert result.returncode == 2
    assert result.stdout == ""
    assert result.stderr.count("\n") == 1
    return result.stderr


@pytest.mark.parametrize(
    ("change", "words"),
    [(truncated, "is damaged: it is cut off"), (flipped, "is damaged: "), (foreign, "is no lesson of KineBox")],
)
def test_a_damaged_or_foreign_file_is_refused(tmp_path: Path, good: Path, change: Callable[[bytes], bytes], words: str) -> None:
    file = tmp_path / "lesson.mcap"
    file.write_bytes(change(good.read_bytes()))
    assert words in refused(file, "--check")


def test_a_damaged_file_is_not_played_up_to_its_damage(tmp_path: Path, good: Path) -> None:
    file = tmp_path / "lesson.mcap"
    file.write_bytes(truncated(good.read_bytes()))
    assert "is damaged: it is cut off" in refused(file, "--once")


def test_a_lesson_of_a_newer_kinebox_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lesson_header, "FORMAT", lesson_header.FORMAT + 1)
    assert "was recorded by a newer KineBox" in refused(empty(tmp_path), "--check")


@pytest.mark.parametrize("how", ["--check", "--once"])
def test_a_lesson_of_an_unknown_preset_is_refused(tmp_path: Path, how: str) -> None:
    assert "preset 'next', which this KineBox does not have" in refused(empty(tmp_path, preset="next"), how)


def test_a_lesson_that_is_being_recorded_is_refused(tmp_path: Path) -> None:
    writer = LessonWriter.create(tmp_path, "lesson", gym_header(GYM))
    writer.close()
    assert "is not finished" in refused(writer.path, "--check")


@pytest.mark.skipif(not (PAGE / "index.html").is_file(), reason="the page is not built: run 'make web'")
def test_a_lesson_that_turns_out_unreadable_while_it_is_played_ends_the_replay_and_its_log_says_so(tmp_path: Path) -> None:
    writer = LessonWriter.create(tmp_path, "lesson", gym_header(GYM))
    writer.append(FusionLog(T0_NS, 0, (Entry("observation", T0_NS, b"\x09\x01 of a newer wire format"),)))
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "kernels").symlink_to(ROOT / "build" / "kernels")
    data, port = str(tmp_path / "data"), str(free_port())
    result = run("-m", "services.cli.main", "replay", str(writer.finish()), "--data", data, "--port", port)
    assert result.returncode == 2
    assert "wire format version 9" in result.stderr.splitlines()[-1]
    assert "wire format version 9" in run("-m", "services.cli.main", "logs", "--replay", "--data", data).stdout


def test_a_cut_off_lesson_is_recovered_and_all_that_was_recovered_replays_elsewhere(tmp_path: Path, good: Path) -> None:
    part = tmp_path / f"rescued{PART_SUFFIX}"
    part.write_bytes(truncated(good.read_bytes()))
    checked = check(reopen(part).finish())
    assert checked.returncode == 0
    assert "are equal bit for bit" in checked.stdout
