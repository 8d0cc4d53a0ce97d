"""`kinebox export` on lessons that were recorded: what is written, under which names, and what is refused with nothing written."""

import datetime as dt
import errno
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import msgspec
import numpy as np
import pytest

from models.errors import UserError
from models.messages import codec
from models.messages.feedback import Feedback
from models.messages.lesson import Entry, FusionLog
from models.messages.motion import JointState, Motion
from services.cli import export as command
from services.cli.export import Order, export
from services.cli.lesson_attempts import recorded_feedbacks
from services.evaluation.track import Track, known_track
from services.lesson.export.kinds import Format
from services.lesson.imports.file import read_motion
from services.lesson.lesson_file import LessonWriter
from services.lesson.lesson_reader import open_lesson
from services.lesson.stretches import stretches
from tests.installed import ROOT
from tests.synthetic.lesson import BEGIN_NS, SECOND_NS, header
from tests.takes import FRAME_S, moving, performed

NOBODY = known_track(np.full((9, 17, 3), np.nan), FRAME_S)


def motion_of(track: Track, frame: int, begin_ns: int, epoch: int = 0) -> Motion:
    known = track.states[frame] != JointState.UNKNOWN
    return Motion(
        kind="smooth",
        sequence=frame,
        epoch=epoch,
        t_ns=begin_ns + round(frame * FRAME_S * SECOND_NS),
        t_newest_ns=begin_ns,
        t_published_ns=begin_ns,
        joints_m=np.where(known[:, None], track.joints_m[frame], 0).astype(np.float32),
        covariance_m2=np.where(known[:, None, None], track.covariance_m2[frame], 0).astype(np.float32),
        states=track.states[frame].astype(np.uint8),
        views=np.zeros(17, np.uint32),
        cameras=(),
    )


def feedback_of(begin_ns: int, first: int, last: int, keyframes: tuple[int, ...]) -> Feedback:
    count = last - first + 1
    at_ns = [begin_ns + round(frame * FRAME_S * SECOND_NS) for frame in (first, *keyframes)]
    return Feedback(
        id=at_ns[-1] // 1_000_000,
        epoch=0,
        action="badminton_clear",
        by="chosen",
        handed="right",
        keyframes_ns=(at_ns[1], at_ns[2], at_ns[3], at_ns[4]),
        t_published_ns=at_ns[-1],
        score=None,
        score_sigma=None,
        praise="",
        cue="",
        cue_certainty=0.0,
        judgements=(),
        measures=(),
        shown=(),
        t_first_ns=at_ns[0],
        frame_ns=round(FRAME_S * SECOND_NS),
        joints_m=np.zeros((count, 17, 3), np.float32),
        states=np.zeros((count, 17), np.uint8),
        colours=np.zeros((count, 17), np.uint8),
        standard_m=np.full((count, 17, 3), np.nan, np.float32),
    )


def log_of(track: Track, begin_ns: int, feedbacks: tuple[Feedback, ...] = ()) -> Iterator[Entry]:
    for frame in range(len(track)):
        motion = motion_of(track, frame, begin_ns)
        yield Entry("tick", motion.t_ns, b"")
        yield Entry("motion", motion.t_ns, codec.encode(motion))
    for feedback in feedbacks:
        yield Entry("feedback", feedback.t_published_ns, codec.encode(feedback))


def recorded(folder: Path, *segments: list[Entry], name: str = "lesson") -> Path:
    """A lesson of these logs, each a segment of its own."""
    folder.mkdir(parents=True, exist_ok=True)
    writer = LessonWriter.create(folder, name, header())
    for number, log in enumerate(segments):
        for sequence, first in enumerate(range(0, len(log), 30)):
            part = FusionLog(BEGIN_NS + number * 100 * SECOND_NS, sequence, tuple(log[first : first + 30]))
            writer.append(part, "a gap" if number and not sequence else "")
    return writer.finish()


def with_attempts(folder: Path) -> Path:
    feedbacks = tuple(feedback_of(BEGIN_NS, *frames) for frames in ((2, 40, (4, 10, 20, 36)), (42, 80, (44, 50, 60, 76))))
    return recorded(folder, list(log_of(performed().track, BEGIN_NS, feedbacks)))


