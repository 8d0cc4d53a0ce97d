"""Mutated messages on every topic and on the tablet's socket, through the code that receives them in each process.

Here are the processes that make the figure, show it and record it; `test_listeners` has those that watch over them, and the law
that nobody who receives is left out. No crash, no growth, every refusal counted, and what is valid is understood as before.
100,000 a topic with `make test-mutations`, some thousand with `make test`.
"""

import json
import random
import re
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from itertools import chain, islice
from pathlib import Path

import msgspec
import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from edge.meter import Meter
from edge.observe import EdgeConfig, EdgeState, Networks, Stages, observe
from edge.process import Plan
from edge.turns import default_control, is_due
from models.arrays import UInt8
from models.messages import codec, topics
from models.messages.control import ViewControl
from models.messages.feedback import ActivityRequest, Feedback
from models.messages.lesson import LessonRequest
from models.messages.motion import JointState, Motion
from models.messages.observation import Observation
from models.messages.pupil import PupilTurn
from models.process import Delivery, Resources
from services.bus.mailbox import Mailbox
from services.evaluation.process import EvaluationLoop
from services.fusion.pipeline import Tick
from services.fusion.process import FusionLoop
from services.fusion.warm_up import warm_up
from services.lesson.folder_lock import lock
from services.lesson.process import RecorderLoop
from services.support.cpu import CpuMeter
from services.tablet import audience
from services.tablet.process import decoded
from services.tablet.room_state import RoomState
from services.tablet.server import TabletServer
from tests.browser.room import Room
from tests.fake_networks import FakeDetector, FakeEstimate
from tests.integration.waiting import until
from tests.mutations.consumers import topics_of
from tests.mutations.feed import COUNTS, GROWTH_MB, FeedBus, Growth, context_of, deliveries
from tests.mutations.samples import CLIENT_MESSAGES, JOINTS_M, RIG, control, healths, log, motion, observation
from tests.small_video import plain_picture, video_of
from tests.synthetic.gym import T0_NS, Gym, knocked
from tests.taught import performance, some

ENDLESS = "x" * 5000
"""Longer than any message of a page's may be, which costs the connection."""
GREY = video_of([plain_picture(128)] * 2, RIG.names[0])


def filmed(enough: Callable[[], bool]) -> Iterator[Delivery]:
    """What four healthy cameras send, each picture when it is taken, until it is enough; for a minute at most."""
    for sequence in range(60 * 30):
        if enough():
            return
        time.sleep(1 / 60)  # the room's own pace
        for index, name in enumerate(RIG.names):
            yield Delivery(topics.observation(name), codec.encode(observation(index, time.monotonic_ns(), sequence)))


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("topic", topics_of("services.fusion.process"))
def test_fusion_survives_and_then_finds_the_pupil(topic: str, count: int, tmp_path: Path) -> None:
    warm_up()  # Compiled code is no growth.
    stop, growth = threading.Event(), Growth()

    def whole() -> bool:
        """The pupil is seen, and fusion has told of what it refused, which it does once a second."""
        live = codec.decode(bus.newest[topics.motion("live")], Motion) if topics.motion("live") in bus.newest else None
        return live is not None and bool((live.states == JointState.SEEN).all()) and bus.refused > count // 2

    bus = FeedBus(chain(deliveries(topic, count, growth), filmed(whole)), stop)
    loop = FusionLoop(context_of("fusion", bus, stop, tmp_path), CpuMeter())
    loop.run()
    seen = codec.decode(bus.newest[topics.motion("live")], Motion)
    assert (seen.states == JointState.SEEN).all()
    assert abs(seen.joints_m - JOINTS_M).max() < 0.1
    assert bus.refused > count // 2
    assert growth.mb < GROWTH_MB
    assert strangers_after_a_knock(loop) == (RIG.names[0],)


def strangers_after_a_knock(loop: FusionLoop) -> tuple[str, ...]:
    """Whom fusion names when the first camera, of which the mutants were, is moved from now on; its seconds take less of ours."""
    later_ns = time.monotonic_ns() - T0_NS
    for event in Gym(rig=knocked(RIG, 0), seconds=14.0).events():
        if isinstance(event, Tick):
            loop._step(Tick(event.t_ns + later_ns))
        else:
            loop._step(msgspec.structs.replace(event, t_mid_ns=event.t_mid_ns + later_ns))
    found = loop._agreement.judge()
    return () if found is None else found.strangers


