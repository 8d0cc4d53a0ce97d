"""`kinebox report` on lessons that were recorded: where attempts come from, which words are used, and what is refused."""

import csv
import errno
import io
import subprocess
import sys
from collections.abc import Iterable, Iterator
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

import models.teaching
from models.errors import UserError
from models.messages import codec
from models.messages.feedback import Feedback
from models.messages.health import EvaluationHealth, Health
from models.messages.lesson import Entry, FusionLog
from models.messages.pupil import PupilCorrection, PupilCorrections, PupilTurn
from services.cli import report as command
from services.cli.report import Order, write_report
from services.evaluation import pipeline
from services.evaluation.appraisal import appraise
from services.evaluation.attempt import FoundAttempt
from services.evaluation.report.document import Report
from services.evaluation.track import Track, known_track
from services.lesson.lesson_file import LessonWriter
from tests.browser.attempts import ending
from tests.demonstrations import smooth_motion
from tests.installed import ROOT
from tests.reported import BEGUN_NS, attempt
from tests.synthetic.lesson import BEGIN_NS, SECOND_NS, header
from tests.taught import performance, shipped

SITE = (ROOT / "deploy/sites/simulated/site.toml").read_text()
STILL_FRAMES = 60
FRAME_S = shipped().frame_s


def moving(*actions: str) -> Track:
    """Somebody who stands, and tries one action after the other."""
    joints = []
    for action in actions:
        own = performance(action)[0].joints_m
        joints += [np.repeat(own[:1], STILL_FRAMES, axis=0), own, np.repeat(own[-1:], STILL_FRAMES, axis=0)]
    return known_track(np.concatenate(joints), FRAME_S, 0.01)


def log_of(track: Track | None, *feedbacks: Feedback, up: PupilTurn | None = None) -> Iterator[Entry]:
    yield Entry("tick", BEGIN_NS, b"")
    if up is not None:
        evaluation = EvaluationHealth("", "site", "waiting", 0, 0.1, 0.0, 0, 0, up.pupil, up.t_ns)
        health = Health("evaluation", 1, BEGIN_NS, "ok", (), 0.1, 1.0, evaluation=evaluation)
        yield Entry("health", BEGIN_NS, codec.encode(health))
    for frame in range(0 if track is None else len(track)):
        motion = smooth_motion(track, frame)  # type: ignore[arg-type]
        yield Entry("motion", motion.t_ns, codec.encode(motion))
    for feedback in feedbacks:
        yield Entry("feedback", feedback.t_published_ns, codec.encode(feedback))


def recorded(folder: Path, log: Iterable[Entry], site_toml: str = SITE) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    writer = LessonWriter.create(folder, "lesson", replace(header(), site_toml=site_toml))
    entries = list(log)
    for sequence, first in enumerate(range(0, len(entries), 30)):
        writer.append(FusionLog(BEGIN_NS, sequence, tuple(entries[first : first + 30])), "")
    return writer.finish()


def said() -> tuple[Feedback, Feedback]:
    """On the day."""
    moved_ns = 20 * SECOND_NS
    first = attempt(cue="no_knee_bend", cue_certainty=0.9, praise="elbow_out", score=61.0, score_sigma=4.0)
    return tuple(  # type: ignore[return-value]
        msgspec.structs.replace(
            one,
            t_first_ns=one.t_first_ns - BEGUN_NS + BEGIN_NS + number * moved_ns,
            keyframes_ns=tuple(t_ns - BEGUN_NS + BEGIN_NS + number * moved_ns for t_ns in one.keyframes_ns),
            t_published_ns=one.t_published_ns - BEGUN_NS + BEGIN_NS + number * moved_ns,
        )
        for number, one in enumerate((first, attempt("squat", score=None, score_sigma=None)))
    )


def reported(file: Path, order: Order, out: Path, data: Path | None = None, site: Path | None = None) -> Report:
    write_report(file, data or file.parent, site, replace(order, form="json"), out)
    return msgspec.json.decode(out.read_bytes(), type=Report)


def refusal(file: Path, out: Path, order: Order = Order(), site: Path | None = None) -> str:  # noqa: B008 - it is frozen
    with pytest.raises(UserError) as raised:
        write_report(file, file.parent, site, order, out)
    return str(raised.value)


def test_a_report_says_what_was_said_on_the_day(tmp_path: Path) -> None:
    told = said()
    report = reported(recorded(tmp_path, log_of(moving("squat"), *told)), Order(), tmp_path / "r.json")
    assert report.source == "recorded"
    assert [(one.number, one.id, one.action, one.score) for one in report.attempts] == [
        (1, told[0].id, "basketball_shot", 61.0),
        (2, told[1].id, "squat", None),
    ]
    assert report.attempts[0].cue is not None
    assert report.attempts[0].cue.fault == "no_knee_bend"
    assert report.attempts[0].keyframes_s.end == pytest.approx((told[0].keyframes_ns[-1] - BEGIN_NS) * 1e-9, abs=1e-3)
    assert (report.lesson.name, report.lesson.title) == ("lesson", "7b, throwing")


