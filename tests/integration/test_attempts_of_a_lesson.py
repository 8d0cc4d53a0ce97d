"""The list of attempts on real sockets: numbered as the lesson's file, and whole again when the page's server was started again."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import msgspec
import numpy as np
import pytest
from websockets.sync.client import connect

from models.camera.rig import encode_rig
from models.config.site import BusConfig, LessonsConfig, TabletConfig
from models.messages import codec, topics
from models.messages.attempts import REMEMBERED, AttemptsBegin
from models.messages.feedback import Feedback
from models.process import ProcessContext
from services.evaluation.process import EvaluationLoop
from services.lesson.lesson_reader import open_lesson
from services.lesson.pupils import attempts_told
from services.site_file.rendering import render
from services.support.health import ResourceMeter
from services.tablet.attempts import SINCE_THE_BOX
from services.tablet.page import PAGE
from tests.integration.fusion_room import RIG, SITE
from tests.integration.page_server import answers, hears, listed, next_list, numbers, page_server
from tests.integration.test_recorder_process import ROOT, Box, ZenohRoom
from tests.integration.waiting import until
from tests.mutations.samples import feedback
from tests.ports import free_port
from tests.taught import some

pytestmark = pytest.mark.slow

FRAMES = 600
"""Of a long attempt: a quarter of a megabyte on the bus."""


@pytest.fixture
def box(tmp_path: Path) -> Iterator[Box]:
    with Box(tmp_path, LessonsConfig()).running() as running:
        yield running


def publish(box: Box) -> int:
    """Let an attempt end now; its name."""
    made = feedback(time.monotonic_ns())
    box.bus.publish(topics.feedback(), codec.encode(made))
    time.sleep(0.2)  # nobody tries more in a second
    return made.id


def test_numbers_are_those_of_the_report_and_a_recording_begins_with_an_empty_list(
    box: Box, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with box.recorder() as recorder:
        with page_server(box.room, tmp_path, monkeypatch) as address:
            until(lambda: hears(address, "recorder"), "the server to hear the recorder")
            before = publish(box)
            until(lambda: numbers(address) == [(before, 1)], "the attempt before the lesson")
            box.wish("start", "7b")
            until(lambda: numbers(address) == [], "an empty list")
            name = box.wait_recorded(recorder.pid, parts=1).lesson
            tried = [publish(box) for _ in range(3)]
            until(lambda: numbers(address) == list(zip(tried, (1, 2, 3), strict=True)), "the lesson's attempts")
            said = box.wait_recorded(recorder.pid, parts=4)
            assert (said.attempts, said.newest) == (3, tuple(tried))
        # Nobody remembers them but the lesson.
        with page_server(box.room, tmp_path, monkeypatch) as address:
            until(lambda: listed(address)["earlier"] == "recorded", "the page to say where they are")
            tried.append(publish(box))
            until(lambda: numbers(address) == [(tried[-1], 4)], "the next attempt with the lesson's number")
            until(lambda: box.wait_recorded(recorder.pid, parts=1).attempts == 4, "the last attempt to be safe")
            box.wish("stop")
    with open_lesson(box.lessons / f"{name}.mcap") as lesson:
        assert [one.id for one in attempts_told(lesson.parts())] == tried


def long(told: Feedback) -> Feedback:
    """The same attempt with many more frames."""
    frames = {
        name: np.concatenate([getattr(told, name)] * (FRAMES // 10)) for name in ("joints_m", "states", "colours", "standard_m")
    }
    return msgspec.structs.replace(told, **frames)


@contextmanager
def remembering(folder: Path, told: list[Feedback]) -> Iterator[ZenohRoom]:
    """A room with an evaluation that has told of these attempts."""
    room, stop = ZenohRoom(), threading.Event()
    router = room.open()
    context = ProcessContext(
        name="evaluation",
        camera=None,
        site=SITE,
        rig=RIG,
        data=folder,
        start_ns=time.monotonic_ns(),
        bus=room.open(),
        stop=stop,
        resources=ResourceMeter(),
    )
    loop = EvaluationLoop(context, some("squat"))
    loop._memory.begin(AttemptsBegin(SINCE_THE_BOX))
    for one in told:
        loop._memory.note(one)
    evaluation = threading.Thread(target=loop.run, daemon=True)
    evaluation.start()
    try:
        yield room
    finally:
        stop.set()
        evaluation.join()
        context.bus.close()
        router.close()


def test_fifty_long_attempts_are_told_again_over_real_sockets_and_all_at_once_to_a_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    began_ns = time.monotonic_ns()
    told = [long(feedback(began_ns - (100 - number) * 10**8)) for number in range(REMEMBERED + 3)]
    with remembering(tmp_path, told) as room:
        for _ in range(2):
            with page_server(room, tmp_path, monkeypatch) as address, connect(address.replace("http", "ws") + "ws") as tablet:
                first = next_list(tablet)
            assert [attempt["id"] for attempt in first["attempts"]] == [one.id for one in told[3:]], "whole, in one message"
            assert [attempt["number"] for attempt in first["attempts"]] == list(range(4, REMEMBERED + 4))
            assert first["earlier"] == "listed"


@pytest.mark.skipif(not (PAGE / "index.html").is_file(), reason="the page is not built: run 'make web'")
def test_kill_9_of_the_page_s_server_costs_nothing_of_the_list(tmp_path: Path) -> None:
    told = [feedback(time.monotonic_ns() - (10 - number) * 10**9) for number in range(5)]
    with remembering(tmp_path, told) as room:
        port = free_port()
        address = f"http://127.0.0.1:{port}/"
        (tmp_path / "rig.toml").write_bytes(encode_rig(RIG, "synthetic"))
        parts = {name: getattr(SITE, name) for name in SITE.__struct_fields__}
        own = {"bus": BusConfig(room.endpoint), "tablet": TabletConfig(host="127.0.0.1", port=port)}
        (tmp_path / "site.toml").write_text(render(type(SITE)(**parts | own)))
        expected = [(one.id, number) for number, one in enumerate(told, start=1)]
        for _ in range(2):
            command = [sys.executable, "-P", "-m", "services.cli.child", "tablet", "--site", str(tmp_path / "site.toml")]
            command += ["--data", str(tmp_path), "--start-ns", str(time.monotonic_ns()), "--parent", str(os.getpid())]
            server = subprocess.Popen(command, cwd=ROOT, env=dict(os.environ) | {"PYTHONPATH": str(ROOT)})
            try:
                until(lambda: answers(address) and numbers(address) == expected, "the whole list")
            finally:
                os.kill(server.pid, signal.SIGKILL)
                server.wait()
