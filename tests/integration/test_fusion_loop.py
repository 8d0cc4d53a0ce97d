"""The fusion process's loop over the in-memory bus: what goes in, what must come out, and what must not stop it."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import msgspec
import numpy as np
import pytest

from models.messages import codec, topics
from models.messages.control import ViewControl
from models.messages.health import CameraHealth, FusionHealth, Health
from models.messages.lesson import Entry, EntryKind, FusionLog, SegmentRequest
from models.messages.motion import JointState, Motion
from models.messages.observation import Crop, Observation, Person
from models.messages.pupil import PupilCorrection, PupilCorrections
from models.process import Bus, Subscription
from services.bus.memory import MemoryRouter
from services.fusion.config import PRESETS
from services.fusion.pipeline import Tick, initial_state, step
from services.fusion.process import FusionLoop
from services.support.cpu import CpuMeter
from tests.integration.fusion_room import RIG, fusion
from tests.integration.waiting import DEADLINE_S, until
from tests.mutations.feed import FeedBus, context_of
from tests.mutations.samples import feedback, observation
from tests.synthetic.gym import T0_NS, Gym, knocked
from tests.synthetic.person import Person as Pupil

PUPIL = Pupil()


@dataclass
class Room:
    """The loop in a thread, and the other side of its bus."""

    bus: Bus
    live: Subscription
    healths: Subscription
    controls: Subscription
    logs: Subscription
    sequence: int = 0

    def film(self, epoch: int = 0, camera_named: str | None = None, shown_to: dict[str, str] | None = None) -> None:
        """One picture of every camera, now; `shown_to` says whose plug each camera is in."""
        t_ns = time.monotonic_ns()
        joints = PUPIL.joints(1.0)
        for camera in RIG:
            pixels = camera.project(joints).astype(np.float32)
            person = Person(1, Crop(640.0, 360.0, 400.0), pixels, np.full(17, 2, np.float32), np.full(17, 0.9, np.float32))
            name = camera_named or (shown_to or {}).get(camera.name, camera.name)
            observation = Observation(name, epoch, self.sequence, self.sequence, t_ns, t_ns, "thunder", (person,))
            self.bus.publish(topics.observation(camera.name if camera_named else name), codec.encode(observation))
        self.sequence += 1

    def newest_live(self) -> Motion:
        delivery = self.live.receive(DEADLINE_S)
        assert delivery is not None, "no live motion"
        return codec.decode(delivery.payload, Motion)

    def film_until_seen(self) -> Motion:
        """Film until the whole pupil is in a live motion."""
        end = time.monotonic() + DEADLINE_S
        while time.monotonic() < end:
            self.film()
            motion = self.newest_live()
            if (motion.states == JointState.SEEN).all():
                return motion
        pytest.fail("the pupil was never seen")

    def fusion_health(self) -> tuple[Health, FusionHealth]:
        """The next word of fusion about itself."""
        while True:
            delivery = self.healths.receive(DEADLINE_S)
            assert delivery is not None, "no health"
            health = codec.decode(delivery.payload, Health)
            if health.fusion is not None:
                return health, health.fusion


@contextmanager
def running(tmp_path: Path) -> Iterator[Room]:
    router = MemoryRouter()
    other = router.open()
    room = Room(
        bus=other,
        live=other.subscribe(topics.motion("live"), keep=1),
        healths=other.subscribe(topics.health("fusion"), keep=2),
        controls=other.subscribe(*(topics.control(name) for name in RIG.names), keep=1),
        logs=other.subscribe(topics.fusion_log(), keep=1000),
    )
    with fusion(router, tmp_path):
        yield room


def test_pictures_become_the_pupil_where_he_stands(tmp_path: Path) -> None:
    with running(tmp_path) as room:
        motion = room.film_until_seen()
    assert np.abs(motion.joints_m - PUPIL.joints(1.0)).max() < 0.05
    assert motion.t_published_ns >= motion.t_ns


@pytest.mark.slow
def test_every_camera_is_told_where_to_look_and_takes_its_turn(tmp_path: Path) -> None:
    with running(tmp_path) as room:
        room.film_until_seen()
        newest: dict[str, ViewControl] = {}

        def told() -> bool:
            room.film()
            delivery = room.controls.receive(DEADLINE_S)
            assert delivery is not None
            control = codec.decode(delivery.payload, ViewControl)
            newest[control.camera] = control
            return len(newest) == 4 and all(control.prediction is not None for control in newest.values())

        until(told, "a prediction for every camera")
    assert len({control.offset_ns for control in newest.values()}) == 4
    assert not any(control.search for control in newest.values())
    for camera in RIG:
        prediction = newest[camera.name].prediction
        assert prediction is not None
        centre = camera.project(PUPIL.joints(1.0)).mean(axis=0)
        crop = prediction.crop
        assert np.hypot(crop.centre_x_px - centre[0], crop.centre_y_px - centre[1]) < 0.5 * crop.side_px


@pytest.mark.slow
def test_without_pictures_nothing_is_known_and_nothing_is_claimed(tmp_path: Path) -> None:
    with running(tmp_path) as room:
        health, fusion = room.fusion_health()
    assert fusion.pupil == "searching"
    assert health.state == "degraded"
    (trouble,) = health.troubles
    assert trouble.code == "camera_unheard"
    assert all(name in trouble.words for name in RIG.names)


@pytest.mark.slow
def test_messages_that_cannot_be_read_are_counted_and_do_no_harm(tmp_path: Path) -> None:
    with running(tmp_path) as room:
        for payload in (b"", b"\x01", b"rubbish" * 100, bytes(100_000)):
            room.bus.publish(topics.observation("cam0"), payload)
            room.bus.publish(topics.health("edge-cam0"), payload)
            time.sleep(0.05)
        until(lambda: room.fusion_health()[1].rejected > 0, "messages counted as rejected")
        room.film_until_seen()


@pytest.mark.slow
def test_an_observation_in_another_cameras_name_is_refused(tmp_path: Path) -> None:
    with running(tmp_path) as room:
        room.film(camera_named="cam3")
        rejected = 0

        def refused() -> bool:
            nonlocal rejected
            _, fusion = room.fusion_health()  # counted anew each second, whose end may lie between the four
            rejected += fusion.rejected
            return rejected >= 3

        until(refused, "three observations refused")
        room.film()
        _, fusion = room.fusion_health()
    assert rejected + fusion.rejected == 3


def told(health: Health, code: str, words: str) -> bool:
    return any(trouble.code == code and words in trouble.words for trouble in health.troubles)


@pytest.mark.slow
def test_a_camera_whose_pictures_are_not_fused_is_named(tmp_path: Path) -> None:
    with running(tmp_path) as room:
        room.film_until_seen()
        room.film(epoch=5)

        def named() -> bool:
            for _ in range(8):
                room.film(epoch=1)
                time.sleep(0.02)
            health, fusion = room.fusion_health()
            return fusion.ignored.get("cam1", 0) > 0 and told(health, "epochs_differ", "cam1 is not fused")

        until(named, "cam1 named as not fused")


@pytest.mark.slow
def test_cameras_that_were_exchanged_are_named(tmp_path: Path) -> None:
    others = {"cam0": "cam1", "cam1": "cam0", "cam2": "cam2", "cam3": "cam3"}
    with running(tmp_path) as room:

        def named() -> bool:
            for _ in range(10):
                room.film(shown_to=others)
                time.sleep(0.05)
            health, _ = room.fusion_health()
            return told(health, "cameras_exchanged", "cam0 and cam1 seem to be exchanged")

        until(named, "cam0 and cam1 named as exchanged")


@pytest.mark.slow
def test_one_picture_that_is_refused_does_not_keep_its_camera_from_being_named_once_it_is_moved(tmp_path: Path) -> None:
    stop = threading.Event()
    loop = FusionLoop(context_of("fusion", FeedBus((), stop), stop, tmp_path), CpuMeter())
    loop._step(Tick(T0_NS))
    loop._step(observation(2, 2**62))
    for event in Gym(rig=knocked(RIG, 2), seconds=14.0).events():
        loop._step(event)
    found = loop._agreement.judge()
    assert found is not None
    assert found.strangers == ("cam2",)


@pytest.mark.slow
def test_a_word_of_health_of_an_unknown_camera_takes_no_part_in_the_plan(tmp_path: Path) -> None:
    stranger = CameraHealth("elsewhere", 30.0, 1.0, 10.0, 0, 5.0, "thunder", {"pose": 900.0})
    health = Health("edge-elsewhere", 1, time.monotonic_ns(), "ok", (), 0.1, 1.0, camera=stranger)
    with running(tmp_path) as room:
        room.bus.publish(topics.health("edge-elsewhere"), codec.encode(health))
        said, _ = room.fusion_health()
    assert "elsewhere" not in said.reason
    assert msgspec.structs.asdict(said)["process"] == "fusion"


def log_a_segment(room: Room, smooth: int) -> list[FusionLog]:
    """Ask for a segment and film until so many smooth motions are in its log."""
    asked_ns = time.monotonic_ns()
    room.bus.publish(topics.segment_request(), codec.encode(SegmentRequest(asked_ns)))
    parts: list[FusionLog] = []

    def enough() -> bool:
        room.film()
        room.newest_live()
        while (delivery := room.logs.receive(0.0)) is not None:
            part = codec.decode(delivery.payload, FusionLog)
            if part.segment_ns > asked_ns:
                parts.append(part)
        return sum(entry.kind == "motion" for entry in entries_of(parts)) >= smooth

    until(enough, f"{smooth} smooth motions in the log")
    assert len({part.segment_ns for part in parts}) == 1
    assert [part.sequence for part in parts] == list(range(len(parts)))
    return parts


def entries_of(parts: list[FusionLog]) -> list[Entry]:
    return [entry for part in parts for entry in part.entries]


def replayed(entries: list[Entry]) -> tuple[list[bytes], list[bytes]]:
    """The smooth motions of a log, and those that its observations and ticks give again; both without the time of publishing."""

    def bare(motion: Motion) -> bytes:
        return codec.encode(msgspec.structs.replace(motion, t_published_ns=0))

    state, logged, again = initial_state(RIG), [], []
    for entry in entries:
        if entry.kind == "motion":
            logged.append(bare(codec.decode(entry.payload, Motion)))
        elif entry.kind in ("observation", "tick"):
            event = Tick(entry.t_ns) if entry.kind == "tick" else codec.decode(entry.payload, Observation)
            state, output = step(state, event, PRESETS["default"])
            again += [bare(motion) for motion in output.motions if motion.kind == "smooth"]
    return logged, again


@pytest.mark.slow
def test_the_log_of_a_segment_gives_the_same_motion_again_to_the_last_bit(tmp_path: Path) -> None:
    with running(tmp_path) as room:
        room.film_until_seen()
        parts = log_a_segment(room, smooth=40)
    logged, again = replayed(entries_of(parts))
    assert len(logged) >= 40
    assert logged == again
    assert (codec.decode(logged[-1], Motion).states == JointState.SEEN).all()


@pytest.mark.slow
def test_a_later_request_begins_a_segment_that_replays_by_itself(tmp_path: Path) -> None:
    with running(tmp_path) as room:
        first, second = log_a_segment(room, smooth=20), log_a_segment(room, smooth=20)
    assert second[0].segment_ns > first[0].segment_ns
    for parts in (first, second):
        logged, again = replayed(entries_of(parts))
        assert logged == again


@pytest.mark.slow
def test_health_that_fusion_heard_is_in_its_log(tmp_path: Path) -> None:
    with running(tmp_path) as room:
        parts = log_a_segment(room, smooth=40)
    heard = [codec.decode(entry.payload, Health) for entry in entries_of(parts) if entry.kind == "health"]
    assert any(health.process == "fusion" for health in heard)


TOLD: dict[EntryKind, tuple[str, bytes]] = {
    "feedback": (topics.feedback(), codec.encode(feedback(time.monotonic_ns()))),
    "corrections": (topics.pupil_corrections(), codec.encode(PupilCorrections((PupilCorrection(5, "B12"),)))),
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", TOLD)
def test_what_fusion_heard_of_attempts_is_in_its_log_and_rubbish_on_that_topic_is_not(tmp_path: Path, kind: EntryKind) -> None:
    topic, told = TOLD[kind]
    with running(tmp_path) as room:
        asked_ns = time.monotonic_ns()
        room.bus.publish(topics.segment_request(), codec.encode(SegmentRequest(asked_ns)))
        logged: list[bytes] = []

        def enough() -> bool:
            room.bus.publish(topic, told[:-1])
            room.bus.publish(topic, told)
            delivery = room.logs.receive(DEADLINE_S)
            assert delivery is not None
            part = codec.decode(delivery.payload, FusionLog)
            logged.extend(entry.payload for entry in part.entries if entry.kind == kind)
            return bool(logged)

        until(enough, f"{kind} in fusion's log")
        until(lambda: room.fusion_health()[1].rejected > 0, "a refusal in fusion's health")
    assert set(logged) == {told}
