"""A full disk is one fault, however much comes from it, and the only remedy that is told is the one that helps."""

import datetime as dt
import errno
import os
import tempfile
from dataclasses import replace
from pathlib import Path

import msgspec
import pytest

from models.messages.health import MachineHealth
from models.messages.trouble import Trouble
from services.doctor.box import judge_box
from services.doctor.finding import Examined, Finding
from services.doctor.folders import FolderProblem, try_folder
from services.doctor.lessons import LessonsFolder, gather_lessons, judge_lessons
from services.doctor.machine import MachineFacts, judge_machine
from services.doctor.report import as_json
from tests.unit.test_doctor import box, health

DATA = Path("data")
FULL = FolderProblem("cannot be used: No space left on device", full=True)
HEALTH = MachineHealth(1.9, 2.0, 4000.0, 128.0, 55.0, 0, 0.0)
LACKING = "134 MB are left on the disk, lessons.least_free_mb is 500"
LESSONS = LessonsFolder(DATA / "lessons", DATA / "lessons", "", LACKING, "make room", beside_data=True, index=None)


def machine(free_mib: float, problem: FolderProblem | None = FULL) -> MachineFacts:
    measured = msgspec.structs.replace(HEALTH, disk_free_mib=free_mib)
    wall = dt.datetime(2027, 1, 1, tzinfo=dt.UTC)
    return MachineFacts(measured, "a processor", "x86_64", frozenset({"avx2"}), 4, 8000.0, wall, DATA, problem)


def told(free_mib: float, lessons: LessonsFolder = LESSONS) -> tuple[Finding, ...]:
    """By the doctor's own look and by a box that runs, which measured a little later."""
    later = msgspec.structs.replace(HEALTH, disk_free_mib=free_mib - 3.0)
    log = Trouble("log_not_kept", "nothing is kept in kinebox.log: No space left on device", "make room")
    running = judge_box(box(health("supervisor", "degraded", log, machine=later)))
    return Examined.join([judge_machine(machine(free_mib)), judge_lessons(lessons), running]).findings


def test_a_full_disk_is_told_once_with_how_much_room_is_to_be_made() -> None:
    (finding,) = told(128.0)
    assert (finding.where, finding.what) == ("disk", "the disk of the data folder is full: 134 MB are free")
    assert "until 2.0 GB are free" in finding.remedy
    assert "rights" not in finding.remedy


def test_of_a_disk_with_too_little_for_a_lesson_the_fault_is_told_and_not_its_warning() -> None:
    found = Examined.join([judge_machine(machine(300.0, None)), judge_lessons(LESSONS)]).findings
    assert [(each.level, each.where) for each in found] == [("fault", "lessons")]


def test_a_full_disk_of_the_lessons_alone_is_told_beside_that_of_the_data_folder() -> None:
    assert [each.where for each in told(128.0, replace(LESSONS, beside_data=False))] == ["disk", "lessons"]


def test_a_disk_that_has_bytes_and_takes_no_file_is_told_with_what_may_fill_it() -> None:
    (finding,) = judge_machine(machine(50_000.0)).findings
    assert finding.where == "data folder"
    assert "too many files" in finding.remedy
    assert "owner" not in finding.remedy


def test_nobody_is_sent_to_correct_the_rights_of_a_folder_of_lessons_whose_disk_is_full(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "lessons").mkdir()

    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(tempfile, "TemporaryFile", full)
    assert try_folder(tmp_path) == FULL
    for free_mib, words in ((0.0, "0 MB are left on the disk"), (50_000.0, "No space left on device")):
        lessons = gather_lessons(None, tmp_path, lambda _, free=free_mib: free)  # type: ignore[misc]
        assert lessons is not None
        assert lessons.beside_data
        (finding,) = judge_lessons(lessons).findings
        assert words in finding.what
        assert f"other files on the disk of {tmp_path / 'lessons'}, until 700 MB are free" in finding.remedy
        assert "rights" not in finding.remedy


def test_what_findings_come_from_is_the_doctors_own_business() -> None:
    assert "cause" not in as_json(judge_machine(machine(128.0)))
