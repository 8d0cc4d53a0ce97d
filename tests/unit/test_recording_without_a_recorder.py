"""Who stays with a lesson is told when nobody is left to record it, or somebody else ended it, and does not wait for ever."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import ClassVar

import pytest

from models.errors import UserError
from models.messages import codec, topics
from models.messages.health import Health, RecorderHealth, SupervisorHealth
from models.messages.lesson import LessonRequest
from models.messages.trouble import Trouble
from models.process import Bus
from services.bus.memory import MemoryRouter
from services.cli import record as recording
from services.cli.progress import ProgressLine
from services.supervisor.policy import LONGEST_WAIT_S
from services.supervisor.silence import START_LIMIT_S
from tests.integration.fusion_room import SITE

LESSON = "2026-11-23-7b"
READ_ONLY = "lessons cannot be written: Read-only file system; correct its permissions"


@pytest.fixture
def box(monkeypatch: pytest.MonkeyPatch) -> Iterator[Bus]:
    """The bus of a box that the command joins; nothing runs there but what the test begins."""
    router = MemoryRouter()
    asks = router.open()
    monkeypatch.setattr(recording, "join", lambda _: asks)
    monkeypatch.setattr(recording, "stop_on_signals", threading.Event)
    with closing(router.open()) as opened:
        yield opened


@contextmanager
def at_work(what: Callable[[Bus], None], box: Bus) -> Iterator[None]:
    """Something that happens in the box, beside what is done in the block, and is over at its end."""
    thread = threading.Thread(target=what, args=(box,))
    thread.start()
    try:
        yield
    finally:
        thread.join()


def said(lesson: str, recorded_s: float, asked_ns: int = 0) -> bytes:
    recorder = RecorderHealth(lesson, "", recorded_s, 1, 0, asked_ns=asked_ns)
    return codec.encode(Health("recorder", 1, 5, "ok", (), 0.1, 50.0, recorder=recorder))


def record_and_die(box: Bus) -> None:
    """A recorder that begins the lesson that it is asked for, says so once, and is heard no more."""
    requests = box.subscribe(topics.lesson_request(), keep=4)
    while (asked := requests.receive(0.02)) is None:
        box.publish(topics.health("recorder"), said("", 0.0))
    asked_ns = codec.decode(asked.payload, LessonRequest).t_ns
    for recorded_s in (0.0, 1.0):
        box.publish(topics.health("recorder"), said(LESSON, recorded_s, asked_ns))


@pytest.mark.parametrize("seconds", [8.0, None], ids=["for 8 s", "until it is ended"])
def test_a_box_that_died_ends_the_command_with_what_becomes_of_the_lesson(
    tmp_path: Path, box: Bus, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], seconds: float | None
) -> None:
    monkeypatch.setattr(recording, "GONE_AFTER_S", 0.6)
    words = rf"^nothing was heard of the recorder for 0\.6 s; .* lesson {LESSON} has is kept, and finished .* 'kinebox run'$"
    with at_work(record_and_die, box), pytest.raises(UserError, match=words):
        recording.record(SITE, tmp_path, "", seconds)
    assert "recorded " not in capsys.readouterr().out


def test_a_box_that_ended_is_said_to_be_waited_for_and_then_to_be_gone(
    tmp_path: Path, box: Bus, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(recording, "accepts", lambda _: False)
    monkeypatch.setattr(recording, "_SILENT_S", 0.3)
    monkeypatch.setattr(recording, "BOX_GONE_AFTER_S", 0.6)
    gone = rf"^the box at tcp/.* is gone: .* lesson {LESSON} has is kept, .* 'kinebox run'$"
    with at_work(record_and_die, box), pytest.raises(UserError, match=gone):
        recording.record(SITE, tmp_path, "", 40.0)
    errors = capsys.readouterr().err
    assert errors.count("nothing is heard of the box at tcp/") == 1
    assert "it is waited for" in errors


def test_a_box_that_is_heard_again_goes_on_with_the_lesson(
    tmp_path: Path, box: Bus, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(recording, "accepts", lambda _: True)
    monkeypatch.setattr(recording, "_SILENT_S", 0.3)
    monkeypatch.setattr(recording, "BOX_GONE_AFTER_S", 0.6)
    monkeypatch.setattr(recording, "_ROUND_S", 0.05)

    def hang_and_go_on(box: Bus) -> None:
        record_and_die(box)
        time.sleep(1.0)
        box.publish(topics.health("recorder"), said(LESSON, 3.0))
        time.sleep(0.2)
        box.publish(topics.health("recorder"), said("", 0.0))

    with at_work(hang_and_go_on, box):
        recording.record(SITE, tmp_path, "", None)
    told = capsys.readouterr()
    assert "the box is heard again" in told.err
    assert f"{LESSON}.mcap, 0:03" in told.out


def instead(trouble: Trouble) -> bytes:
    """What the supervisor says in the recorder's place."""
    return codec.encode(Health("recorder", 2, 6, "failed", (trouble,), 0.0, 0.0))