@pytest.mark.slow
def test_a_lesson_without_feedback_is_evaluated_from_its_motion(tmp_path: Path) -> None:
    track = moving("squat", "basketball_shot")
    report = reported(recorded(tmp_path, log_of(track)), Order(), tmp_path / "r.json")
    assert report.source == "evaluated"
    assert [(one.number, one.action) for one in report.attempts] == [(1, "squat"), (2, "basketball_shot")]
    true_s = STILL_FRAMES * FRAME_S + performance("squat")[1].moments_s[2]
    assert report.attempts[0].keyframes_s.peak == pytest.approx(true_s, abs=0.15)


@pytest.mark.slow
def test_an_attempt_with_which_the_recording_ends_is_in_the_report(tmp_path: Path) -> None:
    track = moving("squat")
    ended = STILL_FRAMES + round(performance("squat")[1].moments_s[-1] / FRAME_S)
    report = reported(recorded(tmp_path, log_of(track.part(0, ended + 9))), Order(), tmp_path / "r.json")
    assert [one.action for one in report.attempts] == ["squat"]


@pytest.mark.slow
def test_an_attempt_with_which_something_is_wrong_is_left_out_and_that_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def wrong(_track: Track, attempt: FoundAttempt, *others: Any) -> Feedback:
        if attempt.action == "squat":
            raise ValueError("a mistake of ours")
        return appraise(_track, attempt, *others)

    monkeypatch.setattr(pipeline, "appraise", wrong)
    report = reported(recorded(tmp_path, log_of(moving("squat", "basketball_shot"))), Order(), tmp_path / "r.json")
    assert [one.action for one in report.attempts] == ["basketball_shot"]
    assert "note: an attempt could not be judged and is left out (ValueError: a mistake of ours)" in capsys.readouterr().err


@pytest.mark.slow
def test_a_lesson_is_evaluated_again_when_that_is_asked_for(tmp_path: Path) -> None:
    file = recorded(tmp_path, log_of(moving("squat"), *said()))
    report = reported(file, Order(again=True), tmp_path / "r.json")
    assert (report.source, [one.action for one in report.attempts]) == ("evaluated", ["squat"])
    write_report(file, tmp_path, None, Order(again=True), tmp_path / "r.html")
    assert "Evaluated again" in (tmp_path / "r.html").read_text()


def test_the_language_is_the_one_asked_for_or_that_of_the_lessons_site_or_of_a_given_one(tmp_path: Path) -> None:
    german = SITE + '\n[evaluation]\nlanguage = "de"\n'
    file = recorded(tmp_path / "lessons", log_of(None, *said()), german)
    assert reported(file, Order(), tmp_path / "1.json").language == "de"
    assert reported(file, Order(language="zh"), tmp_path / "2.json").language == "zh"
    other = ROOT / "deploy/sites/simulated/site.toml"
    assert reported(file, Order(), tmp_path / "3.json", site=other).language == "en"


def test_what_the_school_teaches_itself_counts(tmp_path: Path) -> None:
    own = tmp_path / "school/actions"
    own.mkdir(parents=True)
    with resources.as_file(resources.files(models.teaching).joinpath("actions/squat.toml")) as shipped_file:
        text = shipped_file.read_text()
    title = shipped().teachings["squat"].title.en
    (own / "squat.toml").write_text(text.replace(f'en = "{title}"', 'en = "Chair without a chair"', 1))
    file = recorded(tmp_path / "lessons", log_of(None, *said()), SITE + '\n[evaluation]\nteaching = "school"\n')
    report = reported(file, Order(), tmp_path / "r.json", data=tmp_path)
    assert [one.title for one in report.attempts] == [shipped().teachings["basketball_shot"].title.en, "Chair without a chair"]


def test_a_lesson_of_another_box_is_reported_by_what_ships_and_that_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = recorded(tmp_path / "a", log_of(None, *said()), SITE + '\n[evaluation]\nteaching = "elsewhere"\n')
    assert len(reported(file, Order(), tmp_path / "1.json").attempts) == 2
    assert "elsewhere does not exist" in capsys.readouterr().err
    unreadable = recorded(tmp_path / "b", log_of(None, *said()), "version = 99\n")
    assert len(reported(unreadable, Order(), tmp_path / "2.json").attempts) == 2
    assert capsys.readouterr().err.startswith("note: ")


