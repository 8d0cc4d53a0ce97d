"""`kinebox standard record` on lessons: what counts afterwards, what is said, and what is refused."""

import errno
import os
import re
from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
import pytest

from models.errors import UserError
from models.messages.feedback import Colour
from models.messages.motion import JointState
from models.skeleton import coco
from models.teaching.standard import FRAME_S, Standard
from services.cli import new_standards
from services.cli.new_standards import Record, record
from services.cli.report import Order, write_report
from services.cli.standards import own_standards
from services.evaluation.appraisal import Moments, appraise
from services.evaluation.attempt import AROUND_S, FoundAttempt
from services.evaluation.check import check
from services.evaluation.config import VOCABULARY, EvaluationConfig
from services.evaluation.new_standard import standard_of
from services.evaluation.report.document import Report
from services.evaluation.search import attempts_in
from services.evaluation.track import Track, known_track
from services.lesson.lesson_reader import open_lesson
from services.support.teaching_files import load_standards, load_teachings
from tests.demonstrations import hidden, recorded, shown
from tests.integration.fusion_room import RIG
from tests.integration.fusion_room import SITE as ROOM
from tests.integration.school import SITE, counting, holds, lesson_of, record_refused
from tests.taught import shipped

pytestmark = pytest.mark.slow


def test_a_left_handed_pupils_attempt_becomes_the_standard_by_which_the_next_is_judged(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lesson, attempt = lesson_of(tmp_path, handed="left")
    record(lesson, tmp_path, None, Record(1))
    out = capsys.readouterr().out.splitlines()
    assert out[0].startswith(f"badminton_clear: version 2 counts now, made of attempt 1 of lesson {lesson.stem} (badminton_clear, ")
    assert re.fullmatch(
        r"it takes \d\.\d s, performed by somebody 1\.\d\d m tall; its left side led, so the standard is its mirror image", out[1]
    )
    assert out[2] == f"{tmp_path}/school/standards/badminton_clear.npz: the box goes by it from its next start on"
    assert out[3].startswith("bring back what counted before (a simulated pupil of 12 years, no fault)")
    assert out[3].endswith(f": kinebox standard restore badminton_clear shipped --data {tmp_path}")
    standard = counting(tmp_path)
    assert (standard.version, len(standard.exemplars)) == (2, 7)
    np.testing.assert_allclose(np.diff(standard.moments_s), np.diff(attempt.moments_s), atol=1e-6)
    peak = round(standard.moments_s[2] / FRAME_S)
    assert standard.joints_m[peak, 10, 2] > standard.joints_m[peak, 9, 2] + 0.3, "the right hand hits"

    config = EvaluationConfig(load_teachings(tmp_path / "school", VOCABULARY), load_standards(tmp_path / "school"))
    for handed in ("right", "left"):
        track, true = shown("badminton_clear", handed)
        (found,) = attempts_in(track, standard)
        assert found.handed == handed
        np.testing.assert_allclose(found.moments_s, true.moments_s, atol=0.1)
        colours = appraise(track, found, "chosen", Moments(float(track.t_s[-1]), 10**12, 0), config).colours
        if handed == "left":
            assert (colours == Colour.GREEN).mean() > 0.97, "the pupil is not like himself"
        assert (colours == Colour.RED).mean() < 0.05


def begun(lesson: Path, attempt: FoundAttempt) -> str:
    """When an attempt was, as the day's clock had it."""
    with open_lesson(lesson) as opened:
        header = opened.header
    # The track's first frame is that of the lesson.
    return f"{header.wall(header.started_ns * 1e-9 + attempt.moments_s[0]):%H:%M:%S}"


def test_which_attempt_was_taken_is_said_with_its_time_and_its_pupil_and_the_standard_holds_no_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    track, attempt = shown("squat")
    lesson = recorded(tmp_path / "lessons", track, attempt, name="2026-11-20-anna-schmidt", pupil="B12")
    record(lesson, tmp_path, None, Record(1))
    when = begun(lesson, attempt)
    told = capsys.readouterr().out.splitlines()[0]
    assert told.endswith(f"made of attempt 1 of lesson 2026-11-20-anna-schmidt (squat, {when}, pupil B12)")
    origin = counting(tmp_path, "squat").origin
    assert origin.startswith("attempt 1, lesson 2023-11-1")
    assert origin.endswith(f", {when}")
    assert "anna" not in origin
    assert "B12" not in origin


def twice() -> tuple[Track, FoundAttempt, FoundAttempt]:
    """A pupil who stands, does a squat, and another one more quickly; with the true attempts."""
    (first, one), (second, other) = shown("squat"), shown("squat", tempo=0.75, seed=3)
    later_s = len(first) * FRAME_S
    start, exertion, peak, end = (moment_s + later_s for moment_s in other.moments_s)
    both = known_track(np.concatenate([first.joints_m, second.joints_m]), FRAME_S, 0.008)
    return both, one, replace(other, moments_s=(start, exertion, peak, end))


def test_an_attempt_is_numbered_as_the_report_that_evaluated_again_numbers_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """On the day the first of two was not told of."""
    track, first, second = twice()
    lesson = recorded(tmp_path / "lessons", track, second)
    write_report(lesson, tmp_path, None, Order("json", again=True), tmp_path / "report.json")
    report = msgspec.json.decode((tmp_path / "report.json").read_bytes(), type=Report)
    assert [one.number for one in report.attempts] == [1, 2]
    record(lesson, tmp_path, None, Record(1))
    np.testing.assert_allclose(np.diff(counting(tmp_path, "squat").moments_s), np.diff(second.moments_s), atol=1e-6)
    capsys.readouterr()
    record(lesson, tmp_path, None, Record(1, again=True))
    np.testing.assert_allclose(np.diff(counting(tmp_path, "squat").moments_s), np.diff(first.moments_s), atol=0.15)
    assert f"(squat, {begun(lesson, first)[:-3]}" in capsys.readouterr().out.splitlines()[0]
    record(lesson, tmp_path, None, Record(2, again=True))
    np.testing.assert_allclose(np.diff(counting(tmp_path, "squat").moments_s), np.diff(second.moments_s), atol=0.15)


def test_of_a_long_lesson_only_what_is_around_the_attempt_is_held(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    track, _, second = twice()
    lesson = recorded(tmp_path / "lessons", track, second)
    held: list[Track] = []

    def watched(part: Track, attempt: FoundAttempt, base: Standard, origin: str) -> Standard:
        held.append(part)
        return standard_of(part, attempt, base, origin)

    monkeypatch.setattr(new_standards, "standard_of", watched)
    record(lesson, tmp_path, None, Record(1))
    (part,) = held
    first_s, last_s = second.moments_s[0] - AROUND_S, min(second.moments_s[-1] + AROUND_S, float(track.t_s[-1]))
    assert last_s - first_s - FRAME_S <= len(part) * FRAME_S <= last_s - first_s + 4 * FRAME_S
    assert len(part) < len(track) - 60
    whole = standard_of(track, second, shipped().standards["squat"], "")
    assert counting(tmp_path, "squat").stature_m == pytest.approx(whole.stature_m, abs=1e-4)
    np.testing.assert_allclose(counting(tmp_path, "squat").joints_m, whole.joints_m, atol=1e-3)


def test_the_usual_folder_is_read_and_checked_by_a_box_whose_site_names_none(tmp_path: Path) -> None:
    lesson, _ = lesson_of(tmp_path, "squat")
    record(lesson, tmp_path, None, Record(1))
    assert ROOM.evaluation.teaching == ""
    check(ROOM, RIG, tmp_path)
    file = tmp_path / "school/standards/squat.npz"
    file.write_bytes(file.read_bytes()[:-9])
    with pytest.raises(UserError, match=r"squat\.npz: is no standard's file, or is damaged"):
        check(ROOM, RIG, tmp_path)


def test_a_standard_goes_where_the_lessons_site_or_a_given_one_says(tmp_path: Path) -> None:
    named = SITE.read_text() + '\n[evaluation]\nteaching = "ours"\n'
    lesson, _ = lesson_of(tmp_path, "squat", site_toml=named)
    (tmp_path / "ours").mkdir()
    record(lesson, tmp_path, None, Record(1))
    assert [name for name in holds(tmp_path / "ours") if name.endswith(".npz")] == ["standards/squat.npz"]
    record(lesson, tmp_path, SITE, Record(1))
    assert [name for name in holds(tmp_path / "school") if name.endswith(".npz")] == ["standards/squat.npz"]


def test_a_lesson_of_another_box_is_recorded_into_the_usual_folder_and_that_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lesson, _ = lesson_of(tmp_path, "squat", site_toml=SITE.read_text() + '\n[evaluation]\nteaching = "elsewhere"\n')
    record(lesson, tmp_path, None, Record(1))
    assert "elsewhere does not exist" in capsys.readouterr().err
    assert counting(tmp_path, "squat").version == 2


@pytest.mark.parametrize("absolute", [True, False])
def test_no_lesson_says_that_something_is_written_or_read_outside_the_data_folder(
    tmp_path: Path, absolute: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    data, elsewhere = tmp_path / "data", tmp_path / "elsewhere"
    elsewhere.mkdir()
    named = str(elsewhere) if absolute else "../elsewhere"
    lesson, _ = lesson_of(data, "squat", site_toml=SITE.read_text() + f'\n[evaluation]\nteaching = "{named}"\n')
    record(lesson, data, None, Record(1))
    assert holds(elsewhere) == {}
    assert counting(data, "squat").version == 2
    (note,) = (line for line in capsys.readouterr().err.splitlines() if "is not in the data folder" in line)
    assert note.startswith(f"note: folder '{named}' is not in the data folder {data}; correct 'teaching' under [evaluation]")


@pytest.mark.parametrize("named", ["../elsewhere", "/elsewhere", "ours/../../elsewhere"])
def test_a_site_that_names_a_folder_outside_the_data_folder_is_refused(tmp_path: Path, named: str) -> None:
    site = tmp_path / "site.toml"
    rig = (SITE.parent / "rig.toml").read_bytes()
    (tmp_path / "rig.toml").write_bytes(rig)
    site.write_text(SITE.read_text() + f'\n[evaluation]\nteaching = "{named}"\n')
    (tmp_path / "elsewhere").mkdir()
    data = tmp_path / "data"
    data.mkdir()
    with pytest.raises(UserError, match=r"is not in the data folder .*; correct 'teaching' under \[evaluation\]"):
        own_standards(data, site)


def test_what_is_hidden_is_refused_by_joint_and_phase(tmp_path: Path) -> None:
    track, attempt = shown("basketball_shot")
    lesson = recorded(tmp_path / "lessons", hidden(track, ("right_wrist",), *attempt.moments_s[1:3]), attempt)
    told = record_refused(tmp_path, lesson, Record(1))
    expected = "was not seen well enough: too little of the right wrist from exertion to peak; choose another attempt"
    assert told.startswith(f"attempt 1 of lesson {lesson} {expected}")
    assert "or have it done once more" in told


def test_what_was_only_guessed_in_the_lesson_is_no_model_for_anybody(tmp_path: Path) -> None:
    track, attempt = shown("squat")
    states, frame = track.states.copy(), round(track.frame_at(attempt.moments_s[2]))
    states[frame - 2 : frame + 3, coco.INDEX["left_wrist"]] = JointState.GUESSED
    lesson = recorded(tmp_path / "lessons", Track(track.t_s, track.joints_m, track.covariance_m2, states), attempt)
    record(lesson, tmp_path, None, Record(1))
    unknown = np.asarray(np.isnan(counting(tmp_path, "squat").joints_m).any(axis=2))
    assert (unknown[:, coco.INDEX["left_wrist"]].sum(), unknown.sum()) == (5, 5)


def test_attempts_that_are_not_there_are_refused(tmp_path: Path) -> None:
    lesson, _ = lesson_of(tmp_path, "squat")
    assert "has no attempt 9; it has 1" in record_refused(tmp_path, lesson, Record(9))
    told = record_refused(tmp_path, lesson, Record(1, "handstand"))
    assert "there is no action 'handstand'; there are: badminton_clear" in told
    told = record_refused(tmp_path, lesson, Record(1, "badminton_clear"))
    assert "is one at squat, and none at badminton_clear is found in it; leave out --action" in told
    broken = tmp_path / "lessons/broken.mcap"
    broken.write_bytes(lesson.read_bytes()[:-900])
    assert "is damaged" in record_refused(tmp_path, broken, Record(1))
    broken.write_bytes(b"no lesson")
    assert "is no lesson of KineBox" in record_refused(tmp_path, broken, Record(1))
    assert "does not exist" in record_refused(tmp_path, tmp_path / "gone.mcap", Record(1))


def test_in_a_lesson_in_which_nobody_told_of_attempts_they_are_looked_for(tmp_path: Path) -> None:
    track, attempt = shown("squat")
    record(recorded(tmp_path / "lessons", track), tmp_path, None, Record(1))
    np.testing.assert_allclose(np.diff(counting(tmp_path, "squat").moments_s), np.diff(attempt.moments_s), atol=0.15)
    still = known_track(np.repeat(track.joints_m[:1], 90, axis=0), FRAME_S, 0.01)
    lesson = recorded(tmp_path / "lessons", still, name="still")
    told = record_refused(tmp_path, lesson, Record(1))
    assert "holds no attempts that were found; name a lesson with an attempt in it" in told


def test_an_attempt_that_was_taken_for_another_action_can_be_a_standard_of_its_own(tmp_path: Path) -> None:
    track, attempt = shown("badminton_clear", "left")
    taken_for = FoundAttempt("volleyball_spike", "left", attempt.moments_s)
    lesson = recorded(tmp_path / "lessons", track, taken_for)
    record(lesson, tmp_path, None, Record(1, "badminton_clear"))
    standard = counting(tmp_path)
    assert standard.version == 2
    np.testing.assert_allclose(np.diff(standard.moments_s), np.diff(attempt.moments_s), atol=0.15)
    assert not (tmp_path / "school/standards/volleyball_spike.npz").exists()


def test_of_an_attempt_that_was_corrected_the_correction_is_shown_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    track, attempt = shown("squat")
    stiff = track.joints_m.copy()
    first, last = (round(track.frame_at(moment_s)) for moment_s in (attempt.moments_s[0], attempt.moments_s[-1]))
    share = 0.45
    stiff[first:last] = stiff[:1] + share * (stiff[first:last] - stiff[:1])
    lesson = recorded(tmp_path / "lessons", known_track(stiff, FRAME_S, 0.008), attempt)
    record(lesson, tmp_path, None, Record(1))
    cues = {fault.cue.en for fault in shipped().teachings["squat"].fault}
    (line,) = capsys.readouterr().err.splitlines()
    assert line.removeprefix("note: of this attempt was said: ") in cues


def test_a_full_disk_is_one_line_and_nothing_is_changed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lesson, _ = lesson_of(tmp_path, "squat")

    def full(_descriptor: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr(os, "fsync", full)
        assert "No space left on device; make room there" in record_refused(tmp_path, lesson, Record(1)), "and no folder is made"
    record(lesson, tmp_path, None, Record(1))
    monkeypatch.setattr(os, "fsync", full)
    assert "No space left on device; make room there" in record_refused(tmp_path, lesson, Record(1))
    assert counting(tmp_path, "squat").version == 2