def refuse_and_return(box: Bus) -> None:
    """A recorder whose disk is read-only for longer than nobody may be heard of it, and who then ends the lesson."""
    record_and_die(box)
    for _ in range(8):
        time.sleep(0.2)
        box.publish(topics.health("recorder"), instead(Trouble("restarting", f"{READ_ONLY}; it is tried again")))
    box.publish(topics.health("recorder"), said("", 0.0))


class Shown(ProgressLine):
    """Keeps every line that somebody who watches would see."""

    lines: ClassVar[list[str]] = []

    def show(self, line: str) -> None:
        self.lines.append(line)


def test_a_recorder_that_is_tried_again_is_waited_for_and_why_is_said(
    tmp_path: Path, box: Bus, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(recording, "GONE_AFTER_S", 1.2)
    monkeypatch.setattr(recording, "_SILENT_S", 0.9)
    monkeypatch.setattr(recording, "_ROUND_S", 0.05)
    monkeypatch.setattr(recording, "ProgressLine", Shown)
    monkeypatch.setattr(Shown, "lines", [])
    with at_work(refuse_and_return, box):
        recording.record(SITE, tmp_path, "", None)
    assert f"recorded 0:01, 0.0 MB; {READ_ONLY}; it is tried again" in Shown.lines
    assert not [line for line in Shown.lines if "nothing is heard" in line]
    assert f"{LESSON}.mcap, 0:01" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("seconds", "told"),
    [(20.0, "0:01; somebody else ended it before its 0:20\n"), (None, "0:01; somebody else ended it\n")],
    ids=["for 20 s", "until it is ended"],
)
def test_a_lesson_that_somebody_else_ended_is_said_to_have_ended_so(
    tmp_path: Path, box: Bus, capsys: pytest.CaptureFixture[str], seconds: float | None, told: str
) -> None:
    def end(box: Bus) -> None:
        record_and_die(box)
        box.publish(topics.health("recorder"), said("", 0.0))

    with at_work(end, box):
        recording.record(SITE, tmp_path, "", seconds)
    assert capsys.readouterr().out.endswith(f"{LESSON}.mcap, {told}")


def run_began(started_ns: int) -> bytes:
    """What the supervisor of a run of the box says."""
    supervisor = SupervisorHealth("0.1.0", started_ns, ())
    return codec.encode(Health("supervisor", 3, 7, "ok", (), 0.1, 50.0, supervisor=supervisor))


@pytest.mark.parametrize("file", [True, False], ids=["finished", "being finished"])
@pytest.mark.parametrize("automatic", ["", "2026-11-23-again"], ids=["no lesson", "an automatic lesson"])
def test_a_box_that_was_started_anew_is_not_said_to_have_ended_the_lesson_as_somebody_wished(
    tmp_path: Path, box: Bus, capsys: pytest.CaptureFixture[str], automatic: str, file: bool
) -> None:
    def start_anew(box: Bus) -> None:
        record_and_die(box)
        box.publish(topics.health("supervisor"), run_began(10))
        box.publish(topics.health("recorder"), said(automatic, 0.0))
        time.sleep(0.2)
        box.publish(topics.health("supervisor"), run_began(20))

    finished = tmp_path / SITE.lessons.folder / f"{LESSON}.mcap"
    if file:
        finished.parent.mkdir()
        finished.touch()
    left = rf"The lesson is in {finished}" if file else f"What it has is being finished; 'kinebox lessons' then lists {LESSON}"
    words = rf"^the box was started anew, and the lesson ended with its run\. {left}$"
    with at_work(start_anew, box), pytest.raises(UserError, match=words):
        recording.record(SITE, tmp_path, "", 40.0)
    assert "recorded " not in capsys.readouterr().out


def test_a_lesson_that_somebody_ended_in_the_same_run_is_said_to_have_ended_so(
    tmp_path: Path, box: Bus, capsys: pytest.CaptureFixture[str]
) -> None:
    def end(box: Bus) -> None:
        record_and_die(box)
        box.publish(topics.health("supervisor"), run_began(10))
        box.publish(topics.health("recorder"), said("", 0.0))
        time.sleep(0.2)
        box.publish(topics.health("supervisor"), run_began(10))

    with at_work(end, box):
        recording.record(SITE, tmp_path, "", None)
    assert "somebody else ended it" in capsys.readouterr().out


def give_up(box: Bus) -> None:
    """A recorder that dies too often."""
    record_and_die(box)
    box.publish(topics.health("recorder"), instead(Trouble("given_up", "it ended 5 times; last, it ended with exit code 1")))


@pytest.mark.timeout(20)
def test_a_recorder_that_is_given_up_ends_the_command_at_once_with_the_reason(
    tmp_path: Path, box: Bus, capsys: pytest.CaptureFixture[str]
) -> None:
    words = rf"^the recorder is given up: it ended 5 times; .* code 1\. What lesson {LESSON} has is kept, .* 'kinebox run'$"
    with at_work(give_up, box), pytest.raises(UserError, match=words):
        recording.record(SITE, tmp_path, "", None)
    assert "recorded " not in capsys.readouterr().out


def test_a_recorder_that_is_only_restarted_is_waited_for() -> None:
    assert START_LIMIT_S + LONGEST_WAIT_S <= recording.GONE_AFTER_S