@pytest.mark.parametrize("kind", [Format.TRC, Format.C3D, Format.BVH])
def test_the_motion_of_a_lesson_is_what_was_recorded(tmp_path: Path, kind: Format, capsys: pytest.CaptureFixture[str]) -> None:
    export(with_attempts(tmp_path / "lessons"), tmp_path, None, Order(kind, tmp_path / "out", None, "P07"))
    back = read_motion(tmp_path / f"out/lesson.{kind}")
    assert len(back) == len(performed().track)
    off_m = np.linalg.norm(back.joints_m - performed().track.joints_m, axis=2)
    assert off_m.max() < (0.03 if kind is Format.BVH else 2e-5)
    assert capsys.readouterr().out == f"{tmp_path}/out/lesson.{kind}: {len(back)} frames, 0:02, 2 attempts\n"


@pytest.mark.parametrize("kind", list(Format))
def test_every_format_is_written_with_its_attempts_and_nothing_else(tmp_path: Path, kind: Format) -> None:
    export(with_attempts(tmp_path / "lessons"), tmp_path, None, Order(kind, tmp_path / "out", None, "P07"))
    beside = {f"lesson.{kind}.json"} if kind in {Format.TRC, Format.BVH, Format.MOT} else set()
    assert {path.name for path in (tmp_path / "out").iterdir()} == {f"lesson.{kind}"} | beside
    for name in beside:
        about = json.loads((tmp_path / "out" / name).read_text())
        assert about["pupil"] == "P07"
        assert [each["keyframes_s"]["peak"] for each in about["attempts"]] == pytest.approx([20 / 30, 2.0], abs=1e-6)


@pytest.mark.parametrize(("asked", "written"), [("", "B12"), ("P07", "P07")])
def test_the_files_of_one_attempt_say_whose_it_was_unless_that_is_told(tmp_path: Path, asked: str, written: str) -> None:
    own = msgspec.structs.replace(feedback_of(BEGIN_NS, 2, 40, (4, 10, 20, 36)), pupil="B12")
    lesson = recorded(tmp_path / "lessons", list(log_of(performed().track, BEGIN_NS, (own,))))
    export(lesson, tmp_path, None, Order(Format.TRC, tmp_path / "out", 1, asked))
    assert json.loads((tmp_path / "out/lesson-attempt1.trc.json").read_text())["pupil"] == written


def test_one_attempt_is_cut_out_with_what_is_around_it(tmp_path: Path) -> None:
    export(with_attempts(tmp_path / "lessons"), tmp_path, None, Order(Format.TRC, tmp_path, 2, ""))
    back = read_motion(tmp_path / "lesson-attempt2.trc")
    np.testing.assert_allclose(back.joints_m, performed().track.joints_m[42:81], atol=2e-5)
    (attempt,) = json.loads((tmp_path / "lesson-attempt2.trc.json").read_text())["attempts"]
    assert attempt["keyframes_s"] == pytest.approx({"start": 2 / 30, "exertion": 8 / 30, "peak": 18 / 30, "end": 34 / 30}, abs=1e-6)


def begun(frame: int) -> str:
    """When a frame was, as the day's clock had it."""
    told = header()
    after_s = (BEGIN_NS - told.started_ns) * 1e-9 + frame * FRAME_S
    return f"{dt.datetime.fromtimestamp(told.started_s + after_s, tz=dt.UTC).astimezone():%H:%M:%S}"


def test_what_was_written_of_an_attempt_is_said_so_that_nobody_takes_another_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    export(with_attempts(tmp_path / "lessons"), tmp_path, None, Order(Format.TRC, tmp_path, 2))
    assert capsys.readouterr().out == f"{tmp_path}/lesson-attempt2.trc: 39 frames, 0:01, attempt 2: badminton_clear, {begun(44)}\n"


def test_of_one_attempt_only_its_own_frames_are_held_in_memory(tmp_path: Path) -> None:
    with open_lesson(with_attempts(tmp_path)) as lesson:
        told = recorded_feedbacks(lesson)
        (whole,) = stretches(lesson.parts(), FRAME_S, told)
        (part,) = stretches(lesson.parts(), FRAME_S, told, only=2)
    assert (len(whole.track), [each.number for each in whole.attempts]) == (len(performed().track), [1, 2])
    assert (len(part.track), [each.number for each in part.attempts]) == (39, [2])
    np.testing.assert_array_equal(part.track.joints_m, whole.track.joints_m[42:81])


