"""Who has a lesson ended hears how it ended, and not only that it did."""

import pytest

from models.errors import UserError
from models.messages import codec, topics
from models.messages.health import Health, RecorderHealth
from models.messages.lesson import LessonRequest
from models.messages.trouble import Trouble
from models.process import Bus
from services.bus.memory import MemoryBus, MemoryRouter
from services.lesson import remote as remote_module
from services.lesson.remote import Remote, require_title

ENDED = Trouble("not_recording", "lesson 7b ended: No space left on device", "make room on the disk")


def said(lesson: str, trouble: Trouble | None = None, asked_ns: int = 0) -> bytes:
    troubles = () if trouble is None else (trouble,)
    recorder = RecorderHealth(lesson, "", 10.0 if lesson else 0.0, 1, 0, asked_ns=asked_ns)
    return codec.encode(Health("recorder", 1, 5, "degraded" if troubles else "ok", troubles, 0.1, 50.0, recorder=recorder))


def asked(*words: bytes) -> tuple[Remote, Bus]:
    """Somebody who asks, and will hear these words of the recorder one after the other."""
    router = MemoryRouter()
    box, remote = router.open(), Remote(router.open())
    for word in words:
        box.publish(topics.health("recorder"), word)
    return remote, box


class Answered(MemoryBus):
    """The place of somebody who asks for a lesson a moment after somebody else, who may have begun it."""

    def __init__(self, router: MemoryRouter, *, before_ns: int) -> None:
        super().__init__(router)
        self._before_ns = before_ns

    def publish(self, topic: str, payload: bytes) -> None:
        request = codec.decode(payload, LessonRequest)
        assert topic == topics.lesson_request()
        self.deliver(topics.health("recorder"), said("7b", asked_ns=request.t_ns - self._before_ns))


def asking(before_ns: int) -> Remote:
    bus = Answered(MemoryRouter(), before_ns=before_ns)
    remote = Remote(bus)
    bus.deliver(topics.health("recorder"), said(""))
    return remote


def test_who_asks_for_a_lesson_is_told_the_one_that_was_begun_for_him() -> None:
    assert asking(before_ns=0).start("7b").lesson == "7b"


def test_of_two_who_ask_for_a_lesson_at_once_the_second_does_not_take_the_firsts_for_his() -> None:
    with pytest.raises(UserError, match=r"^lesson 7b is being recorded already; end it with 'kinebox record --stop'$"):
        asking(before_ns=400_000_000).start("7b")


def test_a_lesson_that_ended_as_wished_is_told_with_its_length() -> None:
    remote, box = asked(said("7b"), said(""))
    last = remote.stop()
    assert last is not None
    assert (last.lesson, last.recorded_s) == ("7b", 10.0)
    box.close()


def test_who_ends_his_lesson_ends_none_that_was_begun_since() -> None:
    remote, box = asked(said("8c"))
    requests = box.subscribe(topics.lesson_request(), keep=4)
    assert remote.stop("7b") is None
    assert requests.receive(0.0) is None
    box.close()


@pytest.mark.parametrize("lesson", ["", "7b"], ids=["whichever it is", "by its name"])
def test_the_lesson_that_was_heard_is_the_one_that_is_ended_and_no_other(lesson: str) -> None:
    """Another one may begin while the wish is on its way."""
    remote, box = asked(said("7b"), said("8c"))
    requests = box.subscribe(topics.lesson_request(), keep=4)
    last = remote.stop(lesson)
    assert last is not None
    assert last.lesson == "7b"
    request = requests.receive(0.0)
    assert request is not None
    assert codec.decode(request.payload, LessonRequest) == LessonRequest("stop", lesson="7b")
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
