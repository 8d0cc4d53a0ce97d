"""The evaluation as a process, on real sockets: attempts of a true lesson, kill -9, and what the page shows meanwhile."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, Final

import httpx
import numpy as np
import pytest
from websockets.sync.client import connect

from models.camera.rig import encode_rig
from models.config.site import BusConfig, EvaluationConfig
from models.errors import USER_ERROR_CODE
from models.messages import codec, topics
from models.messages.feedback import ActivityRequest, Feedback
from models.messages.health import EvaluationHealth, Health
from models.messages.motion import JointState, Motion
from models.messages.pupil import PupilCorrections
from models.motions.motion import Attempt
from models.process import Bus
from models.skeleton import coco
from services.site_file.rendering import render
from services.tablet import attempt_replay, motion_frame
from tests.bench.teaching.cases import Case
from tests.bench.teaching.lessons import lesson_of
from tests.bench.teaching.twinned import truth_of
from tests.integration.fusion_room import RIG, SITE
from tests.integration.page_server import next_list, page_server
from tests.integration.test_recorder_process import ZenohRoom
from tests.integration.waiting import DEADLINE_S, until

pytestmark = [pytest.mark.slow, pytest.mark.timeout(240)]

ROOT: Final = Path(__file__).parents[2]
FRAME_S: Final = 1 / 30
LAG_NS: Final = 330_000_000
"""So late after its instant smooth motion comes from fusion."""
LESSON_S: Final = 90.0
STANDS_S: Final = 2.0
"""After the lesson's end."""


@cache
def lesson() -> tuple[np.ndarray[Any, np.dtype[np.float64]], tuple[Attempt, ...]]:
    """(T, 17, 3) true joints of a pupil who tries four things, and his attempts, seconds from the first frame."""
    actions = ("squat", "basketball_shot", "star_jump", "soccer_kick")
    truth = truth_of(lesson_of("evaluation", "development", 7, [Case("development", 7, action) for action in actions]))
    return truth.joints_m(np.arange(0.0, truth.motion.duration_s + STANDS_S, FRAME_S)), truth.motion.attempts


class Lesson:
    """Publishes the smooth and the live motion of the lesson at its own pace, as fusion does, until it is closed."""

    def __init__(self, bus: Bus) -> None:
        self._bus = bus
        self._stop = threading.Event()
        self._joints_m, self.attempts = lesson()
        # On fusion's grid, and the first motion is due now.
        self._first = round((time.monotonic_ns() - LAG_NS) * 1e-9 / FRAME_S)
        self._thread = threading.Thread(target=self._play, name="lesson", daemon=True)
        self._thread.start()

    def ended_ns(self, attempt: Attempt) -> int:
        """CLOCK_MONOTONIC of the true end of an attempt."""
        return round((self._first * FRAME_S + attempt.end_s) * 1e9)

    @property
    def over(self) -> bool:
        return not self._thread.is_alive()

    def close(self) -> None:
        self._stop.set()
        self._thread.join()

    def _play(self) -> None:
        for number, joints_m in enumerate(self._joints_m):
            t_ns = round((self._first + number) * FRAME_S * 1e9)
            if self._stop.wait(max((t_ns + LAG_NS - time.monotonic_ns()) * 1e-9, 0.0)):
                return
            for kind in ("smooth", "live"):
                made = Motion(
                    kind="smooth" if kind == "smooth" else "live",
                    sequence=number,
                    epoch=0,
                    t_ns=t_ns,
                    t_newest_ns=t_ns,
                    t_published_ns=time.monotonic_ns(),
                    joints_m=joints_m.astype(np.float32),
                    covariance_m2=np.tile(np.eye(3, dtype=np.float32) * np.float32(1e-4), (coco.COUNT, 1, 1)),
                    states=np.full(coco.COUNT, JointState.SEEN, np.uint8),
                    views=np.full(coco.COUNT, 3, np.uint32),
                    cameras=(),
                )
                self._bus.publish(topics.motion(kind), codec.encode(made))