class SeesEverywhere:
    """A pose network that is sure of somebody as large as any crop, wherever it is told to look."""

    name, size_px = "thunder", 8

    def estimate(self, _crop_rgb: UInt8) -> FakeEstimate:
        corners = np.tile(np.array(((0, 0), (1, 1), (1, 0), (0, 1)), np.float32), (5, 1))[:17]
        return FakeEstimate(corners, np.full(17, 0.9, np.float32), np.full(17, 1e-3, np.float32))


def filmed_by(control: ViewControl, now_ns: int) -> Iterator[Observation]:
    """What a camera that obeys a plan makes of two pictures: where it is told to look, and where that leads."""
    state, networks = EdgeState(), Networks(SeesEverywhere(), FakeDetector)
    for number in range(2):
        frame = GREY.frame(0, number, now_ns + number * 33_333_333)
        is_due(frame.t_mid_ns, now_ns, control)
        state, seen = observe(state, frame, networks, control, EdgeConfig(), Stages(lambda: 0))
        yield codec.decode(codec.encode(seen), Observation)


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("topic", topics_of("edge.process"))
def test_a_cameras_plan_survives_and_the_next_true_one_is_obeyed(topic: str, count: int) -> None:
    camera, growth, mailbox = RIG.names[0], Growth(), Mailbox(1)
    meter = Meter(f"edge-{camera}", 1, camera, t_report_ns=0, t_picture_ns=0)
    plan = Plan(mailbox, default_control(camera, 0, 4, 0, 30.0), meter.refused_plan)
    now_ns = time.monotonic_ns()  # The mutants' own time for ever: a prediction is followed for less than half a second.
    for delivery in deliveries(topic, count, growth):
        mailbox.put(topic, delivery.payload)
        obeyed = plan.at(now_ns)
        assert obeyed.camera == camera
        assert 0 <= obeyed.rate_hz <= 1000
        assert [seen.camera for seen in filmed_by(obeyed, now_ns)] == [camera] * 2
    refused = meter.refused
    assert refused > count // 10
    told = meter.report(1, 10.0, "thunder", (), Resources(0.1, 100.0))
    assert [trouble.code for trouble in told.troubles] == ["plans_refused"]
    assert str(refused) in told.reason
    true = control(time.monotonic_ns())
    mailbox.put(topic, codec.encode(true))
    assert plan.at(time.monotonic_ns()) == true
    assert meter.refused == 0
    assert growth.mb < GROWTH_MB


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("topic", topics_of("services.tablet.process", every=True))
def test_the_pages_server_survives_and_then_shows_what_is_true(topic: str, count: int) -> None:
    growth = Growth()
    server = TabletServer(RoomState("test", RIG.names, 30.0, time.monotonic_ns()), time.monotonic_ns)
    for number, delivery in enumerate(deliveries(topic, count, growth)):
        decoded(delivery, server)()
        if number % 50 == 0:
            server.status().model_dump_json()
    assert server.status().rejected_bus_messages > count // 10
    now_ns = time.monotonic_ns()
    for name, health in healths(now_ns).items():
        decoded(Delivery(topics.health(name), codec.encode(health)), server)()
    decoded(Delivery(topics.motion("live"), codec.encode(motion(now_ns))), server)()
    status = server.status()
    assert status.pupil == "found"
    assert {each.name: each.state for each in status.processes}["fusion"] == "ok"
    assert status.motion_age_ms is not None
    assert status.motion_age_ms < 60_000
    assert growth.mb < GROWTH_MB


