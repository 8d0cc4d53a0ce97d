"""Who stays with a lesson is told when nobody is left to record it, and does not wait for ever."""

import threading
from pathlib import Path

import pytest

from models.errors import UserError
from models.messages import codec, topics
from models.messages.health import Health, RecorderHealth
from models.process import Bus
from services.bus.memory import MemoryRouter
from services.cli import record as recording
from services.supervisor.policy import LONGEST_WAIT_S
from services.supervisor.silence import START_LIMIT_S
from tests.integration.fusion_room import SITE

LESSON = "2026-11-23-7b"


def said(lesson: str, recorded_s: float) -> bytes:
    return codec.encode(Health("recorder", 1, 5, "ok", (), 0.1, 50.0, recorder=RecorderHealth(lesson, "", recorded_s, 1, 0)))


def record_and_die(box: Bus) -> None:
    """A recorder that begins the lesson that it is asked for, says so once, and is heard no more."""
    requests = box.subscribe(topics.lesson_request(), keep=4)
    while requests.receive(0.02) is None:
        box.publish(topics.health("recorder"), said("", 0.0))
    for recorded_s in (0.0, 1.0):
        box.publish(topics.health("recorder"), said(LESSON, recorded_s))


@pytest.mark.parametrize("seconds", [8.0, None], ids=["for 8 s", "until it is ended"])
def test_a_box_that_died_ends_the_command_with_what_becomes_of_the_lesson(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], seconds: float | None
) -> None:
    router = MemoryRouter()
    box, asks = router.open(), router.open()
    monkeypatch.setattr(recording, "join", lambda _: asks)
    monkeypatch.setattr(recording, "GONE_AFTER_S", 0.6)
    monkeypatch.setattr(recording, "stop_on_signals", threading.Event)
    thread = threading.Thread(target=record_and_die, args=(box,))
    thread.start()
    words = rf"^nothing was heard of the recorder for 0\.6 s; .* lesson {LESSON} has is kept, and finished .* 'kinebox run'$"
    with pytest.raises(UserError, match=words):
        recording.record(SITE, tmp_path, "", seconds)
    thread.join()
    box.close()
    assert "recorded " not in capsys.readouterr().out


def test_a_recorder_that_is_only_restarted_is_waited_for() -> None:
    assert START_LIMIT_S + LONGEST_WAIT_S <= recording.GONE_AFTER_S