class Box:
    """A router and a listener in this process; evaluations that are started, killed and started again."""

    def __init__(self, folder: Path, config: EvaluationConfig) -> None:
        self.room = ZenohRoom()
        self.data = folder / "data"
        self.data.mkdir()
        (folder / "rig.toml").write_bytes(encode_rig(RIG, "synthetic"))
        self.site = folder / "site.toml"
        parts = {name: getattr(SITE, name) for name in SITE.__struct_fields__}
        self.site.write_text(render(type(SITE)(**parts | {"bus": BusConfig(self.room.endpoint), "evaluation": config})))
        self.bus = self.room.open()
        self._feedback = self.bus.subscribe(topics.feedback(), keep=1000)
        self._healths = self.bus.subscribe(topics.health("evaluation"), keep=1000)
        self.newest: Health | None = None
        self.told: list[Feedback] = []

    def start(self) -> "subprocess.Popen[bytes]":
        """An evaluation as the supervisor starts it."""
        command = [
            sys.executable,
            "-P",
            "-m",
            "services.cli.child",
            "evaluation",
            "--site",
            str(self.site),
            "--data",
            str(self.data),
        ]
        command += ["--start-ns", str(time.monotonic_ns()), "--parent", str(os.getpid())]
        return subprocess.Popen(command, cwd=ROOT, env=dict(os.environ) | {"PYTHONPATH": str(ROOT)}, stderr=subprocess.PIPE)

    @contextmanager
    def evaluation(self) -> Iterator["subprocess.Popen[bytes]"]:
        """One that speaks; it is killed at the end of the block."""
        process = self.start()
        try:
            self.wait_for(lambda _: True, process.pid, process)
            yield process
        finally:
            process.kill()
            process.communicate()

    def listen(self) -> None:
        """Take in what the evaluation said."""
        while (delivery := self._healths.receive(0.0)) is not None:
            self.newest = codec.decode(delivery.payload, Health)
        while (delivery := self._feedback.receive(0.0)) is not None:
            self.told.append(codec.decode(delivery.payload, Feedback))

    def wait_for(self, is_so: Any, pid: int, process: "subprocess.Popen[bytes] | None" = None) -> EvaluationHealth:
        """Until the evaluation of that process id says of itself what is wanted; a `process` must not end before that."""

        def said() -> bool:
            self.listen()
            if process is not None and process.poll() is not None:
                raise AssertionError(process.communicate()[1].decode())
            newest = self.newest
            return newest is not None and newest.pid == pid and newest.evaluation is not None and bool(is_so(newest.evaluation))

        until(said, lambda: f"the evaluation's word; newest: {self.newest}", LESSON_S)
        assert self.newest is not None
        assert self.newest.evaluation is not None
        return self.newest.evaluation

    def ask(self, activity: str, pid: int) -> EvaluationHealth:
        """A tablet chooses."""

        def done(evaluation: EvaluationHealth) -> bool:
            if (evaluation.activity, evaluation.chosen_by) == (activity, "tablet"):
                return True
            self.bus.publish(topics.activity_request(), codec.encode(ActivityRequest(activity)))
            return False

        return self.wait_for(done, pid)


@pytest.fixture
def box(tmp_path: Path) -> Iterator[Box]:
    made = Box(tmp_path, EvaluationConfig())
    yield made
    made.bus.close()


def test_every_attempt_of_a_true_lesson_is_told_of_once_and_when_it_was(box: Box) -> None:
    with box.evaluation() as evaluation:
        playing = Lesson(box.bus)
        box.wait_for(lambda _: playing.over and len(box.told) >= len(playing.attempts), evaluation.pid)
        health = box.wait_for(lambda said: said.state == "unknown", evaluation.pid)
    assert [feedback.action for feedback in box.told] == [attempt.action for attempt in playing.attempts]
    for feedback, attempt in zip(box.told, playing.attempts, strict=True):
        assert abs(feedback.keyframes_ns[-1] - playing.ended_ns(attempt)) < 300_000_000
        assert feedback.by == "recognised"
        assert feedback.t_published_ns > feedback.keyframes_ns[-1]
        assert (feedback.states == JointState.SEEN).all()
    assert health.attempts == len(playing.attempts)
    assert health.attempt_ms > 0
    playing.close()


def test_kill_9_costs_no_more_than_the_attempts_meanwhile(box: Box) -> None:
    with box.evaluation() as evaluation:
        playing = Lesson(box.bus)
        box.wait_for(lambda _: len(box.told) >= 1, evaluation.pid)
        os.kill(evaluation.pid, signal.SIGKILL)
    before = len(box.told)
    with box.evaluation() as again:
        box.wait_for(lambda said: playing.over and said.state == "unknown", again.pid)
    playing.close()
    attempts = [attempt.action for attempt in playing.attempts]
    assert [feedback.action for feedback in box.told[:before]] == attempts[:before]
    # What was told afterwards are the last ones, nothing twice and nothing that was not.
    after = [feedback.action for feedback in box.told[before:]]
    assert after
    assert after == attempts[-len(after) :]
    assert len({feedback.id for feedback in box.told}) == len(box.told)


def test_what_a_tablet_chooses_is_what_is_found(box: Box) -> None:
    with box.evaluation() as evaluation:
        assert box.ask("star_jump", evaluation.pid).activity == "star_jump"
        box.bus.publish(topics.activity_request(), codec.encode(ActivityRequest("pole_vault")))
        box.wait_for(lambda said: said.rejected == 1, evaluation.pid)
        playing = Lesson(box.bus)
        box.wait_for(lambda said: playing.over and said.state == "unknown", evaluation.pid)
    playing.close()
    assert [(feedback.action, feedback.by) for feedback in box.told] == [("star_jump", "chosen")]


