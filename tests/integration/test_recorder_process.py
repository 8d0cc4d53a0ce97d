"""The recorder as a process of its own, on real sockets, beside fusion's loop: asked, killed, restarted, out of disk."""

import os
import resource
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import BinaryIO

import pytest

from models.camera.rig import encode_rig
from models.config.site import BusConfig, LessonsConfig
from models.errors import USER_ERROR_CODE
from models.messages import codec, topics
from models.messages.addressed import read_health
from models.messages.health import Health, RecorderHealth
from models.messages.lesson import FusionLog, LessonRequest
from models.process import Bus, ProcessContext
from services.bus.memory import MemoryRouter
from services.bus.zenoh_bus import open_client, open_router
from services.fusion.config import PRESETS
from services.lesson.index import LessonIndex
from services.lesson.lesson_file import LessonWriter
from services.lesson.lesson_reader import LessonPart, open_lesson
from services.lesson.process import RecorderLoop
from services.lesson.recovery import RETRY_S, Left
from services.lesson.replay import compare, replay
from services.lesson.survey import Survey, survey
from services.site_file.rendering import render
from services.support.health import ResourceMeter
from tests.integration.fusion_room import RIG, SITE, Cameras, fusion
from tests.integration.waiting import DEADLINE_S, until
from tests.ports import free_port
from tests.synthetic.lesson import BEGIN_NS, header
from tests.synthetic.lesson import part as log_part

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
PARTS_A_SECOND = 2
LIMITED = """
import os, resource, sys
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]), int(sys.argv[1])))
os.execv(sys.argv[2], sys.argv[2:])
"""


class ZenohRoom:
    """Opens buses on one port; the first one is the router."""

    def __init__(self) -> None:
        self.endpoint = f"tcp/127.0.0.1:{free_port()}"
        self._routed = False

    def open(self) -> Bus:
        if self._routed:
            client = open_client(self.endpoint, threading.Event())
            assert client is not None
            return client
        self._routed = True
        return open_router(self.endpoint)


class Box:
    """Fusion and cameras in this process; whoever listens; and recorders that are started, killed and started again."""

    def __init__(self, folder: Path, lessons: LessonsConfig) -> None:
        self.room = ZenohRoom()
        self.data = folder / "data"
        self.lessons = self.data / lessons.folder
        (folder / "rig.toml").write_bytes(encode_rig(RIG, "synthetic"))
        self.site = folder / "site.toml"
        parts = {name: getattr(SITE, name) for name in SITE.__struct_fields__}
        self.site.write_text(render(type(SITE)(**parts | {"bus": BusConfig(self.room.endpoint), "lessons": lessons})))
        self.run_ns = time.monotonic_ns()
        self.heard: list[FusionLog] = []
        self.newest: Health | None = None

    @contextmanager
    def running(self) -> Iterator["Box"]:
        with ExitStack() as stack:
            stack.enter_context(fusion(self.room, self.data))
            cameras = Cameras(self.room)
            stack.callback(cameras.close)
            self.bus = self.room.open()
            stack.callback(self.bus.close)
            self._logs = self.bus.subscribe(topics.fusion_log(), keep=10_000)
            self._healths = self.bus.subscribe(topics.health("recorder"), keep=10_000)
            yield self

    @contextmanager
    def recorder(self, run_ns: int | None = None, file_limit: int = resource.RLIM_INFINITY) -> Iterator[subprocess.Popen[bytes]]:
        """A recorder as the supervisor starts it; it is killed at the end of the block unless it has ended."""
        command = [sys.executable, "-P", "-m", "services.cli.child", "recorder", "--site", str(self.site), "--data", str(self.data)]
        command += ["--start-ns", str(run_ns or self.run_ns), "--parent", str(os.getpid())]
        limited = [sys.executable, "-c", LIMITED, str(file_limit), *command]
        process = subprocess.Popen(limited, cwd=ROOT, env=dict(os.environ) | {"PYTHONPATH": str(ROOT)})
        try:
            yield process
        finally:
            process.kill()
            process.wait()

    def wish(self, action: str, title: str = "") -> None:
        """Ask for a lesson, again and again, until it has begun or ended."""

        def done() -> bool:
            self.bus.publish(topics.lesson_request(), codec.encode(LessonRequest("start" if action == "start" else "stop", title)))
            self.listen(0.3)
            return self.newest is not None and bool(self.newest.recorder and self.newest.recorder.lesson) == (action == "start")

        until(done, f"the lesson to {action}")

    def wait_recorded(self, pid: int, parts: int) -> RecorderHealth:
        """Until the recorder of that process id says that so many parts' worth is safe."""

        def done() -> bool:
            self.listen(0.2)
            newest = self.newest
            recorder = newest.recorder if newest is not None and newest.pid == pid else None
            return recorder is not None and recorder.recorded_s >= parts / PARTS_A_SECOND

        until(done, lambda: f"{parts} parts to be recorded; newest: {self.newest}")
        assert self.newest is not None
        assert self.newest.recorder is not None
        return self.newest.recorder

    def listen(self, timeout_s: float) -> None:
        """Take in what the recorder and fusion said."""
        delivery = self._healths.receive(timeout_s)
        while delivery is not None:
            self.newest = codec.decode(delivery.payload, Health)
            delivery = self._healths.receive(0.0)
        while (logged := self._logs.receive(0.0)) is not None:
            self.heard.append(codec.decode(logged.payload, FusionLog))

    def parts(self, lesson: str) -> list[LessonPart]:
        with open_lesson(self.lessons / f"{lesson}.mcap") as opened:
            return list(opened.parts())

    def require_replay(self, lesson: str, segments: int) -> None:
        """The file gives the motion again that fusion published, to the last bit."""
        with open_lesson(self.lessons / f"{lesson}.mcap") as opened:
            found = compare(replay(opened.parts(), opened.header.rig(), PRESETS[opened.header.preset]))
        assert found.first is None
        assert found.segments == segments
        assert found.equal == found.compared > 0