def test_with_one_attempt_so_much_around_it_is_held_as_is_asked_for(tmp_path: Path) -> None:
    with open_lesson(with_attempts(tmp_path)) as lesson:
        told = recorded_feedbacks(lesson)
        (whole,) = stretches(lesson.parts(), FRAME_S, told)
        (part,) = stretches(lesson.parts(), FRAME_S, told, only=1, around_s=0.5)
    # It is from frame 4 to 36, and 15 frames on either side are asked for: there are but four before it.
    assert [each.number for each in part.attempts] == [1]
    np.testing.assert_array_equal(part.track.joints_m, whole.track.joints_m[: 36 + 15 + 1])


def test_an_attempt_whose_motion_is_there_in_part_only_is_refused(tmp_path: Path) -> None:
    feedbacks = tuple(feedback_of(BEGIN_NS, *frames) for frames in ((2, 40, (4, 10, 20, 36)), (42, 80, (44, 50, 60, 76))))
    log = list(log_of(performed().track, BEGIN_NS, feedbacks))
    file = recorded(tmp_path / "lessons", log[: 2 * 60] + log[-2:])
    assert "of attempt 2 of lesson" in refusal(file, tmp_path / "out", 2)
    assert "has no attempt 3; it has 1-2" in refusal(file, tmp_path / "out", 3)
    export(file, tmp_path, None, Order(Format.TRC, tmp_path / "out", 1))


def test_each_stretch_between_gaps_becomes_a_file_and_those_with_nobody_none(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    later_ns = BEGIN_NS + 50 * SECOND_NS
    last = moving(3, 20)
    file = recorded(
        tmp_path / "lessons",
        list(log_of(performed().track, BEGIN_NS)),
        list(log_of(NOBODY, later_ns)),
        list(log_of(last, later_ns + SECOND_NS)),
    )
    export(file, tmp_path, None, Order(Format.C3D, tmp_path / "out", None, ""))
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["lesson-1.c3d", "lesson-3.c3d"]
    np.testing.assert_allclose(read_motion(tmp_path / "out/lesson-3.c3d").joints_m, last.joints_m, atol=1e-6)
    assert capsys.readouterr().err.splitlines() == [
        "note: the lesson is in 3 pieces, each with its own time from 0: its recording has 2 gaps",
        "left out: lesson-2 has no frame in which a joint is known",
    ]


def test_why_a_lesson_without_a_gap_becomes_several_files_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    track = moving(3, 20)
    log: list[Entry] = []
    for epoch in range(3):
        begin_ns = BEGIN_NS + 10 * epoch * SECOND_NS
        motions = (motion_of(track, frame, begin_ns, epoch) for frame in range(len(track)))
        log += [Entry("motion", motion.t_ns, codec.encode(motion)) for motion in motions]
    export(recorded(tmp_path, log), tmp_path, None, Order(Format.C3D, tmp_path / "out"))
    assert [path.name for path in sorted((tmp_path / "out").iterdir())] == ["lesson-1.c3d", "lesson-2.c3d", "lesson-3.c3d"]
    told = "note: the lesson is in 3 pieces, each with its own time from 0: its film or its cameras began anew 2 times\n"
    assert capsys.readouterr().err == told


@pytest.mark.parametrize(
    ("epochs", "why"),
    [((0, 0), "its recording has 2 gaps"), ((0, 1), "its recording has 2 gaps, and its film or its cameras began anew 1 time")],
    ids=["one film", "a film that began anew, too"],
)
def test_a_part_between_two_gaps_in_which_nothing_moved_is_not_counted_as_a_beginning(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], epochs: tuple[int, int], why: str
) -> None:
    track, later_ns = moving(3, 20), BEGIN_NS + 50 * SECOND_NS
    still = [Entry("tick", later_ns, b"")]
    motions = [
        motion_of(track, frame, later_ns + (1 + 10 * epoch) * SECOND_NS, epoch)
        for epoch in sorted(set(epochs))
        for frame in range(20)
    ]
    last = [Entry("motion", motion.t_ns, codec.encode(motion)) for motion in motions]
    export(recorded(tmp_path, list(log_of(track, BEGIN_NS)), still, last), tmp_path, None, Order(Format.C3D, tmp_path / "out"))
    told = f"note: the lesson is in {1 + len(set(epochs))} pieces, each with its own time from 0"
    assert capsys.readouterr().err == f"{told}: {why}\n"


