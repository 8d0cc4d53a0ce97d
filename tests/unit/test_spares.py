"""Who may take over a post at once, and how long it then has: real processes, without a box around them."""

import io
import os
import select
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from models.process import SPARE_READY
from services.supervisor.child import Child, ChildSpec
from services.supervisor.journal import Journal
from services.supervisor.silence import LIMIT_S, START_LIMIT_S, Silence
from services.supervisor.spares import AFTER_S, AGAIN_AFTER_S, Spares
from tests.integration.waiting import until

TABLET = ChildSpec("tablet")
WAITS = "import sys; sys.stdin.readline()"
IS_READY = f"import sys; sys.stdout.write({SPARE_READY!r} + '\\n'); sys.stdout.flush(); sys.stdin.readline()"


class Room:
    """Spares of a page's server that do what a line of Python says."""

    def __init__(self, folder: Path, code: str) -> None:
        self.console = io.StringIO()
        self.begun: list[Child] = []
        self.taken: list[Child] = []
        self.journal = Journal(folder, self.console)
        self.spares = Spares(lambda _: self._begin(code), self.journal)

    def keep(self, now_s: float = AFTER_S) -> Child:
        self.spares.keep(TABLET, 0.0, now_s)
        return self.begun[-1]

    def take(self) -> Child | None:
        spare = self.spares.take("tablet")
        self.taken += [] if spare is None else [spare]
        return spare

    def said(self) -> str:
        """All that a person was shown until now; nothing is shown any more."""
        self.journal.close()
        return self.console.getvalue()

    def _begin(self, code: str) -> Child:
        self.begun.append(Child([sys.executable, "-c", code], os.environ, waits=True))
        return self.begun[-1]


@pytest.fixture
def room(tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[Room]:
    room = Room(tmp_path, request.param)
    yield room
    room.spares.dismiss()
    for child in room.taken:
        child.kill()
        child.wait()
        child.close()


def stop(child: Child) -> None:
    os.kill(child.pid, signal.SIGSTOP)
    until(lambda: child.stopped, "the kernel to stop it")


@pytest.mark.parametrize("room", [WAITS], indirect=True)
def test_a_spare_that_is_stopped_does_not_take_the_post(room: Room) -> None:
    spare = room.keep()
    assert not spare.stopped
    stop(spare)
    assert room.take() is None
    assert spare.poll() == -signal.SIGKILL
    assert "tablet" in room.said()


@pytest.mark.parametrize("room", [WAITS], indirect=True)
def test_a_spare_that_goes_on_after_it_was_stopped_is_none_that_is_stopped(room: Room) -> None:
    spare = room.keep()
    stop(spare)
    os.kill(spare.pid, signal.SIGCONT)
    until(lambda: not spare.stopped, "the kernel to let it go on")
    assert room.take() is spare


@pytest.mark.parametrize("room", [WAITS], indirect=True)
def test_a_spare_that_is_stopped_while_it_waits_is_replaced_a_minute_later(room: Room) -> None:
    spare = room.keep()
    stop(spare)
    until(lambda: room.keep().poll() is not None, "the end of the stopped spare")
    room.keep(AFTER_S + 1.0)
    assert room.keep(AFTER_S + AGAIN_AFTER_S - 1.0) is spare
    assert room.keep(AFTER_S + AGAIN_AFTER_S) is not spare
    assert room.said().count("stopped") == 1


@pytest.mark.parametrize("room", [IS_READY], indirect=True)
def test_a_spare_says_when_it_is_ready_and_the_log_does_not(room: Room, tmp_path: Path) -> None:
    until(lambda: room.keep().ready, "the spare's word that it is ready")
    taken = room.take()
    assert taken is not None
    assert taken.ready
    assert room.said() == ""
    assert SPARE_READY not in (tmp_path / "kinebox.log").read_text()


@pytest.mark.parametrize("room", [IS_READY], indirect=True)
def test_the_word_that_was_not_read_yet_counts_when_the_post_is_taken(room: Room) -> None:
    spare = room.keep()
    # To look whether something is there without reading it.
    until(lambda: bool(select.select([spare._output], [], [], 0.05)[0]), "the spare's word")
    assert not spare.ready
    assert room.take() is spare
    assert spare.ready


@pytest.mark.parametrize("room", [WAITS], indirect=True)
def test_a_spare_that_is_still_importing_is_not_ready(room: Room) -> None:
    room.keep()
    taken = room.take()
    assert taken is not None
    assert not taken.ready


@pytest.mark.parametrize("name", ["fusion", "tablet"])
def test_who_was_ready_when_it_took_over_and_is_not_heard_has_hung_after_three_seconds(name: str) -> None:
    silence = Silence("fusion")
    silence.start("fusion", 0.0)
    silence.hear("fusion", 0.0)
    silence.start(name, 10.0, ready=True)
    for tenth in range(30):
        if name != "fusion":
            silence.hear("fusion", 10.0 + tenth / 10)
        assert silence.hung(10.0 + tenth / 10) == []
    assert silence.hung(10.0 + LIMIT_S + 0.1) == [name]


def test_nobody_who_took_over_is_blamed_for_a_router_that_is_not_there_yet() -> None:
    silence = Silence("fusion")
    silence.start("fusion", 0.0)
    silence.start("tablet", 0.0, ready=True)
    assert silence.hung(60.0) == []
    silence.hear("fusion", 60.0)
    for second in range(61, 63):
        silence.hear("fusion", float(second))
        assert silence.hung(float(second)) == []
    silence.hear("fusion", 63.2)
    assert silence.hung(63.2) == ["tablet"]


def test_who_took_over_and_has_to_get_ready_again_has_the_time_for_that() -> None:
    silence = Silence("fusion")
    silence.start("fusion", 0.0, ready=True)
    silence.get_ready("fusion", 1.0)
    assert silence.hung(START_LIMIT_S) == []
    silence.start("fusion", 200.0)
    assert silence.hung(200.0 + START_LIMIT_S) == []