@pytest.fixture
def box(tmp_path: Path) -> Iterator[Box]:
    with Box(tmp_path, LessonsConfig()).running() as running:
        yield running


def test_a_lesson_is_recorded_on_request_and_replays_to_the_last_bit(box: Box) -> None:
    with box.recorder() as process:
        box.wish("start", "7b, throwing")
        lesson = box.wait_recorded(process.pid, parts=8).lesson
        box.wish("stop")
        (row,) = LessonIndex(box.lessons).lessons()
        assert (row.lesson, row.title, row.state, row.gaps, row.segments) == (lesson, "7b, throwing", "finished", 0, 1)
        process.send_signal(signal.SIGTERM)
        assert process.wait(30.0) == 0
    heard = {(part.segment_ns, part.sequence): part.entries for part in box.heard}
    for part in box.parts(lesson):
        assert heard[part.segment_ns, part.sequence] == part.entries, "what is on the disk is not what was on the bus"
    box.require_replay(lesson, segments=1)


def test_kill_9_of_the_recorder_loses_nothing_that_fusion_logged_and_the_lesson_goes_on_after_the_restart(box: Box) -> None:
    with box.recorder() as process:
        box.wish("start", "killed")
        safe = box.wait_recorded(process.pid, parts=6)
        process.kill()
        process.wait()
    box.listen(0.0)
    with box.recorder() as again:
        after = box.wait_recorded(again.pid, parts=round(safe.recorded_s * PARTS_A_SECOND) + 6)
        assert (after.lesson, after.title, after.gaps) == (safe.lesson, "killed", 0)
        again.send_signal(signal.SIGTERM)
        assert again.wait(30.0) == 0
    parts = box.parts(safe.lesson)
    assert [part.sequence for part in parts] == list(range(len(parts)))
    assert not [part.gap for part in parts if part.gap]
    box.require_replay(safe.lesson, segments=1)