def test_frames_that_are_missing_are_unknown_and_time_goes_on(tmp_path: Path) -> None:
    log = list(log_of(performed().track, BEGIN_NS))
    export(recorded(tmp_path, log[:40] + log[60:]), tmp_path, None, Order(Format.C3D, tmp_path, None, ""))
    back = read_motion(tmp_path / "lesson.c3d")
    assert len(back) == len(performed().track)
    assert (back.states[20:30] == JointState.UNKNOWN).all()
    np.testing.assert_allclose(back.joints_m[30:], performed().track.joints_m[30:], atol=1e-6)


def refusal(file: Path, out: Path, attempt: int | None = None, kind: Format = Format.TRC) -> str:
    before = sorted(out.rglob("*")) if out.exists() else []
    with pytest.raises(UserError) as caught:
        export(file, out, None, Order(kind, out, attempt))
    assert (sorted(out.rglob("*")) if out.exists() else []) == before, "something was written"
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.slow
def test_an_attempt_that_is_not_there_is_refused_with_those_that_are(tmp_path: Path) -> None:
    assert "has no attempt 3; it has 1-2" in refusal(with_attempts(tmp_path / "a"), tmp_path / "out", 3)
    still = known_track(np.repeat(performed().track.joints_m[:1], 90, axis=0), FRAME_S, 0.01)
    without = recorded(tmp_path / "b", list(log_of(still, BEGIN_NS)))
    assert f"lesson {without} holds no attempts" in refusal(without, tmp_path / "out", 1)


def tried_once() -> Track:
    """Somebody who waits, tries, and waits."""
    joints = performed().track.joints_m
    waiting = np.concatenate([np.repeat(joints[:1], 60, axis=0), joints, np.repeat(joints[-1:], 60, axis=0)])
    return known_track(waiting + np.random.default_rng(0).normal(0, 0.002, waiting.shape), FRAME_S, 0.01)


@pytest.mark.slow
def test_numbers_are_those_of_the_report_also_when_it_evaluated_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """On the day something else was taken for the first attempt."""
    told = msgspec.structs.replace(feedback_of(BEGIN_NS, 2, 40, (4, 10, 20, 36)), action="squat")
    file = recorded(tmp_path / "lessons", list(log_of(tried_once(), BEGIN_NS, (told,))))
    export(file, tmp_path, None, Order(Format.TRC, tmp_path / "day", 1))
    assert f"attempt 1: squat, {begun(4)}" in capsys.readouterr().out
    export(file, tmp_path, None, Order(Format.TRC, tmp_path / "now", 1, again=True))
    assert "attempt 1: badminton_clear, " in capsys.readouterr().out
    (attempt,) = json.loads((tmp_path / "now/lesson-attempt1.trc.json").read_text())["attempts"]
    assert attempt["action"] == "badminton_clear"


@pytest.mark.slow
def test_in_a_lesson_in_which_no_attempt_was_told_it_is_looked_for(tmp_path: Path) -> None:
    seen = tried_once()
    file = recorded(tmp_path / "lessons", list(log_of(seen, BEGIN_NS)))
    export(file, tmp_path, None, Order(Format.TRC, tmp_path / "out", 1))
    (attempt,) = json.loads((tmp_path / "out/lesson-attempt1.trc.json").read_text())["attempts"]
    assert attempt["action"] == "badminton_clear"
    first = read_motion(tmp_path / "out/lesson-attempt1.trc").joints_m[0]
    begin = int(np.argmin(np.abs(seen.joints_m - first).sum(axis=(1, 2))))
    peak_s = begin * FRAME_S + attempt["keyframes_s"]["peak"] - 60 * FRAME_S
    assert peak_s == pytest.approx(performed().attempts[0].moments_s[2], abs=0.1)


def test_lessons_with_nothing_to_export_are_refused(tmp_path: Path) -> None:
    assert "is empty" in refusal(recorded(tmp_path, [], name="empty"), tmp_path / "out")
    ticks = [entry for entry in log_of(NOBODY, BEGIN_NS) if entry.kind == "tick"]
    assert "holds no motion" in refusal(recorded(tmp_path, ticks, name="still"), tmp_path / "out")
    assert "nobody was seen" in refusal(recorded(tmp_path, list(log_of(NOBODY, BEGIN_NS)), name="nobody"), tmp_path / "out")


