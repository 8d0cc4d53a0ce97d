"""A machine that has no memory, process or descriptor left: the supervisor waits, tells, and leaves nothing half made."""

import errno
import io
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from models.config.site import SupervisorConfig
from services.supervisor.child import Child, ChildSpec
from services.supervisor.journal import Journal
from services.supervisor.post import Post
from services.supervisor.spares import AFTER_S, AGAIN_AFTER_S, Spares

SHORT = OSError(errno.ENOMEM, "Cannot allocate memory")


def refuse(*_: Any) -> Any:
    raise SHORT


def test_a_process_that_cannot_be_watched_is_not_left_running(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[subprocess.Popen[bytes]] = []

    class Noted(subprocess.Popen[bytes]):
        def __init__(self, *arguments: Any, **options: Any) -> None:
            super().__init__(*arguments, **options)
            made.append(self)

    monkeypatch.setattr(subprocess, "Popen", Noted)
    monkeypatch.setattr(os, "pidfd_open", refuse)
    with pytest.raises(OSError, match="Cannot allocate memory"):
        Child([sys.executable, "-c", "import time; time.sleep(600)"], os.environ, waits=True)
    (process,) = made
    assert process.returncode is not None
    assert process.stdin is not None
    assert process.stdout is not None
    assert process.stdin.closed
    assert process.stdout.closed


def test_a_post_that_cannot_be_manned_is_tried_again_later_and_later_and_given_up_in_the_end() -> None:
    config = SupervisorConfig(max_restarts=3, window_s=600)
    post, starts_s = Post(ChildSpec("edge", "a")), list[float]()
    for _ in range(3):
        post.not_started(SHORT, starts_s[-1] if starts_s else 100.0, config)
        assert post.start_at_s is not None
        starts_s.append(post.start_at_s)
    assert starts_s == [100.0, 100.25, 100.75]
    assert post.trouble == "edge-a could not be started (Cannot allocate memory) and is started again"
    assert post.restarts is not None
    assert post.restarts.reason == "could not be started (Cannot allocate memory)"
    post.not_started(SHORT, starts_s[-1], config)
    assert post.start_at_s is None
    assert post.given_up == "ended 4 times within 600 s; last, it could not be started (Cannot allocate memory)"


def test_a_spare_that_cannot_be_started_is_said_and_tried_again_a_minute_later(tmp_path: Path) -> None:
    console, asked = io.StringIO(), []

    def begin(spec: ChildSpec) -> Child:
        asked.append(spec.name)
        raise SHORT

    journal = Journal(tmp_path, console)
    spares = Spares(begin, journal)
    for now_s in (AFTER_S, AFTER_S + 1.0, AFTER_S + AGAIN_AFTER_S - 1.0):
        spares.keep(ChildSpec("tablet"), 0.0, now_s)
    assert asked == ["tablet"]
    spares.keep(ChildSpec("tablet"), 0.0, AFTER_S + AGAIN_AFTER_S)
    assert asked == ["tablet", "tablet"]
    assert spares.take("tablet") is None
    journal.close()
    assert "a spare of tablet could not be started (Cannot allocate memory)" in console.getvalue()