@pytest.mark.parametrize("count", COUNTS)
def test_the_tablets_socket_survives_and_then_gets_its_figures(count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(audience, "READ_HZ", 1e6)  # At a page's own pace most mutants would wait until the socket is closed.
    texts = [message.model_dump_json().encode() for message in CLIENT_MESSAGES]
    chance, growth = random.Random(3), Growth()  # noqa: S311 - no secret
    with Room() as room:
        url = f"ws://127.0.0.1:{room.port}/ws"
        pending = _json_mutants(texts, count, chance)
        sent = 0
        while sent < count:
            with connect(url, compression=None) as socket:
                try:
                    for message in islice(pending, count - sent):
                        sent += 1
                        socket.send(message)
                        if message == ENDLESS:
                            list(socket)  # until it is closed: what is sent meanwhile would reach nobody
                        if sent % 100 == 0:
                            _drain(socket)  # a client that never reads would soon be sent nothing
                        if sent == count // 10:
                            growth.settled()
                except ConnectionClosed:
                    continue
        with connect(url, compression=None) as socket:
            until(lambda: isinstance(socket.recv(timeout=30), bytes), "a figure")
            socket.send('{"type":"ping","id":5}')
            until(lambda: '"pong"' in str(socket.recv(timeout=30)), "an answer")
        with connect(url, compression=None) as socket:
            until(lambda: _refusals(socket.recv(timeout=30)) > count // 2, "the refusals in the status")
    assert growth.mb < GROWTH_MB


def _refusals(message: str | bytes) -> int:
    """What a status counts of the clients' messages; 0 if the message is a figure."""
    return 0 if isinstance(message, bytes) else int(json.loads(message).get("rejected_client_messages", 0))


def _drain(socket: ClientConnection) -> None:
    with suppress(TimeoutError):
        while True:
            socket.recv(timeout=0)


_KEY_OR_VALUE = re.compile(rb'"[^"]*"|\d+')


def _json_mutants(texts: Sequence[bytes], count: int, chance: random.Random) -> Iterator[str | bytes]:
    values = [
        "-1",
        "1e999",
        "NaN",
        "null",
        '"x"',
        "[]",
        "{}",
        "9" * 400,
        "true",
        '"' + "y" * 3000 + '"',
        "[" * 2000,
        '{"a":' * 500,
        "0.5",
    ]
    for _ in range(count):
        text = chance.choice(texts)
        match chance.randrange(5):
            case 0:
                at = chance.randrange(len(text))
                yield bytes(text[:at] + bytes((text[at] ^ (1 << chance.randrange(8)),)) + text[at + 1 :])
            case 1:
                yield text[: chance.randrange(len(text))].decode()
            case 2:
                begin, end = chance.choice([found.span() for found in _KEY_OR_VALUE.finditer(text)])
                yield text[:begin].decode() + chance.choice(values) + text[end:].decode()
            case 3:
                yield chance.randbytes(chance.choice((0, 1, 100, 4000)))
            case _:
                yield chance.choice(values) if chance.random() < 0.999 else ENDLESS


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("topic", topics_of("services.lesson.process"))
def test_the_recorder_survives_and_then_records(topic: str, count: int, tmp_path: Path) -> None:
    stop, growth = threading.Event(), Growth()

    def lesson() -> Iterator[Delivery]:
        yield Delivery(topics.lesson_request(), codec.encode(LessonRequest("stop")))
        yield Delivery(topics.lesson_request(), codec.encode(LessonRequest("start", "after all that")))
        begun_ns = time.monotonic_ns()
        for sequence in range(30):
            time.sleep(0.05)  # the recorder's seconds are real
            yield Delivery(topics.fusion_log(), codec.encode(log(time.monotonic_ns(), sequence, begun_ns)))

    bus = FeedBus(chain(deliveries(topic, count, growth), lesson()), stop)
    with lock(tmp_path / "lessons"):
        RecorderLoop(context_of("recorder", bus, stop, tmp_path), tmp_path / "lessons").run()
    recorders = [health.recorder for health in bus.healths if health.recorder is not None]
    assert recorders[-1].title == "after all that"
    assert bus.refused > count // 2
    assert bus.published[topics.segment_request()] > 0
    assert growth.mb < GROWTH_MB


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("topic", topics_of("services.evaluation.process"))
def test_the_evaluation_survives_and_then_finds_the_attempt_that_was_asked_for(topic: str, count: int, tmp_path: Path) -> None:
    stop, growth = threading.Event(), Growth()
    track, _ = performance("squat")
    frames = [*[track.joints_m[0]] * 30, *track.joints_m, *[track.joints_m[-1]] * 30]

    def performed() -> Iterator[Delivery]:
        yield Delivery(topics.activity_request(), codec.encode(ActivityRequest("squat")))
        yield Delivery(topics.pupil_turn(), codec.encode(PupilTurn("7", time.monotonic_ns())))
        begun_ns = time.monotonic_ns()
        for number, joints_m in enumerate(frames):
            time.sleep(1 / 60)  # health comes once a second
            shown = motion(begun_ns + number * 33_333_333, number, "smooth")
            shown = msgspec.structs.replace(shown, joints_m=joints_m.astype(np.float32))
            yield Delivery(topics.motion("smooth"), codec.encode(shown))

    bus = FeedBus(chain(deliveries(topic, count, growth), performed()), stop)
    EvaluationLoop(context_of("evaluation", bus, stop, tmp_path), some("squat", "long_jump")).run()
    told = codec.decode(bus.newest[topics.feedback()], Feedback)
    assert (told.action, told.by, told.pupil) == ("squat", "chosen", "7")
    assert bus.refused > count // 2
    assert growth.mb < GROWTH_MB