def test_a_damaged_lesson_is_refused_and_nothing_is_written(tmp_path: Path) -> None:
    file = with_attempts(tmp_path / "lessons")
    file.write_bytes(file.read_bytes()[:-3000])
    assert f"lesson {file} is damaged" in refusal(file, tmp_path / "out")


def test_motion_off_its_grid_is_refused(tmp_path: Path) -> None:
    log = list(log_of(performed().track, BEGIN_NS))
    late = msgspec.structs.replace(codec.decode(log[21].payload, Motion), t_ns=BEGIN_NS + 350_000_000)
    log[21] = Entry("motion", late.t_ns, codec.encode(late))
    assert "not as fusion makes it" in refusal(recorded(tmp_path, log), tmp_path / "out")


def test_bones_without_hips_are_refused_by_the_lessons_name_and_trc_is_advised(tmp_path: Path) -> None:
    states = performed().track.states.copy()
    states[:, 11] = JointState.UNKNOWN
    track = Track(performed().track.t_s, performed().track.joints_m, performed().track.covariance_m2, states)
    file = recorded(tmp_path, list(log_of(track, BEGIN_NS)))
    told = refusal(file, tmp_path / "out", kind=Format.GLB)
    assert f"lesson of lesson {file} has no frame in which both hips" in told
    assert "choose trc or c3d" in told


def test_a_file_that_is_there_is_not_overwritten(tmp_path: Path) -> None:
    file = with_attempts(tmp_path / "lessons")
    (tmp_path / "lesson.trc").write_text("mine")
    assert "is there already; remove it, or name another folder with --out" in refusal(file, tmp_path)
    assert (tmp_path / "lesson.trc").read_text() == "mine"


def test_a_full_disk_leaves_nothing_half_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(path: Path, _data: bytes) -> None:
        raise OSError(errno.ENOSPC, "No space left on device", str(path))

    monkeypatch.setattr(command, "write_new", full)
    (tmp_path / "out").mkdir()
    assert "cannot be written: No space left on device; make room there" in refusal(
        with_attempts(tmp_path / "lessons"), tmp_path / "out"
    )


def test_a_folder_that_is_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("")
    assert "cannot be written" in refusal(with_attempts(tmp_path / "lessons"), tmp_path / "out")


@pytest.mark.parametrize("code", ["P" * 9, "P\n07", "P7\udcff", "Ö7", "Anna", "EMMA2", "7-2"])
@pytest.mark.parametrize("kind", [Format.C3D, Format.GLB])
def test_what_is_no_code_stands_in_no_file(tmp_path: Path, code: str, kind: Format) -> None:
    """Nor is it changed without a word: Ö7 and Ä7 were the same pupil in a C3D."""
    with pytest.raises(UserError, match=r"(?s)--pupil: '.*is no pupil's code: a code is a number"):
        export(with_attempts(tmp_path / "lessons"), tmp_path, None, Order(kind, tmp_path / "out", None, code))
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_as_people_type_it(tmp_path: Path) -> None:
    file = with_attempts(tmp_path / "data/lessons")

    def kinebox(*words: str) -> "subprocess.CompletedProcess[str]":
        line = [sys.executable, "-m", "services.cli.main", "export", *words, "--data", str(tmp_path / "data")]
        return subprocess.run(line, capture_output=True, text=True, cwd=ROOT, timeout=100, check=False)

    done = kinebox("lesson", "--format", "glb", "--attempt", "1", "--pupil", "P07", "--out", str(tmp_path / "out"))
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"{tmp_path}/out/lesson-attempt1.glb: 39 frames, 0:01, attempt 1: badminton_clear, {begun(4)}\n"
    assert b'"pupil":"P07"' in (tmp_path / "out/lesson-attempt1.glb").read_bytes()
    missing = kinebox("lesson", "--format", "glb", "--attempt", "9")
    assert missing.returncode == 2
    assert (
        missing.stderr == f"kinebox: lesson {file} has no attempt 9; it has 1-2 (with --again, those that are found anew count)\n"
    )