def test_after_a_crash_of_the_whole_box_the_lesson_is_completed_at_the_next_start(box: Box) -> None:
    with box.recorder() as process:
        box.wish("start", "crashed")
        safe = box.wait_recorded(process.pid, parts=4)
    assert [row.state for row in LessonIndex(box.lessons).lessons()] == ["unfinished"]
    with box.recorder(run_ns=time.monotonic_ns()):
        until(lambda: [row.state for row in LessonIndex(box.lessons).lessons()] == ["finished"], "the lesson to be completed")
    (row,) = LessonIndex(box.lessons).lessons()
    assert row.seconds >= safe.recorded_s - 0.1
    box.require_replay(safe.lesson, segments=1)


def test_a_disk_that_takes_no_more_ends_the_lesson_with_a_reason_and_keeps_what_was_safe(box: Box) -> None:
    with box.recorder(file_limit=120_000) as process:
        box.wish("start", "too long")
        assert box.newest is not None
        assert box.newest.recorder is not None
        lesson = box.newest.recorder.lesson

        def said() -> bool:
            box.listen(0.2)
            return box.newest is not None and box.newest.state == "degraded" and "File too large" in box.newest.reason

        until(said, "the recorder to say that it cannot write")
        assert process.poll() is None, "the recorder must live on"
        assert box.newest.recorder is not None
        process.send_signal(signal.SIGTERM)
        assert process.wait(30.0) == 0
    with box.recorder(run_ns=time.monotonic_ns()):
        until((box.lessons / f"{lesson}.mcap").exists, "the lesson to be completed")
    box.require_replay(lesson, segments=1)


def test_a_lesson_that_a_full_disk_left_unfinished_is_finished_by_the_box_that_runs_once_there_is_room_beside_the_next_one(
    box: Box,
) -> None:
    def said(words: str) -> bool:
        box.listen(0.2)
        return box.newest is not None and words in box.newest.reason

    with box.recorder() as process:
        box.wish("start", "cut short")
        safe = box.wait_recorded(process.pid, parts=4)
        finished = box.lessons / f"{safe.lesson}.mcap"
        (file,) = box.lessons.glob("*.mcap.part")
        # Not a byte more, as on a full disk.
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (file.stat().st_size, resource.RLIM_INFINITY))
        until(lambda: said("is not finished yet: File too large"), "the recorder to say that the lesson is not finished")
        assert not finished.exists()
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
        box.wish("start", "the next one")
        until(finished.exists, "the lesson to be finished", RETRY_S + DEADLINE_S)
        until(lambda: not said("is not finished yet"), "the recorder to say no more of it")
        assert box.newest is not None
        assert box.newest.recorder is not None
        assert box.newest.recorder.title == "the next one"
    assert len(box.parts(safe.lesson)) >= 4
    box.require_replay(safe.lesson, segments=1)


def test_two_recorders_never_work_in_one_folder(box: Box) -> None:
    with box.recorder() as process:
        box.wish("start", "mine")
        with box.recorder() as other:
            assert other.wait(60.0) == USER_ERROR_CODE
        assert process.poll() is None


def test_an_automatic_recorder_records_from_the_start_of_the_box(tmp_path: Path) -> None:
    with Box(tmp_path, LessonsConfig(automatic=True)).running() as box, box.recorder() as process:
        lesson = box.wait_recorded(process.pid, parts=2).lesson
        process.send_signal(signal.SIGTERM)
        assert process.wait(30.0) == 0
        assert box.parts(lesson)


def test_kill_9_of_an_automatic_recorder_that_was_told_to_stop_records_nobody(tmp_path: Path) -> None:
    with Box(tmp_path, LessonsConfig(automatic=True)).running() as box:
        with box.recorder() as process:
            box.wait_recorded(process.pid, parts=2)
            box.wish("stop")
        with box.recorder() as again:
            begun_s: list[float] = []

            def spoke_for_three_seconds() -> bool:
                box.listen(0.2)
                if box.newest is not None and box.newest.pid == again.pid:
                    assert box.newest.recorder is not None
                    assert not box.newest.recorder.lesson
                    begun_s.append(time.monotonic())
                return bool(begun_s) and begun_s[-1] - begun_s[0] > 3.0

            until(spoke_for_three_seconds, "the second recorder to be heard")
        assert len(LessonIndex(box.lessons).lessons()) == 1


