"""Who has a lesson ended hears how it ended, and not only that it did."""

import pytest

from models.errors import UserError
from models.messages import codec, topics
from models.messages.health import Health, RecorderHealth
from models.messages.trouble import Trouble
from models.process import Bus
from services.bus.memory import MemoryRouter
from services.lesson import remote as remote_module
from services.lesson.remote import Remote, require_title

ENDED = Trouble("not_recording", "lesson 7b ended: No space left on device", "make room on the disk")


def said(lesson: str, trouble: Trouble | None = None) -> bytes:
    troubles = () if trouble is None else (trouble,)
    recorder = RecorderHealth(lesson, "", 10.0 if lesson else 0.0, 1, 0)
    return codec.encode(Health("recorder", 1, 5, "degraded" if troubles else "ok", troubles, 0.1, 50.0, recorder=recorder))


def asked(*words: bytes) -> tuple[Remote, Bus]:
    """Somebody who asks, and will hear these words of the recorder one after the other."""
    router = MemoryRouter()
    box, remote = router.open(), Remote(router.open())
    for word in words:
        box.publish(topics.health("recorder"), word)
    return remote, box


def test_a_lesson_that_ended_as_wished_is_told_with_its_length() -> None:
    remote, box = asked(said("7b"), said(""))
    last = remote.stop()
    assert last is not None
    assert (last.lesson, last.recorded_s) == ("7b", 10.0)
    box.close()


@pytest.mark.parametrize("words", [(said("7b"), said("", ENDED)), (said("", ENDED),)], ids=["while it ends", "before"])
def test_a_lesson_that_could_not_be_finished_is_told_with_the_reason(words: tuple[bytes, ...]) -> None:
    remote, box = asked(*words)
    with pytest.raises(UserError, match="lesson 7b ended: No space left on device; make room on the disk"):
        remote.stop()
    box.close()


STARTING = codec.encode(Health("recorder", 1, 5, "starting", (Trouble("getting_ready", "getting ready: lessons"),), 0.1, 50.0))
RESTARTING = codec.encode(Health("recorder", 1, 5, "failed", (Trouble("restarting", "said: X; it is tried again"),), 0.0, 0.0))


@pytest.mark.parametrize("away", [STARTING, RESTARTING], ids=["starting", "restarting"])
def test_a_lesson_is_ended_also_while_its_recorder_is_being_started_again(away: bytes) -> None:
    remote, box = asked(away, away, said("7b"), said(""))
    last = remote.stop()
    assert last is not None
    assert last.lesson == "7b"
    box.close()


def test_who_asks_a_recorder_that_does_not_come_back_hears_that_nothing_was_changed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(remote_module, "DONE_WITHIN_S", 0.3)
    remote, box = asked(RESTARTING)
    with pytest.raises(UserError, match="is not back yet: said: X; it is tried again; nothing was changed, try again"):
        remote.stop()
    box.close()


def test_where_nothing_was_recorded_nothing_is_ended() -> None:
    remote, box = asked(said(""))
    assert remote.stop() is None
    box.close()


@pytest.mark.parametrize("title", ["\udcff", "7b\udc80, throwing"])
def test_a_title_that_is_no_text_is_refused_before_anybody_is_asked(title: str) -> None:
    with pytest.raises(UserError, match="--title: it holds bytes that are not UTF-8; type it anew"):
        require_title(title)