def test_a_file_in_the_place_of_the_schools_folder_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "school").write_text("")
    file = recorded(tmp_path / "lessons", log_of(None, *said()), SITE)
    assert len(reported(file, Order(), tmp_path / "r.json", data=tmp_path).attempts) == 2
    told = f"note: {tmp_path / 'school'} is a file, and no folder; move it away; what KineBox brings counts\n"
    assert capsys.readouterr().err == told


def test_csv_and_page_are_of_the_same_attempts(tmp_path: Path) -> None:
    file = recorded(tmp_path, log_of(None, *said()))
    for form in ("csv", "html"):
        write_report(file, tmp_path, None, Order(form), tmp_path / f"r.{form}")
    rows = list(csv.DictReader(io.StringIO((tmp_path / "r.csv").read_bytes().decode("utf-8-sig"), newline="")))
    assert [(row["attempt"], row["score"], row["score_sigma"]) for row in rows] == [("1", "61", "4"), ("2", "", "")]
    assert (tmp_path / "r.html").read_text().count("<article>") == 2


@pytest.mark.parametrize(
    ("order", "line"),
    [
        (Order(form="pdf"), "there is no format 'pdf'; choose one of json, csv, html"),
        (Order(language="fr"), "there is no language 'fr'; choose one of en, zh, de, es"),
        (Order(pupil="P07"), "lesson lesson has no attempt of pupil 'P07'; its pupils are '-'"),
        (
            Order(pupil="Anna"),
            "--pupil: 'Anna' is no pupil's code: a code is a number, also with a letter: 7, 7B, B12, AB-12 or 7B-12, at most "
            "8 characters; no names are kept; - stands for nobody",
        ),
    ],
)
def test_what_is_not_known_is_refused_and_nothing_is_written(tmp_path: Path, order: Order, line: str) -> None:
    file = recorded(tmp_path / "lessons", log_of(None, *said()))
    assert refusal(file, tmp_path / "out", order) == line
    assert [path.name for path in tmp_path.iterdir()] == ["lessons"]


def of_pupils(*codes: str) -> tuple[Feedback, ...]:
    return tuple(msgspec.structs.replace(one, pupil=code) for one, code in zip(said(), codes, strict=True))


def test_a_report_is_grouped_by_pupil_as_was_said_on_the_day_and_corrected_since(tmp_path: Path) -> None:
    told = of_pupils("7", "7")
    correction = PupilCorrections((PupilCorrection(told[1].id, "B12"),))
    log = [*log_of(None, *told), Entry("corrections", told[1].t_published_ns + 1, codec.encode(correction))]
    file = recorded(tmp_path / "lessons", log)
    before = file.read_bytes()
    report = reported(file, Order(), tmp_path / "r.json")
    assert [(one.pupil, one.attempts) for one in report.pupils] == [("7", 1), ("B12", 1)]
    write_report(file, tmp_path, None, Order("csv"), tmp_path / "r.csv")
    rows = list(csv.DictReader(io.StringIO((tmp_path / "r.csv").read_bytes().decode("utf-8-sig"), newline="")))
    assert [(row["attempt"], row["pupil"]) for row in rows] == [("1", "7"), ("2", "B12")]
    write_report(file, tmp_path, None, Order("html", pupil="b12"), tmp_path / "r.html")
    page = (tmp_path / "r.html").read_text()
    assert "Pupil B12" in page
    assert "Pupil 7" not in page
    assert file.read_bytes() == before


@pytest.mark.slow
def test_a_lesson_that_is_evaluated_again_gives_its_attempts_to_whom_they_were(tmp_path: Path) -> None:
    track = moving("squat", "basketball_shot")
    log = list(log_of(track, up=PupilTurn("7", BEGIN_NS - SECOND_NS)))
    first = reported(recorded(tmp_path / "a", log), Order(again=True), tmp_path / "1.json")
    assert [(one.action, one.pupil) for one in first.attempts] == [("squat", "7"), ("basketball_shot", "7")]
    end_ns = BEGIN_NS + round(first.attempts[0].keyframes_s.end * SECOND_NS)
    told = ending(attempt("squat", exemplar=0, pupil="7"), end_ns)
    log += [Entry("feedback", end_ns, codec.encode(told))]
    log += [Entry("corrections", end_ns, codec.encode(PupilCorrections((PupilCorrection(told.id, "8"),))))]
    again = reported(recorded(tmp_path / "b", log), Order(again=True), tmp_path / "2.json")
    assert [(one.action, one.pupil) for one in again.attempts] == [("squat", "8"), ("basketball_shot", "7")]


@pytest.mark.parametrize(("asked", "found"), [("07", "07"), ("7", "7"), ("7-2", "7-2"), ("emma2", "EMMA2")])
def test_a_lesson_with_codes_that_are_none_today_is_reported_by_them(tmp_path: Path, asked: str, found: str) -> None:
    held = ("07", "7") if asked in {"07", "7"} else ("7-2", "EMMA2")
    file = recorded(tmp_path / "lessons", log_of(None, *of_pupils(*held)))
    assert [one.pupil for one in reported(file, Order(), tmp_path / "all.json").pupils] == sorted(held)
    assert [one.pupil for one in reported(file, Order(pupil=asked), tmp_path / "one.json").attempts] == [found]