def test_while_it_recovers_what_was_left_the_recorder_is_heard(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    router = MemoryRouter()
    heard = router.open().subscribe(topics.health("recorder"), keep=1)

    def cut_short(_left: Left, _run_ns: int) -> None:
        delivery = heard.receive(DEADLINE_S)
        assert delivery is not None, "a supervisor would take this recorder for hung"
        assert read_health(delivery.topic, delivery.payload).process == "recorder"

    monkeypatch.setattr(Left, "cut_short", cut_short)
    context = ProcessContext("recorder", None, SITE, RIG, tmp_path, 0, router.open(), threading.Event(), ResourceMeter())
    RecorderLoop(context, tmp_path)


def test_a_lesson_is_recorded_while_one_of_before_is_still_being_completed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    old = LessonWriter.create(tmp_path, "old", header())
    old.append(log_part(BEGIN_NS, 0))
    old.close()
    router, stop, read = MemoryRouter(), threading.Event(), threading.Event()
    room = router.open()
    heard = room.subscribe(topics.health("recorder"), keep=100)

    def hours_of_lesson(file: BinaryIO, ends: threading.Event | None = None) -> Survey:
        read.wait(DEADLINE_S)
        return survey(file, ends)

    def recording() -> bool:
        room.publish(topics.lesson_request(), codec.encode(LessonRequest("start", "7b")))
        delivery = heard.receive(0.5)
        said = None if delivery is None else read_health(delivery.topic, delivery.payload).recorder
        return said is not None and said.title == "7b"

    monkeypatch.setattr("services.lesson.recovery.survey", hours_of_lesson)
    context = ProcessContext("recorder", None, SITE, RIG, tmp_path, 0, router.open(), stop, ResourceMeter())
    running = threading.Thread(target=lambda: RecorderLoop(context, tmp_path).run())
    running.start()
    try:
        until(recording, "the lesson to begin")
        assert not (tmp_path / "old.mcap").exists()
        read.set()
        until((tmp_path / "old.mcap").exists, "the old lesson to be completed")
    finally:
        read.set()
        stop.set()
        running.join(DEADLINE_S)
    assert len(list(tmp_path.glob("*.mcap"))) == 2


def test_while_the_disk_holds_up_a_write_the_recorder_says_so_once_a_second_and_then_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    router, stop, disk_takes = MemoryRouter(), threading.Event(), threading.Event()
    room = router.open()
    heard, healths = room.subscribe(topics.health("recorder"), keep=100), list[Health]()

    def said(count: int, *, lesson: bool, troubled: bool) -> bool:
        while (delivery := heard.receive(0.1)) is not None:
            healths.append(read_health(delivery.topic, delivery.payload))
        recent = [(bool(one.recorder and one.recorder.lesson), bool(one.troubles)) for one in healths]
        return recent[-count:] == [(lesson, troubled)] * count

    synced = os.fsync

    def sync(descriptor: int) -> None:
        disk_takes.wait(DEADLINE_S)
        synced(descriptor)

    monkeypatch.setattr("services.lesson.lesson_file.os.fsync", sync)
    loop = RecorderLoop(ProcessContext("recorder", None, SITE, RIG, tmp_path, 0, router.open(), stop, ResourceMeter()), tmp_path)
    running = threading.Thread(target=loop.run)
    running.start()
    try:
        until(lambda: said(1, lesson=False, troubled=False), "the recorder to be heard")
        room.publish(topics.lesson_request(), codec.encode(LessonRequest("start", "7b")))
        until(lambda: said(3, lesson=False, troubled=True), f"words about the disk; heard {healths}")
        assert [trouble.code for trouble in healths[-1].troubles] == ["recording_stalled"]
        assert "disk" in healths[-1].reason
        before_ns, after_ns = (one.t_ns for one in healths[-2:])
        assert after_ns - before_ns >= 900_000_000, "the page wants no more than one a second"
        disk_takes.set()
        until(lambda: said(2, lesson=True, troubled=False), f"the lesson to begin; heard {healths}")
    finally:
        disk_takes.set()
        stop.set()
        running.join(DEADLINE_S)