def test_the_site_says_what_pupils_do_at_first(tmp_path: Path) -> None:
    box = Box(tmp_path, EvaluationConfig(activity="long_jump"))
    with box.evaluation() as evaluation:
        said = box.wait_for(lambda _: True, evaluation.pid)
    assert (said.activity, said.chosen_by, said.state) == ("long_jump", "site", "unknown")
    box.bus.close()


@pytest.mark.parametrize(
    ("config", "line"),
    [
        (EvaluationConfig(activity="pole_vault"), "no action is called 'pole_vault' (there are: badminton_clear,"),
        (EvaluationConfig(teaching="ours"), "ours does not exist; make it, or correct 'teaching' under [evaluation]"),
    ],
)
def test_what_cannot_be_taught_is_one_line_and_code_2(tmp_path: Path, config: EvaluationConfig, line: str) -> None:
    box = Box(tmp_path, config)
    process = box.start()
    _, errors = process.communicate(timeout=LESSON_S)
    assert process.returncode == USER_ERROR_CODE
    assert line in errors.decode()
    assert "Traceback" not in errors.decode()
    box.bus.close()


def test_while_the_evaluation_is_away_the_figure_goes_on_and_its_choice_outlives_it(
    box: Box, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def evaluation_status() -> dict[str, Any]:
        said: dict[str, Any] = httpx.get(f"{address}api/status").json()["evaluation"]
        return said

    with page_server(box.room, tmp_path, monkeypatch) as address, connect(address.replace("http", "ws") + "ws") as tablet:
        with box.evaluation() as evaluation:
            until(lambda: evaluation_status()["activity_chosen_by"] == "site", "the page to know of the evaluation")
            tablet.send(json.dumps({"type": "choose", "activity": "squat"}))
            until(lambda: evaluation_status()["activity"] == "squat", "the choice")
            playing = Lesson(box.bus)
            until(lambda: evaluation_status()["state"] == "moving", "an attempt")
            os.kill(evaluation.pid, signal.SIGKILL)
        until(lambda: evaluation_status()["state"] == "unknown", "the page to know that nobody knows")
        assert evaluation_status()["activity"] == "squat"
        motions = _motions_after(tablet, time.monotonic_ns())
        assert motions >= 10, "the figure stood still"
        with box.evaluation() as again:
            box.wait_for(lambda said: (said.activity, said.chosen_by) == ("squat", "tablet"), again.pid)
        playing.close()


def _motions_after(tablet: Any, t_ns: int) -> int:
    """Motions of after an instant, that a tablet which draws them gets."""
    count, drawn, statuses = 0, 0, 0
    while count < 10:
        message = tablet.recv(timeout=DEADLINE_S)
        if isinstance(message, bytes):
            drawn += 1
            count += motion_frame.unpack(message).t_ns > t_ns - LAG_NS
        elif json.loads(message)["type"] == "status":
            statuses += 1
        tablet.send(json.dumps({"type": "ack", "motions": drawn, "statuses": statuses}))
    return count


def test_a_tablet_gets_each_attempt_as_it_ends_and_one_that_comes_later_gets_them_too(
    box: Box, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with page_server(box.room, tmp_path, monkeypatch) as address, connect(address.replace("http", "ws") + "ws") as tablet:
        with box.evaluation() as evaluation:
            playing = Lesson(box.bus)
            box.wait_for(lambda _: len(box.told) >= 2, evaluation.pid)
        playing.close()
        early = next_list(tablet, 2)["attempts"][:2]
        with connect(address.replace("http", "ws") + "ws") as later:
            assert next_list(later)["attempts"][:2] == early
        listed = httpx.get(f"{address}api/attempts").json()
        teaching = httpx.get(f"{address}api/teaching").json()
        replay = attempt_replay.unpack(httpx.get(f"{address}api/attempts/{early[0]['id']}/replay").content)
        missing = httpx.get(f"{address}api/attempts/1/replay")
    assert listed[:2] == early
    assert [attempt["action"] for attempt in early] == [attempt.action for attempt in playing.attempts[:2]]
    assert [attempt["number"] for attempt in early] == [1, 2]
    for attempt in early:
        action = teaching["actions"][attempt["action"]]
        assert action["title"].keys() == {"en", "zh", "de", "es"}
        assert {measure["name"] for measure in attempt["measures"]} == action["measures"].keys()
        assert {attempt["cue"], attempt["praise"]} - {None} <= action["faults"].keys()
    assert len(replay.states) == len(box.told[0].states)
    assert (missing.status_code, missing.headers["content-type"]) == (404, "application/json")


class Tablets:
    """A page that is open, and what the box says to it."""

    def __init__(self, address: str) -> None:
        self.address = address

    def say(self, **message: Any) -> None:
        """As from a tablet that has just come."""
        with connect(self.address.replace("http", "ws") + "ws") as tablet:
            tablet.send(json.dumps(message))
            tablet.send(json.dumps({"type": "ping", "id": 1}))
            while '"pong"' not in str(tablet.recv(timeout=DEADLINE_S)):
                pass

    def choose(self, activity: str) -> None:
        """Somebody says what pupils do, and sees that it is so."""
        self.say(type="choose", activity=activity)
        until(lambda: self.asked["activity"] == activity, lambda: f"{activity}; the page says {self.asked}")

    def call(self, pupil: str | None) -> None:
        """Somebody says who is up, and sees that it is so."""
        self.say(type="turn", pupil=pupil)
        until(lambda: self.up == pupil, lambda: f"pupil {pupil}; the page says {self.up}")

    @property
    def asked(self) -> dict[str, Any]:
        """What pupils are to do and who is up, as every page shows it."""
        said: dict[str, Any] = httpx.get(f"{self.address}api/status").json()["evaluation"]
        return said

    @property
    def up(self) -> str | None:
        """Who is up as every page shows it."""
        said: str | None = self.asked["pupil"]
        return said

    @property
    def whose(self) -> list[str | None]:
        """The pupils of the attempts that are listed, the oldest first."""
        return [attempt["pupil"] for attempt in httpx.get(f"{self.address}api/attempts").json()]


def test_attempts_are_of_whoever_a_tablet_called_also_after_kill_9_and_can_be_corrected(
    box: Box, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    corrections = box.bus.subscribe(topics.pupil_corrections(), keep=10)
    with page_server(box.room, tmp_path, monkeypatch) as address:
        tablets = Tablets(address)
        with box.evaluation() as evaluation:
            tablets.call("7")
            playing = Lesson(box.bus)
            box.wait_for(lambda _: len(box.told) >= 1, evaluation.pid)
            tablets.call("B12")
            os.kill(evaluation.pid, signal.SIGKILL)
        before = len(box.told)
        with box.evaluation() as again:
            box.wait_for(lambda said: said.pupil == "B12", again.pid)
            box.wait_for(lambda said: playing.over and said.state == "unknown", again.pid)
        playing.close()
        assert [feedback.pupil for feedback in box.told] == ["7"] * before + ["B12"] * (len(box.told) - before)
        assert len(box.told) > before
        until(lambda: len(tablets.whose) == len(box.told), "all attempts on the list")
        assert tablets.whose == [feedback.pupil for feedback in box.told]
        tablets.say(type="correction", attempt=box.told[-1].id, pupil="8")
        assert tablets.whose == [*(feedback.pupil for feedback in box.told[:-1]), "8"]
        delivery = corrections.receive(DEADLINE_S)
        assert delivery is not None
        (corrected,) = codec.decode(delivery.payload, PupilCorrections).corrections
        assert (corrected.attempt, corrected.pupil) == (box.told[-1].id, "8")


def test_who_is_up_and_what_was_chosen_outlive_the_pages_server_and_then_the_evaluation(
    box: Box, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with box.evaluation() as evaluation:
        with page_server(box.room, tmp_path, monkeypatch) as address:
            tablets = Tablets(address)
            assert tablets.up is None
            for name in ("Anna", "EMMA2"):
                tablets.say(type="turn", pupil=name)
            assert tablets.up is None
            assert httpx.get(f"{address}api/status").json()["rejected_client_messages"] == 2
            tablets.call("7")
            tablets.choose("squat")
        with page_server(box.room, tmp_path, monkeypatch) as address:
            tablets = Tablets(address)
            until(lambda: tablets.up == "7", "the pupil of before on the page of a new server")
            assert (tablets.asked["activity"], tablets.asked["activity_chosen_by"]) == ("squat", "tablet")
            os.kill(evaluation.pid, signal.SIGKILL)
            with box.evaluation() as again:
                box.wait_for(lambda said: (said.pupil, said.activity, said.chosen_by) == ("7", "squat", "tablet"), again.pid)
                tablets.call(None)
                box.wait_for(lambda said: said.pupil == "", again.pid)


def test_where_the_evaluation_and_the_pages_server_die_together_nobody_is_up(
    box: Box, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with page_server(box.room, tmp_path, monkeypatch) as address, box.evaluation():
        Tablets(address).call("7")
        Tablets(address).choose("squat")
    with page_server(box.room, tmp_path, monkeypatch) as address, box.evaluation() as again:
        said = box.wait_for(lambda _: True, again.pid)
        assert (said.pupil, said.pupil_since_ns) == ("", 0)
        until(lambda: Tablets(address).asked["activity_chosen_by"] == "site", "the page to know that nobody has chosen")
        assert Tablets(address).asked["activity"] is None
        assert Tablets(address).up is None