def test_of_a_lesson_of_today_pupil_07_is_pupil_7(tmp_path: Path) -> None:
    file = recorded(tmp_path / "lessons", log_of(None, *of_pupils("7", "B12")))
    assert [one.pupil for one in reported(file, Order(pupil="07"), tmp_path / "one.json").attempts] == ["7"]


def test_those_who_were_not_named_can_be_asked_for(tmp_path: Path) -> None:
    file = recorded(tmp_path, log_of(None, *said()))
    assert len(reported(file, Order(pupil="-"), tmp_path / "r.json").attempts) == 2


@pytest.mark.slow
def test_lessons_with_nothing_to_report_are_refused(tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert "is empty: its recording ended before anything was recorded" in refusal(recorded(tmp_path / "a", []), out)
    assert "holds no motion: it ended too early; report a longer one" in refusal(recorded(tmp_path / "b", log_of(None)), out)
    still = known_track(np.repeat(moving("squat").joints_m[:1], 90, axis=0), FRAME_S, 0.01)
    assert "lesson lesson has no attempt to report" in refusal(recorded(tmp_path / "c", log_of(still)), out)
    nobody = known_track(np.full((90, 17, 3), np.nan), FRAME_S)
    assert "lesson lesson has no attempt to report" in refusal(recorded(tmp_path / "d", log_of(nobody)), out)
    assert not out.exists()


def test_a_damaged_lesson_is_refused_and_nothing_is_written(tmp_path: Path) -> None:
    file = recorded(tmp_path / "lessons", log_of(moving("squat"), *said()))
    data = bytearray(file.read_bytes())
    for place in (len(data) // 2, 40):
        data[place] ^= 0xFF
        file.write_bytes(data)
        assert "is damaged" in refusal(file, tmp_path / "out")
    file.write_bytes(b"no lesson")
    assert "is no lesson of KineBox" in refusal(file, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_feedback_that_cannot_be_read_is_refused(tmp_path: Path) -> None:
    log = [Entry("tick", BEGIN_NS, b""), Entry("feedback", BEGIN_NS, b"what is this")]
    assert "holds what this KineBox cannot read" in refusal(recorded(tmp_path / "lessons", log), tmp_path / "out")


def test_a_file_that_is_there_is_not_overwritten(tmp_path: Path) -> None:
    file = recorded(tmp_path, log_of(None, *said()))
    before = file.read_bytes()
    assert refusal(file, file) == f"{file} is there already; remove it, or name another file with --out"
    assert file.read_bytes() == before


def test_a_full_disk_or_a_missing_folder_leaves_nothing_half_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = recorded(tmp_path / "lessons", log_of(None, *said()))
    assert refusal(file, tmp_path / "nowhere/r.html").endswith("name another file with --out")

    def full(path: Path, _data: bytes) -> None:
        raise OSError(errno.ENOSPC, "No space left on device", str(path))

    monkeypatch.setattr(command, "write_new", full)
    assert "cannot be written: No space left on device; make room there" in refusal(file, tmp_path / "r.html")
    assert [path.name for path in tmp_path.iterdir()] == ["lessons"]


@pytest.mark.slow
def test_as_people_type_it(tmp_path: Path) -> None:
    recorded(tmp_path / "data/lessons", log_of(None, *said()))

    def kinebox(*words: str) -> "subprocess.CompletedProcess[bytes]":
        line = [sys.executable, "-m", "services.cli.main", "report", *words, "--data", str(tmp_path / "data")]
        return subprocess.run(line, capture_output=True, cwd=ROOT, timeout=100, check=False)

    done = kinebox("lesson", "--format", "json", "--pupil", "-", "--language", "de")
    assert (done.returncode, done.stderr) == (0, b"")
    assert msgspec.json.decode(done.stdout, type=Report).language == "de"
    page = kinebox("lesson", "--out", str(tmp_path / "7b.html"))
    assert (page.returncode, page.stdout.decode(), page.stderr) == (0, f"{tmp_path}/7b.html\n", b"")
    assert (tmp_path / "7b.html").read_text().startswith("<!doctype html>")
    for words in (("lesson", "--language", "fr"), ("lesson", "--pupil", "P99"), ("nothing",), ("lesson", "--format", "pdf")):
        refused = kinebox(*words)
        assert (refused.returncode, refused.stdout) == (2, b"")
        assert refused.stderr.startswith(b"kinebox: ")
        assert refused.stderr.count(b"\n") == 1
